// The one place where the benchmarks touch the project's ranking.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/our_ranking.hpp"

#include <algorithm>

namespace scansion::bench {

void OurRanking::distances(const RunView& run) {
  distance_.resize(run.size());
  depth_.resize(run.size());
  ranker_.rank({run.x, run.y, run.z, {}}, distance_, depth_);
}

void OurRanking::full(const RunView& run) {
  distances(run);
  sorter_.sort(distance_, depth_, order_);
}

std::size_t OurRanking::full(const FlatRuns& flat, double tolerance_mm) {
  constexpr std::size_t kTogether = 1024; // points, as the Ranker takes them
  std::size_t kept_points = 0;
  for (std::size_t r = 0; r < flat.runs.size();) {
    const std::uint32_t first = flat.runs[r].first;
    std::size_t points = 0;
    together_.clear();
    for (; r < flat.runs.size() && (points == 0 || points + flat.runs[r].count <= kTogether); ++r) {
      together_.push_back({static_cast<std::uint32_t>(points), flat.runs[r].count, 0});
      points += flat.runs[r].count;
    }
    const auto axis = [&](std::size_t k) { return std::span(flat.xyz[k]).subspan(first, points); };
    distance_.resize(points);
    depth_.resize(points);
    ranker_.rank({axis(0), axis(1), axis(2)}, together_, distance_, depth_);
    if (tolerance_mm >= 0.0) {
      kept_points += kept(tolerance_mm);
      continue;
    }
    for (const Run& run : together_)
      sorter_.sort(std::span(distance_).subspan(run.first, run.count), std::span(depth_).subspan(run.first, run.count), order_);
    kept_points += points;
  }
  return kept_points;
}

std::size_t OurRanking::kept(double tolerance_mm) const noexcept {
  return static_cast<std::size_t>(std::ranges::count_if(distance_, [&](double d) { return d > tolerance_mm; }));
}

} // namespace scansion::bench
