// Walls that stand between two samples: they part patches where no feature line was found, and say exactly where one parts them
// (docs/FEATURES.md, "Patches").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/patch/cuts.hpp"
#include "pipeline/feature/patch/patch_row.hpp"

#include <cstdint>
#include <vector>

namespace scansion {

/// Thread-bound: holds scratch.
class Jumps {
public:
  /// Rise or fall of an interval, mm, from which it may be part of a wall. `least_step`: none of the row is shorter.
  [[nodiscard]] static double least_rise(const Sampling& sampling, double least_step) noexcept;

  /// Adds the walls of the row to its cuts; a step's cut beside a wall moves to it.
  void in_line(const PatchRow& row, const Sampling& sampling, std::vector<Cut>& cuts);
  /// The same for the columns between `before` and `now`. `next` follows `now`, or is null. Call with successive rows.
  void across(const PatchRow& before, const PatchRow& now, const PatchRow* next, double pitch, const Sampling& sampling,
              std::vector<Cut>& cuts);
  /// The rows that follow have nothing to do with those before.
  void restart() noexcept {
    above_.clear();
    below_.clear();
    known_ = false;
  }

private:
  struct Wall {
    std::int64_t column = 0;
    bool rises = false;
  };
  void find(const PatchRow& before, const PatchRow& now, const Sampling& sampling, std::vector<Wall>& out);
  void find_walls(const PatchRow& row, const Sampling& sampling);

  std::vector<Wall> above_, here_, below_; ///< walls before, between and after the two rows, by column
  bool known_ = false;                     ///< `below_` holds those of the rows that come next
  std::vector<std::uint32_t> walls_;       ///< of a row: sample before each
  std::vector<std::uint32_t> high_;        ///< scratch: where heights are apart
  std::vector<Cut> parting_, merged_;
};

} // namespace scansion
