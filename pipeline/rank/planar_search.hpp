// Farthest points of intervals of a planar run. Intervals that reach less than 2^15 counts are measured in 16 bit halves, all
// others in doubles. Included by the units of each instruction set.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/lanes.hpp"
#include "pipeline/rank/planar_far.hpp"
#include "pipeline/rank/short_search.hpp"
#include "pipeline/rank/vector_tree.hpp"

namespace scansion {
namespace {

/// kLong: of spans up to kNarrowSpan, see planar_far.hpp.
template <bool kLong>
class PlanarSearch {
public:
  // Up to 14 inner points exactly; up to 32, 64, more; then, for those that reach too far for 16 bits, one, up to 8, 16, more.
  static constexpr unsigned kExact = kShortClasses;
  static constexpr unsigned kShort32 = 15;
  static constexpr unsigned kShort64 = 16;
  static constexpr unsigned kMore = 17;
  static constexpr unsigned kFar1 = 18;
  static constexpr unsigned kFar8 = 19;
  static constexpr unsigned kFar16 = 20;
  static constexpr unsigned kFar = 21;
  static constexpr unsigned kClasses = 22;
  static constexpr std::int32_t kShortReach = 1 << 15;

  static std::uint32_t least_inner(unsigned c) {
    constexpr std::uint32_t kLeast[kClasses - kExact] = {kExact, kExact + 1, 33, 65, 1, 2, 9, 17};
    return c < kExact ? c : kLeast[c - kExact];
  }

  static constexpr unsigned part_class(unsigned c) { return c == kFar ? kMore : c - 1; }
  static constexpr bool is_short(unsigned c) { return c <= kMore; }

  PlanarSearch(const VectorJob& job, std::uint32_t span) : job_(job), far_(job, span) {
    const std::uint32_t n = job.n;
    const std::int32_t* __restrict const u = job.u;
    const std::int32_t* __restrict const v = job.v;
    std::uint32_t* __restrict const pairs = job.pairs;
    std::uint32_t* __restrict const reach = job.reach;
    for (std::uint32_t i = 0; i < n; ++i)
      pairs[i] = (static_cast<std::uint32_t>(u[i]) & 0xFFFFU) | (static_cast<std::uint32_t>(v[i]) << 16U);
    // Steps are cut at the reach that counts, so the sum over an interval shorter than that cannot overflow.
    // Beyond the last point there is padding, which repeats it.
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::int32_t du = u[i + 1] - u[i];
      const std::int32_t dv = v[i + 1] - v[i];
      reach[i] = static_cast<std::uint32_t>(smaller(larger(du < 0 ? -du : du, dv < 0 ? -dv : dv), kShortReach));
    }
    sums_before(reach, n);
  }

  [[nodiscard]] unsigned class_of(std::uint32_t a, std::uint32_t b) const {
    constexpr std::uint32_t kLimit = kShortReach;
    const bool is_short = b - a < kLimit && job_.reach[b] - job_.reach[a] < kLimit;
    const std::uint32_t length = smaller(b - a, ClassOfLength::kLongest);
    return is_short ? kClassOf.in_halves[length] : kClassOf.in_doubles[length];
  }
  // The same for the parts of an interval of class c: those of short ones are short.
  template <unsigned c>
  [[nodiscard]] unsigned class_of_part(std::uint32_t a, std::uint32_t b) const {
    if constexpr (c >= kFar1) return class_of(a, b);
    if constexpr (c == kMore) return kClassOf.in_halves[smaller(b - a, ClassOfLength::kLongest)];
    return kClassOf.in_halves[b - a];
  }

  template <unsigned c>
  void find(Batch& batch, unsigned count) {
    batch.apart_count = 0;
    if constexpr (c == kShort32) find_short<Halves8, 32>(batch, count);
    if constexpr (c == kShort64) find_short<Lanes, 64>(batch, count);
    if constexpr (c < kMore) return;
    for (unsigned i = 0; i < count; ++i) {
      if ((c == kMore || c == kFar) && guarded(batch, i)) {
        if constexpr (c == kMore) batch.set_apart(i);
        continue;
      }
      if constexpr (c == kMore) {
        find_more(batch, i);
      } else {
        if constexpr (c == kFar1)
          far_.find_one(batch, i);
        else if constexpr (c == kFar8)
          far_.template find_short<8>(batch, i);
        else if constexpr (c == kFar16)
          far_.template find_short<16>(batch, i);
        else
          far_.find_more(batch, i);
      }
    }
  }

  template <unsigned c>
  Unsplit split_eight(const Waiting* w, double floor, Parts& parts) const {
    if constexpr (c == 1) {
      split_eight_ones(job_.pairs, w, parts);
      return {};
    } else if constexpr (c == 2) {
      return split_eight_twos(job_.pairs, w, floor, parts);
    } else {
      return scansion::split_eight<c>(job_.pairs, w, floor, parts);
    }
  }
  /// The one interval of a batch.
  void find_apart(Batch& batch) const { far_.find_mixed(batch, 0); }

private:
  struct ClassOfLength {
    static constexpr std::uint32_t kLongest = 66;
    std::uint8_t in_halves[kLongest + 1];
    std::uint8_t in_doubles[kLongest + 1];
  };
  static constexpr ClassOfLength class_of_length() {
    ClassOfLength r{};
    for (unsigned length = 1; length <= ClassOfLength::kLongest; ++length) {
      const unsigned inner = length - 1;
      r.in_halves[length] = static_cast<std::uint8_t>(inner <= kExact ? inner
                                                      : inner <= 32   ? kShort32
                                                      : inner <= 64   ? kShort64
                                                                      : kMore);
      r.in_doubles[length] = static_cast<std::uint8_t>(inner == 0    ? 0
                                                       : inner == 1  ? kFar1
                                                       : inner <= 8  ? kFar8
                                                       : inner <= 16 ? kFar16
                                                                     : kFar);
    }
    return r;
  }
  static const ClassOfLength kClassOf;

  // A chord in 16 bit halves, spread over lanes.
  template <class L>
  struct Chord {
    typename L::V base, along, across, length;
    Chord(const std::uint32_t* from, const std::uint32_t* to)
        : base(L::spread(from)), along(L::sub16(L::spread(to), base)), across(L::across(along)), length(L::madd(along, along)) {
    }
  };

  bool guarded(Batch& batch, unsigned i) {
    const auto [a, b] = batch.interval[i];
    const std::uint32_t inner = b - a - 1;
    if (work_ > kGuardedWork * job_.n && inner >= kGuardedInner && job_.guarded != nullptr) {
      batch.put(i, job_.guarded(job_, a, b));
      return true;
    }
    work_ += inner;
    return false;
  }

  // The farthest of more inner points than a vector has lanes: the last vector overlaps the one before, so that all lanes
  // count. More than half of kInner of them are looked at as if they were kInner.
  template <class L, unsigned kInner>
  void find_short(Batch& batch, unsigned count) {
    constexpr unsigned kVectors = kInner / L::kLanes;
    for (unsigned i = 0; i < count; ++i) {
      const auto [a, b] = batch.interval[i];
      const unsigned inner = b - a - 1;
      const std::uint32_t* const points = job_.pairs + a + 1;
      const Chord<L> chord(job_.pairs + a, job_.pairs + b);
      typename L::V cross[kVectors];
      unsigned first[kVectors];
      typename L::V most = L::zero();
      typename L::V nearest = chord.length;
      typename L::V farthest = L::zero();
#pragma GCC unroll 8
      for (unsigned v = 0; v < kVectors; ++v) {
        first[v] = smaller(v * L::kLanes, inner - L::kLanes);
        const auto d = L::sub16(L::load(points + first[v]), chord.base);
        const auto dot = L::madd(d, chord.along);
        cross[v] = L::abs32(L::madd(d, chord.across));
        most = L::max32(most, cross[v]);
        nearest = L::min32(nearest, dot);
        farthest = L::max32(farthest, dot);
      }
      if (!all_inside<L>(nearest, farthest, chord.length)) {
        find_mixed(batch, i);
        continue;
      }
      const auto top = L::top(most);
      std::uint64_t mask = 0;
#pragma GCC unroll 8
      for (unsigned v = 0; v < kVectors; ++v) mask |= static_cast<std::uint64_t>(L::bits(L::equal(cross[v], top))) << first[v];
      batch.index[i] = a + 1 + closest_to_middle(mask, inner);
      batch.cross[i] = L::lane0(top);
      batch.squared[i] = L::lane0(chord.length);
    }
  }

  void find_more(Batch& batch, unsigned i) {
    using L = Lanes;
    const auto [a, b] = batch.interval[i];
    const Chord<L> chord(job_.pairs + a, job_.pairs + b);
    typename L::V most = L::zero();
    typename L::V nearest = chord.length;
    typename L::V farthest = L::zero();
    // Where each lane saw its largest product first, and whether it saw an equal one later.
    typename L::V at = L::zero();
    typename L::S tied = L::greater(most, most);
    const auto look_at = [&](std::uint32_t k) {
      const auto d = L::sub16(L::load(job_.pairs + k), chord.base);
      const auto dot = L::madd(d, chord.along);
      const auto cross = L::abs32(L::madd(d, chord.across));
      at = L::pick(L::greater(cross, most), L::set1(static_cast<std::int32_t>(k)), at);
      tied = L::either(tied, L::equal(cross, most));
      most = L::max32(most, cross);
      nearest = L::min32(nearest, dot);
      farthest = L::max32(farthest, dot);
    };
    for (std::uint32_t k = a + 1; k < b - L::kLanes; k += L::kLanes) look_at(k);
    look_at(b - L::kLanes);
    if (!all_inside<L>(nearest, farthest, chord.length)) return find_mixed(batch, i);
    const auto top = L::top(most);
    const std::uint32_t lanes = L::bits(L::equal(most, top));
    if ((lanes & (lanes - 1)) == 0 && (lanes & L::bits(tied)) == 0) {
      std::uint32_t first[L::kLanes];
      L::store(first, at);
      const auto lane = static_cast<unsigned>(__builtin_ctz(lanes));
      batch.index[i] = first[lane] + lane;
    } else {
      batch.index[i] = closest_marked(a, b, L::kLanes, [&](std::uint32_t from, unsigned count) {
        const auto d = L::sub16(L::load(job_.pairs + from), chord.base);
        return L::bits(L::equal(L::abs32(L::madd(d, chord.across)), top)) & ((1U << count) - 1U);
      });
    }
    batch.cross[i] = L::lane0(top);
    batch.squared[i] = L::lane0(chord.length);
  }

  template <class L>
  static bool all_inside(typename L::V nearest, typename L::V farthest, typename L::V length) {
    return L::bits(L::both(L::greater(nearest, L::zero()), L::greater(length, farthest))) == L::kAll;
  }

  void find_mixed(Batch& batch, unsigned i) {
    batch.set_apart(i);
    far_.find_mixed(batch, i);
  }

  const VectorJob& job_;
  PlanarFar<kLong> far_;
  std::uint64_t work_ = 0;
};

template <bool kLong>
constexpr typename PlanarSearch<kLong>::ClassOfLength PlanarSearch<kLong>::kClassOf = PlanarSearch<kLong>::class_of_length();

} // namespace
} // namespace scansion
