// The pipeline: groups of scan lines in, encoded groups out. The same code online, offline and in tests.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/codec.hpp"
#include "pipeline/model/alpha_set.hpp"
#include "pipeline/model/scan_line.hpp"
#include "pipeline/rank/rank.hpp"

namespace scansion {

/// Collects lines into groups: a group is full at kGroupLines, or before it would pass kGroupPoints. When to close a group
/// early (live devices: group_ms) is the caller's decision.
class GroupBuilder {
public:
  /// True when `line` cannot join the open group any more: take() first.
  [[nodiscard]] bool must_close_before(const LineBuffer& line) const noexcept;
  void add(const LineBuffer& line);
  /// Skips `count` line indexes (lines that were lost). The open group must be empty: groups hold consecutive lines.
  void skip(std::uint64_t count) noexcept { next_line_ += count; }
  [[nodiscard]] bool empty() const noexcept { return group_.lines.empty(); }
  [[nodiscard]] bool full() const noexcept { return group_.lines.size() >= kGroupLines; }
  [[nodiscard]] std::uint64_t next_line() const noexcept { return next_line_; }
  /// Swaps the open group into `out` (whose buffers are used again) and starts the next one.
  void take(LineGroup& out);

private:
  LineGroup group_;
  std::uint64_t next_line_ = 0;
  std::uint64_t next_group_ = 0;
};

/// Ranks all runs of a group. Thread: one Ranker, one thread; different groups are independent.
void rank_group(Ranker& ranker, const LineGroup& group, GroupRanks& out);

/// Chooses the alpha-set of each group in turn: sequential by nature, cheap. Calibrates on the first group that has inner
/// points and again when a group leaves the range (a new epoch); see docs/FORMAT.md, "Levels".
class Calibrator {
public:
  explicit Calibrator(LevelSpec spec) : spec_(std::move(spec)) {}
  [[nodiscard]] const AlphaSet& next(const LineGroup& group, const GroupRanks& ranks, Rational resolution_mm);

private:
  [[nodiscard]] std::vector<double> calibrate(const LineGroup& group, const GroupRanks& ranks, Rational resolution_mm);
  LevelSpec spec_;
  AlphaSet alpha_;
  bool calibrated_ = false;
  std::vector<double> scratch_;
};

/// All of it for one device on one thread: rank, calibrate, encode, and find feature lines.
class Pipeline {
public:
  Pipeline(const LevelSpec& levels, Rational resolution_mm, std::uint32_t stream)
      : ranker_(resolution_mm, RankUnit::automatic, levels.floor.in_counts(resolution_mm)), calibrator_(levels),
        stream_(stream) {}
  void process(const LineGroup& group, EncodedGroup& out);
  /// D and depth of the points of the group processed last.
  [[nodiscard]] const GroupRanks& ranks() const noexcept { return ranks_; }

private:
  Ranker ranker_;
  Calibrator calibrator_;
  GroupEncoder encoder_;
  GroupRanks ranks_;
  std::uint32_t stream_;
};

} // namespace scansion
