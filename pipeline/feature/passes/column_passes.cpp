// The loops over columns, twice.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/passes/column_passes.hpp"

#include "pipeline/feature/passes/lanes.hpp"
#include "pipeline/model/avx2.hpp"

#include <algorithm>
#include <cmath>

namespace scansion::passes {

namespace {

SCANSION_INLINE Shifts stand_body(const double* s, const double* w, const EvenRow& row, float* shift, float* height,
                                  std::size_t n) noexcept {
  const double per_mm = row.per_mm, base = row.base, origin = s[0] * per_mm;
  constexpr std::size_t kAtOnce = 4;
  Four number{0.0, 1.0, 2.0, 3.0};
  FourFloats least{}, largest{}; // that of the first sample is 0
  std::size_t k = 0;
#pragma GCC unroll 4
  for (; k + kAtOnce <= n; k += kAtOnce, number += static_cast<double>(kAtOnce)) {
    Four place, upwards;
    get(s + k, place);
    get(w + k, upwards);
    const FourFloats off = __builtin_convertvector(place * per_mm - origin - number, FourFloats);
    const FourFloats up = __builtin_convertvector(upwards - base, FourFloats);
    std::memcpy(shift + k, &off, sizeof off);
    std::memcpy(height + k, &up, sizeof up);
    least = off < least ? off : least;
    largest = off > largest ? off : largest;
  }
  Shifts shifts;
  for (std::size_t l = 0; l < kAtOnce; ++l) {
    shifts.least = std::min(shifts.least, least[l]);
    shifts.largest = std::max(shifts.largest, largest[l]);
  }
  for (; k < n; ++k) {
    shift[k] = static_cast<float>(s[k] * per_mm - origin - static_cast<double>(k));
    height[k] = static_cast<float>(w[k] - base);
    shifts.least = std::min(shifts.least, shift[k]);
    shifts.largest = std::max(shifts.largest, shift[k]);
  }
  return shifts;
}

SCANSION_INLINE std::size_t sample_columns_body(const ColumnRun& run, std::uint32_t first, std::size_t count, float* height,
                                                std::uint32_t* nearest) noexcept {
  constexpr float kMidway = 0.5F; // what stands there belongs to the second sample
  constexpr EightBits kSize = EightBits{} + 0x7fffffff;
  const Eight ahead = Eight{} + run.ahead, slack = Eight{} - run.slack, widest = Eight{} + run.widest,
              jump = Eight{} + run.jump;
  EightBits number = EightBits{0, 1, 2, 3, 4, 5, 6, 7} + static_cast<std::int32_t>(first);
  for (std::size_t done = 0; done < count; ++done) {
    EightBits outside{};
    for (std::size_t i = 0; i < ColumnRun::kBlock; i += kLanes) {
      const std::size_t at = done * ColumnRun::kBlock + i;
      Eight off, next_off, w, next_w;
      get(run.shift + at, off);
      get(run.shift + at + 1, next_off);
      get(run.height + at, w);
      get(run.height + at + 1, next_w);
      const Eight before = ahead - off, step = next_off - off + 1.0F, after = step - before, rise = next_w - w;
      const Eight share = before / step, up = w + rise * share;
      std::memcpy(height + at, &up, sizeof up);
      const EightBits near = number - (share >= kMidway);
      std::memcpy(nearest + at, &near, sizeof near);
      number += static_cast<std::int32_t>(kLanes);
      const Eight size = reinterpret_cast<Eight>(reinterpret_cast<EightBits>(rise) & kSize);
      outside |= ((before < after ? before : after) < slack) | (step > widest) | (size > jump);
    }
    std::array<std::uint64_t, sizeof outside / sizeof(std::uint64_t)> any;
    std::memcpy(any.data(), &outside, sizeof outside);
    if ((any[0] | any[1] | any[2] | any[3]) != 0) return done;
  }
  return count;
}

SCANSION_INLINE void add_weighed(const float* row, float weight, Eight& sum) noexcept {
  Eight values;
  get(row, values);
  sum += weight * values;
}

SCANSION_INLINE void raise(const Eight& values, Eight& peaks) noexcept {
  constexpr EightBits kSize = EightBits{} + 0x7fffffff;
  const Eight size = reinterpret_cast<Eight>(reinterpret_cast<EightBits>(values) & kSize);
  peaks = size > peaks ? size : peaks;
}

/// So many blocks of columns from `from` on: rows and weights are looked up once for them.
template <std::size_t Blocks>
SCANSION_INLINE void weigh_blocks(const float* const* rows, const float* weights, std::size_t count, std::size_t from,
                                  float* to, float* peaks) noexcept {
  constexpr std::size_t kOfBlock = kPeakBlock / kLanes;
  static_assert(kPeakLanes == kLanes);
  Eight sums[Blocks * kOfBlock] = {};
  for (std::size_t k = 0; k < count; ++k) {
    const float* const row = rows[k] + from;
#pragma GCC unroll 8
    for (std::size_t i = 0; i < Blocks * kOfBlock; ++i) add_weighed(row + i * kLanes, weights[k], sums[i]);
  }
#pragma GCC unroll 2
  for (std::size_t block = 0; block < Blocks; ++block) {
    Eight most{};
#pragma GCC unroll 4
    for (std::size_t i = block * kOfBlock; i < (block + 1) * kOfBlock; ++i) {
      std::memcpy(to + from + i * kLanes, &sums[i], sizeof sums[i]);
      raise(sums[i], most);
    }
    std::memcpy(peaks + block * kPeakLanes, &most, sizeof most);
  }
}

SCANSION_INLINE void weigh_body(const float* const* rows, const float* weights, std::size_t count, float* to, float* peaks,
                                std::size_t n) noexcept {
  std::size_t i = 0;
  for (; i + 2 * kPeakBlock <= n; i += 2 * kPeakBlock, peaks += 2 * kPeakLanes)
    weigh_blocks<2>(rows, weights, count, i, to, peaks);
  for (; i + kPeakBlock <= n; i += kPeakBlock, peaks += kPeakLanes) weigh_blocks<1>(rows, weights, count, i, to, peaks);
  if (i > 0 && i < n) { // what is left, with some once more
    std::array<float, kPeakLanes> unused;
    weigh_blocks<1>(rows, weights, count, n - kPeakBlock, to, unused.data());
    return;
  }
  for (; i < n; ++i) {
    float sum = 0.0F;
    for (std::size_t k = 0; k < count; ++k) sum += weights[k] * rows[k][i];
    to[i] = sum;
  }
}

SCANSION_INLINE std::size_t most_bent_body(const BendRows& rows, float least, std::uint32_t* indexes, std::size_t from,
                                           std::size_t n) noexcept {
  std::size_t found = 0;
  for (std::size_t k = from; k < n; ++k) {
    const float own = std::abs(rows.own[k]), sign = rows.own[k] < 0.0F ? -1.0F : 1.0F;
    bool most = own >= least;
    for (const float* const row : rows.before) most = most && !(sign * row[k] >= own);
    for (const float* const row : rows.after) most = most && !(sign * row[k] > own);
    indexes[found] = static_cast<std::uint32_t>(k);
    found += static_cast<std::size_t>(most);
  }
  return found;
}

// Most steps are weak, whole blocks of them.
SCANSION_INLINE bool all_weak(const float* __restrict b, const float* __restrict c, float weak, std::size_t n) noexcept {
  std::int32_t strong = 0;
  for (std::size_t k = 0; k < n; ++k) strong |= static_cast<std::int32_t>(!(std::abs(c[k] - b[k]) <= weak));
  return strong == 0;
}

SCANSION_INLINE bool mark_walls_body(const std::array<const float*, 4>& rows, const WallLimits& limits, std::uint32_t mark,
                                     std::uint32_t* __restrict marks, std::size_t n) noexcept {
  constexpr std::size_t kTogether = 64;
  std::int32_t all_none = 1;
  const float weak = limits.weak, steep = limits.steep, lonely = limits.lonely;
  for (std::size_t from = 0; from < n; from += kTogether) {
    const float* __restrict a = rows[0] + from;
    const float* __restrict b = rows[1] + from;
    const float* __restrict c = rows[2] + from;
    const float* __restrict d = rows[3] + from;
    std::uint32_t* const __restrict own = marks + from;
    const std::size_t count = std::min(kTogether, n - from);
    if (count == kTogether && all_weak(b, c, weak, kTogether)) continue;
    for (std::size_t k = 0; k < count; ++k) {
      const float step = std::abs(c[k] - b[k]), least = lonely * step;
      const int goes_on = static_cast<int>(std::abs(b[k] - a[k]) >= least) | static_cast<int>(std::abs(d[k] - c[k]) >= least);
      const int none = static_cast<int>(step <= weak) | (static_cast<int>(step <= steep) & goes_on);
      own[k] = none != 0 ? own[k] : mark;
      all_none &= none;
    }
  }
  return all_none == 0;
}

#if defined(__x86_64__)

// Few columns bend at all: the other rows are looked at where one of eight does, and these where one of their block does.
SCANSION_AVX2 std::size_t most_bent_avx2(const BendRows& rows, float least, std::uint32_t* indexes, std::size_t n) noexcept {
  const Eight limit = Eight{} + least;
  std::size_t found = 0, from = 0;
  for (; from + kLanes <= n; from += kLanes) {
    while (from % kPeakBlock == 0 && from + kPeakBlock <= n &&
           bits_of(reinterpret_cast<Eight>(load<Eight>(rows.peaks + from / kPeakBlock * kPeakLanes) >= limit)) == 0)
      from += kPeakBlock;
    if (from + kLanes > n) break;
    const Eight bend = load<Eight>(rows.own + from), own = size_of(bend);
    EightBits most = own >= limit;
    if (bits_of(reinterpret_cast<Eight>(most)) == 0) continue;
    const EightBits sign = reinterpret_cast<EightBits>(bend) & reinterpret_cast<EightBits>(-Eight{});
    const auto same_way = [&](const float* row) SCANSION_AVX2 {
      return reinterpret_cast<Eight>(reinterpret_cast<EightBits>(load<Eight>(row + from)) ^ sign);
    };
    for (const float* const row : rows.before) most &= ~(same_way(row) >= own);
    for (const float* const row : rows.after) most &= ~(same_way(row) > own);
    found += put(bits_of(reinterpret_cast<Eight>(most)), from, indexes + found);
  }
  return found + most_bent_body(rows, least, indexes + found, from, n);
}
SCANSION_AVX2 Shifts stand_avx2(const double* s, const double* w, const EvenRow& row, float* shift, float* height,
                                std::size_t n) noexcept {
  return stand_body(s, w, row, shift, height, n);
}
SCANSION_AVX2 std::size_t sample_columns_avx2(const ColumnRun& run, std::uint32_t first, std::size_t count, float* height,
                                              std::uint32_t* nearest) noexcept {
  return sample_columns_body(run, first, count, height, nearest);
}
SCANSION_AVX2 void weigh_avx2(const float* const* rows, const float* weights, std::size_t count, float* to, float* peaks,
                              std::size_t n) noexcept {
  weigh_body(rows, weights, count, to, peaks, n);
}
SCANSION_AVX2 bool mark_walls_avx2(const std::array<const float*, 4>& rows, const WallLimits& limits, std::uint32_t mark,
                                   std::uint32_t* marks, std::size_t n) noexcept {
  return mark_walls_body(rows, limits, mark, marks, n);
}

#else

std::size_t most_bent_avx2(const BendRows& rows, float least, std::uint32_t* indexes, std::size_t n) noexcept {
  return most_bent_body(rows, least, indexes, 0, n);
}
constexpr auto stand_avx2 = stand_body;
constexpr auto sample_columns_avx2 = sample_columns_body;
constexpr auto weigh_avx2 = weigh_body;
constexpr auto mark_walls_avx2 = mark_walls_body;

#endif

} // namespace

bool mark_walls(const std::array<const float*, 4>& rows, const WallLimits& limits, std::uint32_t mark, std::uint32_t* marks,
                std::size_t n) noexcept {
  return has_avx2() ? mark_walls_avx2(rows, limits, mark, marks, n) : mark_walls_body(rows, limits, mark, marks, n);
}

Shifts stand(const double* places, const double* heights, const EvenRow& row, float* shift, float* height,
             std::size_t n) noexcept {
  return has_avx2() ? stand_avx2(places, heights, row, shift, height, n) : stand_body(places, heights, row, shift, height, n);
}

std::size_t sample_columns(const ColumnRun& run, std::uint32_t first, std::size_t count, float* height,
                           std::uint32_t* nearest) noexcept {
  return has_avx2() ? sample_columns_avx2(run, first, count, height, nearest)
                    : sample_columns_body(run, first, count, height, nearest);
}

void weigh(const float* const* rows, const float* weights, std::size_t count, float* to, float* peaks, std::size_t n) noexcept {
  has_avx2() ? weigh_avx2(rows, weights, count, to, peaks, n) : weigh_body(rows, weights, count, to, peaks, n);
}

std::size_t most_bent(const BendRows& rows, float least, std::uint32_t* indexes, std::size_t n) noexcept {
  return has_avx2() ? most_bent_avx2(rows, least, indexes, n) : portable::most_bent(rows, least, indexes, n);
}

std::size_t portable::most_bent(const BendRows& rows, float least, std::uint32_t* indexes, std::size_t n) noexcept {
  return most_bent_body(rows, least, indexes, 0, n);
}

} // namespace scansion::passes
