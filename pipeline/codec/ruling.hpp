// Ruled axes: every coordinate lies on a rounded multiple of one pitch, and samples may be missing: rasters with holes, evenly
// spaced abscissae that were rounded to decimals (docs/FORMAT.md, "Ruled axes").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/ruling_kernels.hpp"
#include "pipeline/codec/symbols.hpp"
#include "pipeline/model/result.hpp"
#include "pipeline/model/scan_line.hpp"

#include <span>
#include <vector>

namespace scansion {

/// What says u of all points of a ruled axis but the first of each run.
class Ruling {
public:
  /// False when the axis is not ruled. `u` may be anything.
  [[nodiscard]] bool find(std::span<const Run> runs, std::span<const std::int32_t> u);
  /// Puts the first values of runs, each less `advance` and the one before (`first` for the first run), and the ruling.
  void write(std::span<const Run> runs, std::span<const std::int32_t> u, std::int32_t first, std::int32_t advance,
             SymbolWriter& to) const;
  /// Reads that and fills `u`.
  [[nodiscard]] Result<void> read(std::span<const Run> runs, std::int32_t first, std::int32_t advance, SymbolReader& from,
                                  std::span<std::int32_t> u);

private:
  /// u of sample s is u of the first point + floor((pitch * s + phase) / 2^32).
  struct Rule {
    std::int64_t pitch = 0;
    std::uint32_t phase = 1U << 31U;
    std::size_t skips_end = 0; ///< of this run
  };
  struct Skip {
    std::uint32_t point = 0;   ///< of the group
    std::uint32_t samples = 0; ///< missing before it
  };
  using Spread = kernels::Spread;
  [[nodiscard]] bool rule(const Run& run, std::span<const std::int32_t> u, const Rule& before);
  [[nodiscard]] bool narrow(const Run& run, std::span<const std::int32_t> u, std::size_t skips, Spread spread,
                            const Rule& before);
  [[nodiscard]] bool adopt(double pitch, const Spread& spread, const Rule& before);
  [[nodiscard]] bool measure(const Run& run, std::span<const std::int32_t> u, double pitch, Spread& spread);
  void lay_out(const Run& run, const Rule& rule, std::size_t skips_begin, std::span<std::int32_t> u) const noexcept;

  std::vector<Rule> rules_; ///< per run
  std::vector<Skip> skips_;
  std::vector<std::int32_t> check_; ///< scratch
  std::vector<double> steps_;
};

} // namespace scansion
