// Farthest points of intervals of a run in space, or of any run of long span, in doubles. What these round is bounded: where
// two points come too close to tell, or one to an end of the chord, the exact search decides. Included by the units of each
// instruction set.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/lanes.hpp"
#include "pipeline/rank/vector_tree.hpp"

namespace scansion {
namespace {

// Below kWide counts cross and dot products are exact and only squared lengths are rounded; kRounded: those are too.
template <bool kRounded>
class SpatialSearch {
public:
  static constexpr std::uint32_t kWide = 1U << 25U;
  static constexpr unsigned kExact = 0;
  static constexpr unsigned kClasses = 5; // one inner point, up to 8, 16, more
  static std::uint32_t least_inner(unsigned c) {
    constexpr std::uint32_t kLeast[kClasses] = {0, 1, 2, 9, 17};
    return kLeast[c];
  }

  static constexpr unsigned part_class(unsigned c) { return c - 1; }
  static constexpr bool is_short(unsigned) { return false; }

  // Differences are exact below 2^33. A product of two is off by 2^-53 of span^2 at most; a component of a cross product has
  // two and their difference, a dot product three and two sums: both bounds are generous.
  SpatialSearch(const VectorJob& job, std::uint32_t span)
      : job_(job), cross_off_(kRounded ? 0x1p-50 * span * span : 0.0), dot_off_(kRounded ? 0x1p-49 * span * span : 0.0) {}

  [[nodiscard]] static unsigned class_of(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t inner = b - a - 1;
    return (inner > 0 ? 1U : 0U) + (inner > 1 ? 1U : 0U) + (inner > 8 ? 1U : 0U) + (inner > 16 ? 1U : 0U);
  }

  template <unsigned c>
  [[nodiscard]] static unsigned class_of_part(std::uint32_t a, std::uint32_t b) {
    return class_of(a, b);
  }

  template <unsigned c>
  void find(Batch& batch, unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      if constexpr (c == 1)
        batch.put(i, job_.measure(job_, batch.interval[i].a, batch.interval[i].b, batch.interval[i].a + 1));
      else if constexpr (c == 2)
        find_short<8>(batch, i);
      else if constexpr (c == 3)
        find_short<16>(batch, i);
      else
        find_more(batch, i);
    }
  }

private:
  using R = Reals;
  using V = typename R::V;

  // Squared sums of three products are off by less than this, relatively.
  static constexpr double kNearly = 1.0 - 0x1p-50;
  static constexpr double kExactBelow = 0x1p53;

  // Points below this squared length cannot be the farthest when `top` has been seen; equal to top when all is exact.
  [[nodiscard]] double bound_for(double top) const {
    if (!kRounded) return top < kExactBelow ? top : top * kNearly;
    const double least = (__builtin_sqrt(top) * kNearly - 2 * cross_off_) * (1.0 - 0x1p-48);
    return least > 0 ? least * least * kNearly : 0.0;
  }
  // Whether several points above the bound are ties, rather than too close to tell.
  [[nodiscard]] static bool ties_are_exact(double top) { return !kRounded && top < kExactBelow; }

  struct Chord {
    V base[3], along[3], length;
    double e[3], squared;
    Chord(const VectorJob& job, std::uint32_t a, std::uint32_t b, double dot_off) {
      const std::int32_t* const axes[3] = {job.u, job.v, job.w};
      squared = 0;
      for (unsigned k = 0; k < 3; ++k) {
        e[k] = static_cast<double>(axes[k][b]) - axes[k][a];
        squared += e[k] * e[k];
        base[k] = R::set1(axes[k][a]);
        along[k] = R::set1(e[k]);
      }
      // Dot products come with dot_off taken away; one near an end counts as beyond it.
      length = R::set1(squared - 3 * dot_off);
    }
  };
  struct Measured {
    V squared_cross, dot;
  };

  [[nodiscard]] Measured measure(const Chord& c, std::uint32_t first) const {
    const V x = R::sub(R::load(job_.u + first), c.base[0]);
    const V y = R::sub(R::load(job_.v + first), c.base[1]);
    const V z = R::sub(R::load(job_.w + first), c.base[2]);
    const V cx = R::sub(R::mul(c.along[1], z), R::mul(c.along[2], y));
    const V cy = R::sub(R::mul(c.along[2], x), R::mul(c.along[0], z));
    const V cz = R::sub(R::mul(c.along[0], y), R::mul(c.along[1], x));
    V dot = R::add(R::add(R::mul(x, c.along[0]), R::mul(y, c.along[1])), R::mul(z, c.along[2]));
    if constexpr (kRounded) dot = R::sub(dot, R::set1(dot_off_));
    return {R::add(R::add(R::mul(cx, cx), R::mul(cy, cy)), R::mul(cz, cz)), dot};
  }

  void exactly(Batch& batch, unsigned i) { batch.put(i, job_.exact(job_, batch.interval[i].a, batch.interval[i].b)); }

  // The squared cross product of point k, rounded once.
  [[nodiscard]] double squared_cross(std::uint32_t a, std::uint32_t k, const Chord& c) const {
    const double x = static_cast<double>(job_.u[k]) - job_.u[a];
    const double y = static_cast<double>(job_.v[k]) - job_.v[a];
    const double z = static_cast<double>(job_.w[k]) - job_.w[a];
    const double cross[3] = {c.e[1] * z - c.e[2] * y, c.e[2] * x - c.e[0] * z, c.e[0] * y - c.e[1] * x};
    __extension__ unsigned __int128 sum = 0;
    for (const double v : cross) {
      const auto magnitude = static_cast<std::uint64_t>(v < 0 ? -v : v);
      sum += static_cast<decltype(sum)>(magnitude) * magnitude;
    }
    return static_cast<double>(sum);
  }

  void put(Batch& batch, unsigned i, std::uint32_t k, double top, const Chord& chord) {
    const auto [a, b] = batch.interval[i];
    if constexpr (kRounded)
      batch.put(i, job_.measure(job_, a, b, k));
    else
      batch.put(i, k, top < kExactBelow ? top : squared_cross(a, k, chord), chord.squared);
  }

  template <unsigned kInner>
  void find_short(Batch& batch, unsigned i) {
    constexpr unsigned kVectors = kInner / R::kLanes;
    const auto [a, b] = batch.interval[i];
    const unsigned inner = b - a - 1;
    const Chord chord(job_, a, b, dot_off_);
    V square[kVectors];
    V most = R::set1(0);
    std::uint32_t outside = 0;
    for (unsigned v = 0; v < kVectors; ++v) {
      const unsigned before = v * R::kLanes;
      const auto lanes = R::first(inner <= before ? 0 : smaller(inner - before, R::kLanes));
      const Measured m = measure(chord, a + 1 + before);
      square[v] = R::keep(lanes, m.squared_cross);
      outside |= R::bits(R::without(lanes, R::inside(m.dot, chord.length)));
      most = R::max(most, square[v]);
    }
    if (outside != 0) return exactly(batch, i);
    const double top = R::top(most);
    const V bound = R::set1(bound_for(top));
    std::uint64_t mask = 0;
    for (unsigned v = 0; v < kVectors; ++v)
      mask |= static_cast<std::uint64_t>(R::bits(R::at_least(square[v], bound))) << (v * R::kLanes);
    mask &= ~std::uint64_t{0} >> (64 - inner);
    if (!ties_are_exact(top) && (mask & (mask - 1)) != 0) return exactly(batch, i);
    put(batch, i, a + 1 + closest_to_middle(mask, inner), top, chord);
  }

  void find_more(Batch& batch, unsigned i) {
    const auto [a, b] = batch.interval[i];
    const std::uint32_t inner = b - a - 1;
    if (work_ > kGuardedWork * job_.n && inner >= kGuardedInner && job_.guarded != nullptr)
      return batch.put(i, job_.guarded(job_, a, b));
    work_ += inner;
    const Chord chord(job_, a, b, dot_off_);
    V most = R::set1(0);
    std::uint32_t outside = 0;
    for (std::uint32_t k = a + 1; k < b; k += R::kLanes) {
      const auto lanes = R::first(smaller(b - k, R::kLanes));
      const Measured m = measure(chord, k);
      most = R::max(most, R::keep(lanes, m.squared_cross));
      outside |= R::bits(R::without(lanes, R::inside(m.dot, chord.length)));
    }
    if (outside != 0) return exactly(batch, i);
    const double top = R::top(most);
    const V bound = R::set1(bound_for(top));
    const auto bits_of = [&](std::uint32_t first, unsigned count) {
      return R::bits(R::at_least(measure(chord, first).squared_cross, bound)) & ((1U << count) - 1U);
    };
    if (!ties_are_exact(top)) {
      std::uint32_t candidates = 0;
      for (std::uint32_t k = a + 1; k < b; k += R::kLanes)
        candidates += static_cast<std::uint32_t>(__builtin_popcount(bits_of(k, smaller(b - k, R::kLanes))));
      if (candidates > 1) return exactly(batch, i);
    }
    put(batch, i, closest_marked(a, b, R::kLanes, bits_of), top, chord);
  }

  const VectorJob& job_;
  double cross_off_, dot_off_; ///< bounds of what is rounded, in squared counts
  std::uint64_t work_ = 0;
};

} // namespace
} // namespace scansion
