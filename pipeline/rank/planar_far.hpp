// Farthest points of planar intervals in doubles, which are exact while spans stay below 2^26 counts. Of longer runs that are
// less wide than long (kLong) cross products are still exact; dot products are not, so what lies beyond an end or too near to
// one is searched point by point. Included by the units of each instruction set.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/lanes.hpp"
#include "pipeline/rank/vector_tree.hpp"

namespace scansion {
namespace {

/// Runs of spans below this are exact.
inline constexpr std::uint32_t kPlanarExact = 1U << 26U;
/// Cross products of longer ones are where the product of both spans is below this.
inline constexpr std::uint64_t kCrossExact = std::uint64_t{1} << 52U;

template <bool kLong>
class PlanarFar {
public:
  // A dot product has two products of at most span^2 and their sum: off by 2^-51 of that. The bound is generous.
  PlanarFar(const VectorJob& job, std::uint32_t span) : job_(job), dot_off_(kLong ? 0x1p-49 * span * span : 0.0) {}

  /// One inner point. Spans below 2^30 leave room for all sums in 64 bits.
  void find_one(Batch& batch, unsigned i) const {
    const auto [a, b] = batch.interval[i];
    const std::int64_t eu = std::int64_t{job_.u[b]} - job_.u[a];
    const std::int64_t ev = std::int64_t{job_.v[b]} - job_.v[a];
    std::int64_t du = std::int64_t{job_.u[a + 1]} - job_.u[a];
    std::int64_t dv = std::int64_t{job_.v[a + 1]} - job_.v[a];
    const std::int64_t dot = du * eu + dv * ev;
    const std::int64_t length = eu * eu + ev * ev;
    const auto cross = static_cast<double>(eu * dv - ev * du);
    const bool ahead = dot > 0;
    du -= ahead ? eu : 0;
    dv -= ahead ? ev : 0;
    const bool inside = ahead && dot < length;
    batch.put(i, a + 1, inside ? cross * cross : static_cast<double>(du * du + dv * dv),
              inside ? static_cast<double>(length) : 1.0);
  }

  /// Up to kInner inner points.
  template <unsigned kInner>
  void find_short(Batch& batch, unsigned i) const {
    constexpr unsigned kVectors = kInner / R::kLanes;
    const auto [a, b] = batch.interval[i];
    const unsigned inner = b - a - 1;
    const Chord chord(job_, a, b, dot_off_);
    V cross[kVectors];
    V most = R::set1(0);
    std::uint32_t outside = 0;
    for (unsigned v = 0; v < kVectors; ++v) {
      const unsigned before = v * R::kLanes;
      const auto lanes = R::first(inner <= before ? 0 : smaller(inner - before, R::kLanes));
      const Step d = step(chord, a + 1 + before);
      cross[v] = R::keep(lanes, cross_of(chord, d));
      outside |= R::bits(R::without(lanes, R::inside(dot_of(chord, d), chord.length)));
      most = R::max(most, cross[v]);
    }
    if (outside != 0) return find_beyond(batch, i);
    const double top = R::top(most);
    const V all = R::set1(top);
    std::uint64_t mask = 0;
    for (unsigned v = 0; v < kVectors; ++v)
      mask |= static_cast<std::uint64_t>(R::bits(R::equal(cross[v], all))) << (v * R::kLanes);
    mask &= ~std::uint64_t{0} >> (64 - inner);
    batch.put(i, a + 1 + closest_to_middle(mask, inner), top * top, chord.squared);
  }

  void find_more(Batch& batch, unsigned i) const {
    const auto [a, b] = batch.interval[i];
    const Chord chord(job_, a, b, dot_off_);
    Top top;
    V nearest = chord.length;
    V farthest = R::set1(0);
    const auto measure = [&](std::uint32_t k) {
      const Step d = step(chord, k);
      const V dot = dot_of(chord, d);
      nearest = R::min(nearest, dot);
      farthest = R::max(farthest, dot);
      return cross_of(chord, d);
    };
    std::uint32_t k = a + 1;
    for (; k + kStretch <= b; k += kStretch) {
      V most = measure(k);
#pragma GCC unroll 4
      for (unsigned v = 1; v < kTogether; ++v) most = R::max(most, measure(k + v * R::kLanes));
      top.see(most, k);
    }
    const std::uint32_t whole = k; // stretches before, single vectors from here on
    for (; k + R::kLanes <= b; k += R::kLanes) top.see(measure(k), k);
    std::uint32_t outside =
        R::bits(R::without(R::first(R::kLanes), R::both(R::inside(nearest, chord.length), R::inside(farthest, chord.length))));
    if (k < b) {
      const auto lanes = R::first(b - k);
      const Step d = step(chord, k);
      top.see(R::keep(lanes, cross_of(chord, d)), k);
      outside |= R::bits(R::without(lanes, R::inside(dot_of(chord, d), chord.length)));
    }
    if (outside != 0) return find_beyond(batch, i);
    const double cross = R::top(top.most);
    const V all = R::set1(cross);
    const auto marked = [&](std::uint32_t first, unsigned count) {
      return R::bits(R::equal(cross_of(chord, step(chord, first)), all)) & ((1U << count) - 1U);
    };
    std::uint64_t mask = 0;
    const std::uint32_t first = top.only(all);
    if (first != 0) {
      const std::uint32_t end = first < whole ? first + kStretch : smaller(b, first + R::kLanes);
      for (std::uint32_t at = first; at < end; at += R::kLanes)
        mask |= std::uint64_t{marked(at, smaller(end - at, R::kLanes))} << (at - first);
    }
    const bool alone = mask != 0 && (mask & (mask - 1)) == 0;
    const std::uint32_t best =
        alone ? first + static_cast<std::uint32_t>(__builtin_ctzll(mask)) : closest_marked(a, b, R::kLanes, marked);
    batch.put(i, best, cross * cross, chord.squared);
  }

  /// Some inner points lie beyond the ends of the chord: there the distance to the end counts. The interval reaches less than
  /// kPlanarExact.
  void find_mixed(Batch& batch, unsigned i) const {
    const auto [a, b] = batch.interval[i];
    const Chord chord(job_, a, b, 0);
    const auto measure = [&](std::uint32_t first, unsigned count) {
      const auto lanes = R::first(count);
      const Step d = step(chord, first);
      const V dot = whole_dot_of(chord, d);
      const auto inside = R::inside(dot, chord.length);
      const auto ahead = R::equal(R::max(dot, chord.length), dot);
      const Step f{R::sub(d.u, R::keep(ahead, chord.along_u)), R::sub(d.v, R::keep(ahead, chord.along_v))};
      return Mixed{R::both(lanes, inside), R::without(lanes, inside), cross_of(chord, d),
                   R::add(R::mul(f.u, f.u), R::mul(f.v, f.v))};
    };
    V most_cross = R::set1(0);
    V most_beyond = R::set1(0);
    bool any_inside = false;
    for (std::uint32_t k = a + 1; k < b; k += R::kLanes) {
      const Mixed m = measure(k, smaller(b - k, R::kLanes));
      any_inside |= R::bits(m.inside) != 0;
      most_cross = R::max(most_cross, R::keep(m.inside, m.cross));
      most_beyond = R::max(most_beyond, R::keep(m.outside, m.beyond));
    }
    const double cross = R::top(most_cross);
    const double beyond = R::top(most_beyond);
    __extension__ using Wide = unsigned __int128;
    const auto whole = [](double v) { return static_cast<Wide>(static_cast<std::uint64_t>(v)); };
    const Wide in = whole(cross) * whole(cross);
    const Wide out = whole(beyond) * whole(chord.squared);
    const bool take_inside = any_inside && in >= out;
    const bool take_outside = !any_inside || out >= in;
    const V all_cross = R::set1(cross);
    const V all_beyond = R::set1(beyond);
    const std::uint32_t best = closest_marked(a, b, R::kLanes, [&](std::uint32_t first, unsigned count) {
      const Mixed m = measure(first, count);
      const std::uint32_t inside = R::bits(R::both(m.inside, R::equal(m.cross, all_cross)));
      const std::uint32_t outside = R::bits(R::both(m.outside, R::equal(m.beyond, all_beyond)));
      return (take_inside ? inside : 0U) | (take_outside ? outside : 0U);
    });
    // Which of the two the point is does not matter for its distance, but does for the rounding: as it is measured.
    const bool is_inside = take_inside && (R::bits(measure(best, 1).inside) & 1U) != 0;
    batch.put(i, best, is_inside ? cross * cross : beyond, is_inside ? chord.squared : 1.0);
  }

private:
  void find_beyond(Batch& batch, unsigned i) const {
    if constexpr (kLong)
      batch.put(i, job_.exact(job_, batch.interval[i].a, batch.interval[i].b));
    else
      find_mixed(batch, i);
  }

  using R = Reals;
  using V = typename R::V;
  // Where the maximum is, is noted once for so many vectors.
  static constexpr unsigned kTogether = 4;
  static constexpr unsigned kStretch = kTogether * R::kLanes;

  /// The maximum of each lane, in which stretch of points it was seen first, and whether an equal one was seen later.
  struct Top {
    V most = R::set1(0), at = R::set1(0);
    typename R::M tied = R::first(0);

    void see(V stretch, std::uint32_t first) {
      tied = R::either(tied, R::equal(stretch, most));
      at = R::pick(R::greater(stretch, most), R::set1(static_cast<double>(first)), at);
      most = R::max(most, stretch);
    }
    /// The first point of the only stretch that has `top`; 0 when there may be several.
    [[nodiscard]] std::uint32_t only(V top) const {
      const std::uint32_t lanes = R::bits(R::equal(most, top));
      if ((lanes & (lanes - 1)) != 0 || (lanes & R::bits(tied)) != 0) return 0;
      double first[R::kLanes];
      R::store(first, at);
      return static_cast<std::uint32_t>(first[__builtin_ctz(lanes)]);
    }
  };

  struct Chord {
    V base_u, base_v, along_u, along_v, length;
    double squared;
    // Spans are below 2^30, so this is the exact square, rounded once. Dot products come with dot_off taken away; one near an
    // end counts as beyond it.
    Chord(const VectorJob& job, std::uint32_t a, std::uint32_t b, double dot_off) {
      const std::int64_t u = std::int64_t{job.u[b]} - job.u[a];
      const std::int64_t v = std::int64_t{job.v[b]} - job.v[a];
      squared = static_cast<double>(u * u + v * v);
      base_u = R::set1(job.u[a]);
      base_v = R::set1(job.v[a]);
      along_u = R::set1(static_cast<double>(u));
      along_v = R::set1(static_cast<double>(v));
      length = R::set1(squared - 3 * dot_off);
    }
  };
  struct Step {
    V u, v; ///< from the first end of the chord
  };
  struct Mixed {
    typename R::M inside, outside;
    V cross, beyond;
  };

  [[nodiscard]] Step step(const Chord& c, std::uint32_t first) const {
    return {R::sub(R::load(job_.u + first), c.base_u), R::sub(R::load(job_.v + first), c.base_v)};
  }
  [[nodiscard]] static V cross_of(const Chord& c, const Step& d) {
    return R::abs(R::mul_sub(d.v, c.along_u, R::mul(d.u, c.along_v)));
  }
  [[nodiscard]] static V whole_dot_of(const Chord& c, const Step& d) {
    return R::mul_add(d.u, c.along_u, R::mul(d.v, c.along_v));
  }
  [[nodiscard]] V dot_of(const Chord& c, const Step& d) const {
    if constexpr (kLong) return R::sub(whole_dot_of(c, d), R::set1(dot_off_));
    return whole_dot_of(c, d);
  }

  const VectorJob& job_;
  double dot_off_; ///< bound of what is rounded, in squared counts
};

} // namespace
} // namespace scansion
