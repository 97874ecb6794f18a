// Convex hulls of blocks of points, and searches among them.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rank/hull_tree.hpp"

#include <algorithm>

namespace scansion {
namespace {

constexpr std::uint32_t kNone = ~std::uint32_t{0};

} // namespace

void HullTree::reset(const std::int32_t* u, const std::int32_t* v, std::uint32_t n) {
  u_ = u;
  v_ = v;
  n_ = n;
  levels_.clear();
  for (std::uint32_t nodes = blocks(); levels_.empty() || nodes > 1; nodes = (nodes + 1) / 2) levels_.emplace_back(nodes);
}

std::uint32_t HullTree::end_of(unsigned level, std::uint32_t node) const noexcept {
  const std::uint64_t end = (std::uint64_t{node} + 1) * kBlock << level;
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(end, n_));
}

// Monotone chain over points in order of u, v; points on edges are left out.
void HullTree::make_hull(std::vector<std::uint32_t>& points) const {
  const auto turn = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
    const std::int64_t qu = std::int64_t{u_[q]} - u_[p];
    const std::int64_t qv = std::int64_t{v_[q]} - v_[p];
    const std::int64_t ru = std::int64_t{u_[r]} - u_[p];
    const std::int64_t rv = std::int64_t{v_[r]} - v_[p];
    return qu * rv - qv * ru;
  };
  const auto same = [&](std::uint32_t p, std::uint32_t q) { return u_[p] == u_[q] && v_[p] == v_[q]; };
  points.erase(std::unique(points.begin(), points.end(), same), points.end());
  if (points.size() < 3) return;
  std::vector<std::uint32_t> lower;
  std::vector<std::uint32_t> upper;
  for (const std::uint32_t p : points) {
    while (lower.size() > 1 && turn(lower[lower.size() - 2], lower.back(), p) <= 0) lower.pop_back();
    while (upper.size() > 1 && turn(upper[upper.size() - 2], upper.back(), p) >= 0) upper.pop_back();
    lower.push_back(p);
    upper.push_back(p);
  }
  // Both chains hold the first and the last point.
  points.clear();
  const auto by_place = [&](std::uint32_t p, std::uint32_t q) { return u_[p] != u_[q] ? u_[p] < u_[q] : v_[p] < v_[q]; };
  std::merge(lower.begin(), lower.end(), upper.begin() + 1, upper.end() - 1, std::back_inserter(points), by_place);
}

const HullTree::Node& HullTree::node_at(unsigned level, std::uint32_t node) {
  Node& here = levels_[level][node];
  if (here.known) return here;
  here.known = true;
  const auto by_place = [&](std::uint32_t p, std::uint32_t q) { return u_[p] != u_[q] ? u_[p] < u_[q] : v_[p] < v_[q]; };
  if (level == 0) {
    for (std::uint32_t k = node * kBlock; k < end_of(0, node); ++k) here.hull.push_back(k);
    std::ranges::sort(here.hull, by_place);
  } else {
    const Node& left = node_at(level - 1, 2 * node);
    const Node* const right = 2 * node + 1 < levels_[level - 1].size() ? &node_at(level - 1, 2 * node + 1) : nullptr;
    here.left_out = left.left_out || (right != nullptr && right->left_out);
    if (here.left_out) return here;
    here.hull = left.hull;
    if (right != nullptr) {
      const auto middle = static_cast<std::ptrdiff_t>(here.hull.size());
      here.hull.insert(here.hull.end(), right->hull.begin(), right->hull.end());
      std::ranges::inplace_merge(here.hull, here.hull.begin() + middle, by_place);
    }
  }
  make_hull(here.hull);
  // Memory stays below a quarter of the points for each level.
  const std::uint32_t points = end_of(level, node) - (node * kBlock << level);
  here.left_out |= level > 0 && here.hull.size() > points / 4;
  if (here.left_out) here.hull = {};
  return here;
}

// Visits the largest nodes that cover the blocks [first, end), left to right; stops when `visit` says true.
template <class Visit>
bool HullTree::visit_nodes(std::uint32_t first, std::uint32_t end, Visit&& visit) {
  while (first < end) {
    unsigned level = 0;
    while (level + 1 < levels_.size() && first % (2U << level) == 0 && first + (2U << level) <= end) ++level;
    if (visit(level, first >> level)) return true;
    first += 1U << level;
  }
  return false;
}

void HullTree::measure_point(Query& q, std::uint32_t k) {
  std::uint64_t cross = 0;
  std::uint64_t beyond = 0;
  if (q.kernel.measure(q.chord, k, cross, beyond))
    q.best.cross = std::max(q.best.cross, cross);
  else
    q.best.beyond = std::max(q.best.beyond, beyond);
}

void HullTree::measure(Query& q, unsigned level, std::uint32_t node) {
  const Node& here = node_at(level, node);
  if (!here.left_out) {
    for (const std::uint32_t k : here.hull) measure_point(q, k);
    return;
  }
  measure(q, level - 1, 2 * node);
  if (2 * node + 1 < levels_[level - 1].size()) measure(q, level - 1, 2 * node + 1);
}

bool HullTree::is_best(const Query& q, std::uint32_t k) {
  std::uint64_t cross = 0;
  std::uint64_t beyond = 0;
  return (q.kernel.measure(q.chord, k, cross, beyond) ? Planar::squared(cross) : exact::U128{beyond} * q.scale) == q.farthest;
}

// The first (or last) point of the node that is as far as the best; kNone without one.
std::uint32_t HullTree::first_best(const Query& q, unsigned level, std::uint32_t node, bool from_end) {
  const Node& here = node_at(level, node);
  if (!here.left_out && std::ranges::none_of(here.hull, [&](std::uint32_t k) { return is_best(q, k); })) return kNone;
  if (level == 0) {
    const std::uint32_t begin = node * kBlock;
    const std::uint32_t end = end_of(0, node);
    for (std::uint32_t i = 0; i < end - begin; ++i) {
      const std::uint32_t k = from_end ? end - 1 - i : begin + i;
      if (is_best(q, k)) return k;
    }
    return kNone;
  }
  for (const std::uint32_t side : {from_end ? 1U : 0U, from_end ? 0U : 1U}) {
    if (2 * node + side >= levels_[level - 1].size()) continue;
    const std::uint32_t k = first_best(q, level - 1, 2 * node + side, from_end);
    if (k != kNone) return k;
  }
  return kNone;
}

// The best point of [first, end) that is closest to its end (or its start).
std::uint32_t HullTree::closest_best(const Query& q, std::uint32_t first, std::uint32_t end, bool from_end) {
  const std::uint32_t whole = std::min(end, (first + kBlock - 1) / kBlock * kBlock);
  const std::uint32_t rest = std::max(whole, end / kBlock * kBlock);
  const auto scan = [&](std::uint32_t low, std::uint32_t high) {
    for (std::uint32_t i = 0; i < high - low; ++i) {
      const std::uint32_t k = from_end ? high - 1 - i : low + i;
      if (is_best(q, k)) return k;
    }
    return kNone;
  };
  const auto in_nodes = [&] {
    std::uint32_t found = kNone;
    visit_nodes(whole / kBlock, rest / kBlock, [&](unsigned level, std::uint32_t node) {
      const std::uint32_t k = first_best(q, level, node, from_end);
      if (k != kNone) found = k;
      return k != kNone && !from_end; // from the end the last one counts
    });
    return found;
  };
  std::uint32_t k = from_end ? scan(rest, end) : scan(first, whole);
  if (k == kNone) k = in_nodes();
  if (k == kNone) k = from_end ? scan(first, whole) : scan(rest, end);
  return k;
}

Found HullTree::find(std::uint32_t a, std::uint32_t b) {
  Query q{.kernel = {u_, v_}, .chord = Planar{u_, v_}.chord(a, b), .best = {}};
  q.scale = std::max<std::uint64_t>(q.chord.length, 1);
  const std::uint32_t first = a + 1;
  const std::uint32_t whole = std::min(b, (first + kBlock - 1) / kBlock * kBlock);
  const std::uint32_t rest = std::max(whole, b / kBlock * kBlock);
  for (std::uint32_t k = first; k < whole; ++k) measure_point(q, k);
  for (std::uint32_t k = rest; k < b; ++k) measure_point(q, k);
  visit_nodes(whole / kBlock, rest / kBlock, [&](unsigned level, std::uint32_t node) {
    measure(q, level, node);
    return false;
  });
  q.farthest = std::max(Planar::squared(q.best.cross), exact::U128{q.best.beyond} * q.scale);

  const std::uint32_t middle = a + (b - a) / 2;
  const std::uint32_t low = closest_best(q, first, middle + 1, true);
  const std::uint32_t high = closest_best(q, middle + 1, b, false);
  const bool take_low = high == kNone || (low != kNone && a + b - 2 * low <= 2 * high - (a + b));
  const std::uint32_t k = take_low ? low : high;
  std::uint64_t cross = 0;
  std::uint64_t beyond = 0;
  if (q.kernel.measure(q.chord, k, cross, beyond))
    return {k, exact::nearest_double(Planar::squared(cross)), exact::nearest_double(q.chord.length)};
  return {k, exact::nearest_double(beyond), 1.0};
}

} // namespace scansion
