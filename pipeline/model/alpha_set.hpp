// The alpha-set: the decreasing tolerances that define the levels of detail (paper, section 4).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/lattice.hpp"
#include "pipeline/model/result.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace scansion {

/// d_1 > d_2 > ... > d_n > 0 in millimetres. S_k = {D > d_(k+1)} for k < n, S_n is every point.
struct AlphaSet {
  std::vector<double> tolerances;
  std::uint32_t epoch = 0; ///< counts the calibrations of one recording

  /// The alpha-width of a point of distance `d` mm: the index of the first S_k that holds it (0 .. n).
  [[nodiscard]] std::uint32_t width(double d) const noexcept {
    std::uint32_t k = 0;
    while (k < tolerances.size() && !(d > tolerances[k])) ++k;
    return k;
  }
  friend bool operator==(const AlphaSet&, const AlphaSet&) = default;
};

inline constexpr std::uint32_t kMaxLevels = 16;

/// Where splitting ends: an interval whose farthest point is no farther than this is left as it is. `half` (of a count) or mm;
/// 0: never, every point is ranked.
struct Floor {
  double value = 0.0;
  bool counts = false; ///< value is in counts, not in mm

  [[nodiscard]] double in_counts(Rational resolution_mm) const noexcept {
    return counts ? value : value * static_cast<double>(resolution_mm.den) / static_cast<double>(resolution_mm.num);
  }
  [[nodiscard]] bool on() const noexcept { return value > 0.0; }
  friend bool operator==(const Floor&, const Floor&) = default;
};

/// How the alpha-set is chosen: `geometric:N[:RATIO]`, `uniform:N[:DMAX]`, `explicit:T1,T2,...`.
struct LevelSpec {
  enum class Kind : std::uint8_t { geometric, uniform, explicit_list };
  Kind kind = Kind::geometric;
  std::uint32_t count = 3;
  double ratio = 3.0;                      ///< geometric only
  double d_max = 0.0;                      ///< uniform only, mm; 0: calibrated from the lines
  std::vector<double> explicit_tolerances; ///< mm, decreasing
  Floor floor;                             ///< no part of the text: a key of its own wherever levels are written

  friend bool operator==(const LevelSpec&, const LevelSpec&) = default;
};

[[nodiscard]] Result<Floor> parse_floor(std::string_view text);
/// What parse_floor reads: `off`, `half` or mm.
[[nodiscard]] std::string to_string(const Floor& floor);
[[nodiscard]] Result<LevelSpec> parse_level_spec(std::string_view text);
[[nodiscard]] std::string to_string(const LevelSpec& spec);

} // namespace scansion
