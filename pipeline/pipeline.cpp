// Lines to groups, groups to ranks, ranks to payloads.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/pipeline.hpp"

namespace scansion {

bool GroupBuilder::must_close_before(const LineBuffer& line) const noexcept {
  return full() || (!empty() && group_.points() + line.points() > kGroupPoints);
}

void GroupBuilder::add(const LineBuffer& line) {
  append_line(group_, next_line_++, line);
}

void GroupBuilder::take(LineGroup& out) {
  std::swap(group_, out);
  out.number = next_group_++;
  group_.clear();
}

void rank_group(Ranker& ranker, const LineGroup& group, GroupRanks& out) {
  out.distance.resize(group.points());
  out.depth.resize(group.points());
  ranker.rank({group.xyz[0], group.xyz[1], group.xyz[2]}, group.runs, out.distance, out.depth);
}

void Pipeline::process(const LineGroup& group, EncodedGroup& out) {
  rank_group(ranker_, group, ranks_);
  encoder_.encode(group, ranks_, calibrator_.next(group, ranks_, ranker_.resolution()), stream_, out);
}

} // namespace scansion
