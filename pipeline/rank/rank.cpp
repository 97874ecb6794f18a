// The complete Douglas-Peucker rearrangement with an explicit stack.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rank/rank.hpp"

#include "pipeline/rank/chord.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <type_traits>

namespace scansion {
namespace {

/// How far index k is from the middle of the interval (a, b), doubled: the smaller, the closer.
class MiddleRule {
public:
  explicit MiddleRule(std::span<const std::uint32_t> position) noexcept : position_(position) {}

  [[nodiscard]] std::int64_t off_middle(std::size_t k, std::size_t a, std::size_t b) const noexcept {
    const std::int64_t twice = 2 * at(k) - (at(a) + at(b));
    return twice < 0 ? -twice : twice;
  }
  /// The inner point closest to the middle, the smaller index of two; a + 1 < b.
  [[nodiscard]] std::size_t middle(std::size_t a, std::size_t b) const noexcept {
    if (position_.empty()) return (a + b) / 2;
    const auto inner = position_.subspan(a + 1, b - a - 1);
    const auto upper = std::ranges::lower_bound(inner, (position_[a] + position_[b]) / 2);
    std::size_t k = a + 1 + static_cast<std::size_t>(upper - inner.begin());
    if (k == b) return b - 1;
    if (k > a + 1 && off_middle(k - 1, a, b) <= off_middle(k, a, b)) --k;
    return k;
  }

private:
  [[nodiscard]] std::int64_t at(std::size_t k) const noexcept {
    return position_.empty() ? static_cast<std::int64_t>(k) : static_cast<std::int64_t>(position_[k]);
  }
  std::span<const std::uint32_t> position_;
};

template <class Kernel>
struct Farthest {
  std::size_t index = 0;
  exact::Squared<typename Kernel::Number, typename Kernel::Length> distance;
};

template <class Kernel>
Farthest<Kernel> farthest(const Kernel& kernel, const MiddleRule& rule, std::size_t a, std::size_t b) {
  const auto chord = kernel.chord(a, b);
  // Best inside the ends and best beyond them are kept apart: within each the comparison is one integer.
  typename Kernel::Cross best_cross = 0;
  typename Kernel::Beyond best_beyond = 0;
  std::size_t inside = 0;
  std::size_t outside = 0;
  for (std::size_t k = a + 1; k < b; ++k) {
    typename Kernel::Cross cross;
    typename Kernel::Beyond beyond;
    if (kernel.measure(chord, k, cross, beyond)) {
      if (cross > best_cross || inside == 0 ||
          (cross == best_cross && rule.off_middle(k, a, b) < rule.off_middle(inside, a, b))) {
        best_cross = cross;
        inside = k;
      }
    } else if (beyond > best_beyond || outside == 0 ||
               (beyond == best_beyond && rule.off_middle(k, a, b) < rule.off_middle(outside, a, b))) {
      best_beyond = beyond;
      outside = k;
    }
  }
  const Farthest<Kernel> in{inside, {Kernel::squared(best_cross), chord.length}};
  const Farthest<Kernel> out{outside, {best_beyond, 1}};
  if (outside == 0) return in;
  if (inside == 0) return out;
  const int order = exact::compare(in.distance, out.distance, chord.length);
  if (order != 0) return order > 0 ? in : out;
  const std::int64_t in_off = rule.off_middle(inside, a, b);
  const std::int64_t out_off = rule.off_middle(outside, a, b);
  return in_off < out_off || (in_off == out_off && inside < outside) ? in : out;
}

} // namespace

void Ranker::rank(const RunPoints& run, std::span<double> distance, std::span<std::uint32_t> depth) {
  const std::size_t n = run.size();
  if (n == 0) return;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const std::size_t end : {std::size_t{0}, n - 1}) {
    distance[end] = kInfinity;
    depth[end] = 0;
  }
  if (n < 3) return;

  const MiddleRule rule(run.position);
  with_kernel(run, [&](const auto& kernel) {
    stack_.clear();
    stack_.push_back({0, static_cast<std::uint32_t>(n - 1), 1, kInfinity});
    while (!stack_.empty()) {
      Interval i = stack_.back();
      stack_.pop_back();
      while (i.b - i.a >= 2) {
        std::size_t split;
        double d = 0.0;
        if (i.parent == 0.0) {
          split = rule.middle(i.a, i.b); // a chord on which all points lie: repeated bisection
        } else {
          const auto f = farthest(kernel, rule, i.a, i.b);
          split = f.index;
          d = std::min(exact::millimetres(f.distance, resolution_), i.parent);
        }
        distance[split] = d;
        depth[split] = i.depth;
        // The longer half waits, the shorter one is next: the stack stays below log2(n) entries.
        const auto k = static_cast<std::uint32_t>(split);
        const Interval left{i.a, k, i.depth + 1, d};
        const Interval right{k, i.b, i.depth + 1, d};
        const bool left_is_longer = k - i.a > i.b - k;
        stack_.push_back(left_is_longer ? left : right);
        i = left_is_longer ? right : left;
      }
    }
  });
}

void rank_order(std::span<const double> distance, std::span<const std::uint32_t> depth, std::vector<std::uint32_t>& order) {
  order.resize(distance.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t p, std::uint32_t q) {
    if (distance[p] != distance[q]) return distance[p] > distance[q];
    if (depth[p] != depth[q]) return depth[p] < depth[q];
    return p < q;
  });
}

double segment_distance(const RunPoints& run, std::size_t p, std::size_t a, std::size_t b, Rational resolution) {
  // All kernels give the same numerator and denominator; three points decide which one is wide enough.
  const auto three = [&](std::span<const std::int32_t> axis) { return std::array{axis[a], axis[p], axis[b]}; };
  const auto x = three(run.x);
  const auto y = three(run.y);
  const auto z = three(run.z);
  return with_kernel({x, y, z, {}}, [&](const auto& kernel) {
    using Kernel = std::remove_cvref_t<decltype(kernel)>;
    using Squared = exact::Squared<typename Kernel::Number, typename Kernel::Length>;
    const auto chord = kernel.chord(0, 2);
    typename Kernel::Cross cross;
    typename Kernel::Beyond beyond;
    return kernel.measure(chord, 1, cross, beyond)
               ? exact::millimetres(Squared{Kernel::squared(cross), chord.length}, resolution)
               : exact::millimetres(Squared{beyond, 1}, resolution);
  });
}

} // namespace scansion
