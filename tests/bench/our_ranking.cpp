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

std::size_t OurRanking::kept(double tolerance_mm) const noexcept {
  return static_cast<std::size_t>(std::ranges::count_if(distance_, [&](double d) { return d > tolerance_mm; }));
}

} // namespace scansion::bench
