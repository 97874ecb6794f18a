// The one place where the benchmarks touch the project's ranking.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/rank.hpp"
#include "tests/bench/lines.hpp"

#include <span>
#include <vector>

namespace scansion::bench {

/// Holds all memory that the ranking fills, so that the steady state is measured. Thread-bound.
class OurRanking {
public:
  explicit OurRanking(Rational resolution_mm) : ranker_(resolution_mm) {}

  /// Distance and depth of every point.
  void distances(const RunView& run);
  /// The same, and the order.
  void full(const RunView& run);
  /// The full ranking of many runs, short ones together as the pipeline does it. Returns how many points the tolerance keeps,
  /// all of them when it is negative; only then the order is made.
  std::size_t full(const FlatRuns& flat, double tolerance_mm = -1.0);
  /// How many points a tolerance keeps, from distances().
  [[nodiscard]] std::size_t kept(double tolerance_mm) const noexcept;

  [[nodiscard]] std::span<const double> distance() const noexcept { return distance_; }
  [[nodiscard]] std::span<const std::uint32_t> order() const noexcept { return order_; }

private:
  Ranker ranker_;
  RankSorter sorter_;
  std::vector<Run> together_;
  std::vector<double> distance_;
  std::vector<std::uint32_t> depth_;
  std::vector<std::uint32_t> order_;
};

} // namespace scansion::bench
