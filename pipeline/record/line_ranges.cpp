// Holes without gaps.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/line_ranges.hpp"

#include <algorithm>

namespace scansion {
namespace {

/// Last line that `gap` names when it is looked at from a hole that ends with line `hole_end`.
std::uint64_t last_of(const Gap& gap, std::uint64_t hole_end) noexcept {
  if (!gap.count) return std::max(gap.first, hole_end);
  const std::uint64_t room = UINT64_MAX - gap.first;
  return gap.first + std::min(*gap.count - 1, room);
}

} // namespace

std::vector<Hole> unexplained(const std::vector<Hole>& holes, std::vector<Gap> gaps) {
  std::erase_if(gaps, [](const Gap& gap) { return gap.count == 0U; });
  std::sort(gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return a.first < b.first; });
  std::vector<Hole> left;
  std::size_t g = 0;
  std::uint64_t named_to = 0; // lines below this are named by gaps passed so far
  for (const Hole& hole : holes) {
    const auto [first, last] = hole.lines;
    std::uint64_t at = std::max(first, std::min(named_to, last + 1));
    for (; g < gaps.size() && gaps[g].first <= last; ++g) {
      const Gap& gap = gaps[g];
      if (!gap.count && gap.first < first) continue; // it told of an earlier place
      if (gap.first > at) left.push_back({{at, gap.first - 1}, hole.time});
      const std::uint64_t end = last_of(gap, last);
      named_to = std::max(named_to, end == UINT64_MAX ? end : end + 1);
      at = std::max(at, std::min(named_to, last + 1));
    }
    if (at <= last) left.push_back({{at, last}, hole.time});
  }
  return left;
}

} // namespace scansion
