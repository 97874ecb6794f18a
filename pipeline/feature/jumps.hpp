// Walls that stand between two samples: they part patches where no feature line was found, and say exactly where one parts them
// (docs/FEATURES.md, "Patches"). SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/cuts.hpp"
#include "pipeline/feature/patch_row.hpp"

#include <cstdint>
#include <vector>

namespace scansion {

/// A column in two successive rows: the sample of each that stands there, or kNone.
struct ColumnPair {
  static constexpr std::uint32_t kNone = PatchRow::kNoSample;
  std::uint32_t before = kNone, now = kNone;
};

/// The columns from `first` on that two rows span together, at multiples of the pitch; both know theirs. Fills `pairs`; returns
/// the first column.
std::int64_t pair_columns(const PatchRow& before, const PatchRow& now, std::vector<ColumnPair>& pairs);

/// Thread-bound: holds scratch.
class Jumps {
public:
  /// Adds the walls of the row to its cuts; a step's cut beside a wall moves to it.
  void in_line(const PatchRow& row, const Sampling& sampling, std::vector<Cut>& cuts);
  /// The same for the columns between `before` and `now`, whose samples are `pairs` from column `first` on. `next` follows
  /// `now`, or is null.
  void across(const PatchRow& before, const PatchRow& now, const PatchRow* next, std::int64_t first,
              const std::vector<ColumnPair>& pairs, double pitch, const Sampling& sampling, std::vector<Cut>& cuts);
  void restart() noexcept { above_.clear(); }

private:
  struct Wall {
    std::int64_t column = 0;
    bool rises = false;
  };
  static void find(const PatchRow& before, const PatchRow& now, std::int64_t first, const std::vector<ColumnPair>& pairs,
                   const Sampling& sampling, std::vector<Wall>& out);

  std::vector<Wall> above_, here_, below_; ///< walls before, between and after the two rows, by column
  std::vector<Wall> parting_;
  std::vector<ColumnPair> pairs_;
  std::vector<std::uint32_t> walls_; ///< of a row: sample before each
  std::vector<Cut> merged_;
};

} // namespace scansion
