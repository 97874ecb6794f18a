// Farthest points of intervals of a planar run. Intervals that reach less than 2^15 counts are measured in 16 bit halves, all
// others in doubles, which are exact below 2^26 counts. Included by the units of each instruction set.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/lanes.hpp"
#include "pipeline/rank/vector_tree.hpp"

namespace scansion {
namespace {

// The class of an interval of b - a steps; see PlanarSearch::kClasses.
struct ClassOfLength {
  static constexpr unsigned kLongest = 66;
  std::uint8_t of[kLongest + 1];
  constexpr ClassOfLength() : of{} {
    constexpr unsigned kMostInner[] = {0, 1, 4, 8, 16, 32, 64, 65};
    for (unsigned length = 1, c = 0; length <= kLongest; ++length) {
      if (length - 1 > kMostInner[c]) ++c;
      of[length] = static_cast<std::uint8_t>(c);
    }
  }
};
constexpr ClassOfLength kClassOf{};

class PlanarSearch {
public:
  // One inner point, up to 4, 8, 16, 32, 64, more; the last class reaches too far for 16 bits.
  static constexpr unsigned kClasses = 9;
  static constexpr bool kLone = true;
  static constexpr unsigned kMore = 7;
  static constexpr unsigned kFar = 8;
  static constexpr std::int32_t kShortReach = 1 << 15;

  static std::uint32_t least_inner(unsigned c) {
    constexpr std::uint32_t kLeast[kClasses] = {0, 1, 2, 5, 9, 17, 33, 65, 1};
    return kLeast[c];
  }

  PlanarSearch(const VectorJob& job, std::uint32_t span) : job_(job), wide_(span >= (1U << 26U)) {
    const std::uint32_t n = job.n;
    const std::int32_t* __restrict const u = job.u;
    const std::int32_t* __restrict const v = job.v;
    std::uint32_t* __restrict const pairs = job.pairs;
    std::uint32_t* __restrict const reach = job.reach;
    for (std::uint32_t i = 0; i < n; ++i)
      pairs[i] = (static_cast<std::uint32_t>(u[i]) & 0xFFFFU) | (static_cast<std::uint32_t>(v[i]) << 16U);
    // Steps are cut at the reach that counts, so the sum over an interval shorter than that cannot overflow.
    reach[0] = 0;
    for (std::uint32_t i = 1; i < n; ++i) {
      const std::int32_t du = u[i] - u[i - 1];
      const std::int32_t dv = v[i] - v[i - 1];
      reach[i] = static_cast<std::uint32_t>(smaller(larger(du < 0 ? -du : du, dv < 0 ? -dv : dv), kShortReach));
    }
    std::uint32_t sum = 0;
    for (std::uint32_t i = 1; i < n; ++i) reach[i] = sum += reach[i];
  }

  [[nodiscard]] unsigned class_of(std::uint32_t a, std::uint32_t b) const {
    constexpr std::uint32_t kLimit = kShortReach;
    const bool is_short = b - a < kLimit && job_.reach[b] - job_.reach[a] < kLimit;
    const unsigned by_size = kClassOf.of[smaller(b - a, ClassOfLength::kLongest)];
    return is_short || by_size == 0 ? by_size : kFar;
  }
  // The same for the parts of an interval of class c: those of short ones are short.
  template <unsigned c>
  [[nodiscard]] unsigned class_of_part(std::uint32_t a, std::uint32_t b) const {
    if constexpr (c == kFar) return class_of(a, b);
    if constexpr (c == kMore) return kClassOf.of[smaller(b - a, ClassOfLength::kLongest)];
    return kClassOf.of[b - a];
  }

  template <unsigned c>
  void find(Batch& batch, unsigned count) {
    if constexpr (c == 1) find_lone(batch, count);
    if constexpr (c == 2) find_short<Lanes4, 4>(batch, count);
    if constexpr (c == 3) find_short<Lanes8, 8>(batch, count);
    if constexpr (c == 4) find_short<Lanes16, 16>(batch, count);
    if constexpr (c == 5) find_short<Lanes16, 32>(batch, count);
    if constexpr (c == 6) find_short<Lanes16, 64>(batch, count);
    if constexpr (c < kMore) return;
    for (unsigned i = 0; i < count; ++i) {
      if (guarded(batch, i)) continue;
      if constexpr (c == kMore) find_more(batch, i);
      if constexpr (c == kFar) find_far(batch, i);
    }
  }

private:
  // A chord in 16 bit halves, spread over lanes.
  template <class L>
  struct Chord {
    typename L::V base, along, across, length;
    Chord(const std::uint32_t* from, const std::uint32_t* to)
        : base(L::spread(from)), along(L::sub16(L::spread(to), base)), across(L::across(along)), length(L::madd(along, along)) {
    }
  };

  void exactly(Batch& batch, unsigned i) {
    const Found found = job_.exact(job_, batch.interval[i].a, batch.interval[i].b);
    batch.index[i] = found.index;
    batch.numerator[i] = found.numerator;
    batch.denominator[i] = found.denominator;
  }
  bool guarded(Batch& batch, unsigned i) {
    const std::uint32_t inner = batch.interval[i].b - batch.interval[i].a - 1;
    if (work_ > kGuardedWork * job_.n && inner >= kGuardedInner && job_.guarded != nullptr) {
      const Found found = job_.guarded(job_, batch.interval[i].a, batch.interval[i].b);
      batch.index[i] = found.index;
      batch.numerator[i] = found.numerator;
      batch.denominator[i] = found.denominator;
      return true;
    }
    work_ += inner;
    return false;
  }
  static void put(Batch& batch, unsigned i, std::uint32_t k, double cross, double squared) {
    batch.index[i] = k;
    batch.numerator[i] = cross * cross;
    batch.denominator[i] = squared;
  }

  void find_lone(Batch& batch, unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      const std::uint32_t a = batch.interval[i].a;
      const auto u = [&](std::uint32_t k) { return static_cast<std::int16_t>(job_.pairs[k] - job_.pairs[a]); };
      const auto v = [&](std::uint32_t k) {
        return static_cast<std::int16_t>((job_.pairs[k] >> 16U) - (job_.pairs[a] >> 16U));
      };
      const std::int32_t eu = u(a + 2);
      const std::int32_t ev = v(a + 2);
      const std::int32_t du = u(a + 1);
      const std::int32_t dv = v(a + 1);
      const std::int32_t dot = du * eu + dv * ev;
      const std::int32_t squared = eu * eu + ev * ev;
      const double cross = eu * dv - ev * du;
      const std::int32_t fu = dot > 0 ? du - eu : du;
      const std::int32_t fv = dot > 0 ? dv - ev : dv;
      const bool inside = dot > 0 && dot < squared;
      // The last bound of a short reach: |f| stays below 2^15 on each axis, so the sum of squares fits.
      const double beyond = fu * fu + fv * fv;
      batch.index[i] = a + 1;
      batch.numerator[i] = inside ? cross * cross : beyond;
      batch.denominator[i] = inside ? squared : 1;
    }
  }

  template <class L, unsigned kInner>
  void find_short(Batch& batch, unsigned count) {
    constexpr unsigned kVectors = (kInner + L::kLanes - 1) / L::kLanes;
    for (unsigned i = 0; i < count; ++i) {
      const auto [a, b] = batch.interval[i];
      const unsigned inner = b - a - 1;
      const std::uint32_t* const points = job_.pairs + a + 1;
      const Chord<L> chord(job_.pairs + a, job_.pairs + b);
      typename L::V cross[kVectors];
      typename L::V most = L::zero();
      std::uint32_t outside = 0;
      for (unsigned v = 0; v < kVectors; ++v) {
        const unsigned before = v * L::kLanes;
        const auto lanes = L::first(inner <= before ? 0 : smaller(inner - before, L::kLanes));
        const auto d = L::sub16(L::load(points + before), chord.base);
        cross[v] = L::keep(lanes, L::abs32(L::madd(d, chord.across)));
        outside |= L::bits(L::without(lanes, L::inside(L::madd(d, chord.along), chord.length)));
        most = L::max32(most, cross[v]);
      }
      if (outside != 0) {
        exactly(batch, i);
        continue;
      }
      const auto top = L::top(most);
      std::uint64_t mask = 0;
      for (unsigned v = 0; v < kVectors; ++v)
        mask |= static_cast<std::uint64_t>(L::bits(L::equal(cross[v], top))) << (v * L::kLanes);
      mask &= ~std::uint64_t{0} >> (64 - inner);
      put(batch, i, a + 1 + closest_to_middle(mask, inner), L::lane0(top), L::lane0(chord.length));
    }
  }

  void find_more(Batch& batch, unsigned i) {
    using L = Lanes16;
    const auto [a, b] = batch.interval[i];
    const Chord<L> chord(job_.pairs + a, job_.pairs + b);
    typename L::V most = L::zero();
    std::uint32_t outside = 0;
    std::uint32_t k = a + 1;
    for (; k + L::kLanes <= b; k += L::kLanes) {
      const auto d = L::sub16(L::load(job_.pairs + k), chord.base);
      most = L::max32(most, L::abs32(L::madd(d, chord.across)));
      outside |= L::bits(L::without(L::first(L::kLanes), L::inside(L::madd(d, chord.along), chord.length)));
    }
    if (k < b) {
      const auto lanes = L::first(b - k);
      const auto d = L::sub16(L::load(job_.pairs + k), chord.base);
      most = L::max32(most, L::keep(lanes, L::abs32(L::madd(d, chord.across))));
      outside |= L::bits(L::without(lanes, L::inside(L::madd(d, chord.along), chord.length)));
    }
    if (outside != 0) return exactly(batch, i);
    const auto top = L::top(most);
    const std::uint32_t best = closest_marked(a, b, L::kLanes, [&](std::uint32_t first, unsigned count) {
      const auto d = L::sub16(L::load(job_.pairs + first), chord.base);
      return L::bits(L::equal(L::abs32(L::madd(d, chord.across)), top)) & ((1U << count) - 1U);
    });
    put(batch, i, best, L::lane0(top), L::lane0(chord.length));
  }

  void find_far(Batch& batch, unsigned i) {
    if (wide_) return exactly(batch, i);
    using R = Reals;
    const auto [a, b] = batch.interval[i];
    const double u = static_cast<double>(job_.u[b]) - job_.u[a];
    const double v = static_cast<double>(job_.v[b]) - job_.v[a];
    const double squared = u * u + v * v;
    const auto base_u = R::set1(job_.u[a]);
    const auto base_v = R::set1(job_.v[a]);
    const auto along_u = R::set1(u);
    const auto along_v = R::set1(v);
    const auto length = R::set1(squared);
    const auto cross = [&](typename R::V du, typename R::V dv) {
      return R::abs(R::sub(R::mul(dv, along_u), R::mul(du, along_v)));
    };
    typename R::V most = R::set1(0);
    std::uint32_t outside = 0;
    for (std::uint32_t k = a + 1; k < b; k += R::kLanes) {
      const auto lanes = R::first(smaller(b - k, R::kLanes));
      const auto du = R::sub(R::load(job_.u + k), base_u);
      const auto dv = R::sub(R::load(job_.v + k), base_v);
      most = R::max(most, R::keep(lanes, cross(du, dv)));
      outside |= R::bits(R::without(lanes, R::inside(R::add(R::mul(du, along_u), R::mul(dv, along_v)), length)));
    }
    if (outside != 0) return exactly(batch, i);
    const double top = R::top(most);
    const auto all = R::set1(top);
    const std::uint32_t best = closest_marked(a, b, R::kLanes, [&](std::uint32_t first, unsigned count) {
      const auto du = R::sub(R::load(job_.u + first), base_u);
      const auto dv = R::sub(R::load(job_.v + first), base_v);
      return R::bits(R::equal(cross(du, dv), all)) & ((1U << count) - 1U);
    });
    put(batch, i, best, top, squared);
  }

  const VectorJob& job_;
  bool wide_;
  std::uint64_t work_ = 0;
};

} // namespace
} // namespace scansion
