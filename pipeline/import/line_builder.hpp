// Samples on the lattice to a scan line with runs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/lattice.hpp"
#include "pipeline/model/scan_line.hpp"

#include <optional>

namespace scansion {

/// Fills one LineBuffer after the other. Thread-bound.
class LineBuilder {
public:
  LineBuilder() = default;
  /// `gap_mm`: a longer step starts a new run.
  LineBuilder(bool exact, std::optional<double> gap_mm, Rational resolution_mm);

  enum class Added : std::uint8_t { ok, line_too_long };

  void begin(LineBuffer& line) noexcept;
  [[nodiscard]] Added add(const std::array<std::int32_t, 3>& counts, const std::array<std::int64_t, 3>& ulps);
  [[nodiscard]] Added add_invalid() noexcept;
  void finish() noexcept;
  /// No point and no invalid sample since begin().
  [[nodiscard]] bool empty() const noexcept { return samples_ == 0; }

private:
  [[nodiscard]] bool is_gap(const std::array<std::int32_t, 3>& counts) const noexcept;
  void start_run();

  bool exact_ = false;
  std::optional<long double> gap_squared_; ///< counts squared
  LineBuffer* line_ = nullptr;
  std::uint32_t samples_ = 0;
  std::uint32_t invalid_ = 0; ///< since the last run
  bool run_open_ = false;
  std::array<std::int32_t, 3> last_{}; ///< of the open run
};

} // namespace scansion
