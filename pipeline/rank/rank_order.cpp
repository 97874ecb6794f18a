// The order of ranked points: which code sorts, and the rule in full for what its keys cannot tell apart.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rank/order_job.hpp"
#include "pipeline/rank/rank.hpp"

#include <algorithm>

namespace scansion {
namespace {

bool order_by_vectors(const OrderJob& job, RankUnit unit) {
  switch (unit) {
#if defined(__x86_64__)
    case RankUnit::avx512: return order_avx512(job);
    case RankUnit::avx2: return order_avx2(job);
#endif
    default: return order_portable(job);
  }
}

// Insertion sort of nearly sorted points. False: that takes too many steps.
template <class ComesFirst>
bool settle(std::span<std::uint32_t> order, const ComesFirst& comes_first) {
  std::size_t steps = 2 * order.size();
  for (std::size_t i = 1; i < order.size(); ++i) {
    const std::uint32_t point = order[i];
    std::size_t to = i;
    for (; to > 0 && comes_first(point, order[to - 1]); --to) {
      if (steps-- == 0) {
        order[to] = point;
        return false;
      }
      order[to] = order[to - 1];
    }
    order[to] = point;
  }
  return true;
}

} // namespace

RankSorter::RankSorter(RankUnit unit) : wanted_(unit), counts_(kOrderCounts) {}

void RankSorter::sort(std::span<const double> distance, std::span<const std::uint32_t> depth,
                      std::vector<std::uint32_t>& order) {
  const std::size_t n = distance.size();
  order.resize(n);
  if (n > 0) order[0] = 0;
  if (n > 1) order[1] = static_cast<std::uint32_t>(n - 1);
  if (n == 3) order[2] = 1;
  if (n <= 3) return;
  if (keys_.size() < n) {
    keys_.resize(n);
    sorted_.resize(n);
    digits_.resize(n);
  }
  const OrderJob job{.distance = distance.data(),
                     .depth = depth.data(),
                     .n = static_cast<std::uint32_t>(n),
                     .order = order.data(),
                     .keys = keys_.data(),
                     .sorted = sorted_.data(),
                     .digits = digits_.data(),
                     .counts = counts_.data()};
  if (order_by_vectors(job, unit_for(wanted_, n))) return;
  const auto comes_first = [&](std::uint32_t i, std::uint32_t j) {
    if (distance[i] != distance[j]) return distance[i] > distance[j];
    if (depth[i] != depth[j]) return depth[i] < depth[j];
    return i < j;
  };
  const auto inner = std::span(order).subspan(2);
  if (n > kOrderPoints)
    for (std::size_t i = 0; i < inner.size(); ++i) inner[i] = static_cast<std::uint32_t>(i + 1);
  if (n > kOrderPoints || !settle(inner, comes_first)) std::ranges::sort(inner, comes_first);
}

} // namespace scansion
