// The loops, twice.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/passes.hpp"

#include "pipeline/model/avx2.hpp"

#include <bit>
#include <cmath>
#include <cstring>

namespace scansion::passes {

namespace {

#define SCANSION_INLINE inline __attribute__((always_inline))

SCANSION_INLINE void project_body(const std::array<const std::int32_t*, 3>& xyz, const Projection& projection,
                                  double* __restrict s, double* __restrict w, std::size_t n) noexcept {
  const std::int32_t* __restrict x = xyz[0];
  const std::int32_t* __restrict y = xyz[1];
  const std::int32_t* __restrict z = xyz[2];
  const double unit = projection.resolution, ex = projection.along[0], ey = projection.along[1];
  const double mx = projection.up[0], my = projection.up[1], mz = projection.up[2];
  for (std::size_t k = 0; k < n; ++k) {
    const double x_mm = x[k] * unit, y_mm = y[k] * unit;
    s[k] = x_mm * ex + y_mm * ey;
    w[k] = x_mm * mx + y_mm * my + z[k] * unit * mz;
  }
}

SCANSION_INLINE std::int64_t sum_body(const std::int32_t* values, std::size_t n) noexcept {
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < n; ++k) sum += values[k];
  return sum;
}

SCANSION_INLINE std::size_t count_back_body(const double* values, std::size_t n) noexcept {
  std::size_t back = 0;
  for (std::size_t k = 1; k < n; ++k) back += static_cast<std::size_t>(values[k] <= values[k - 1]);
  return back;
}

template <typename T>
SCANSION_INLINE std::size_t apart_body(const T* a, const T* b, T limit, std::uint32_t* indexes, std::size_t from,
                                       std::size_t n) noexcept {
  std::size_t found = 0;
  for (std::size_t k = from; k < n; ++k) {
    indexes[found] = static_cast<std::uint32_t>(k);
    found += static_cast<std::size_t>(std::abs(a[k] - b[k]) > limit);
  }
  return found;
}

SCANSION_INLINE std::size_t bent_or_stepped_body(const float* bend, const float* height, const float* next,
                                                 const ColumnLimits& limits, std::uint32_t* indexes, std::size_t from,
                                                 std::size_t n) noexcept {
  std::size_t found = 0;
  for (std::size_t k = from; k < n; ++k) {
    indexes[found] = static_cast<std::uint32_t>(k);
    const bool bent = std::abs(bend[k]) >= limits.least, stepped = std::abs(next[k] - height[k]) > limits.rise;
    found += static_cast<std::size_t>(bent | stepped);
  }
  return found;
}

SCANSION_INLINE void mark_walls_body(const std::array<const float*, 4>& rows, const WallLimits& limits, std::uint32_t mark,
                                     std::uint32_t* __restrict marks, std::size_t n) noexcept {
  const float* __restrict a = rows[0];
  const float* __restrict b = rows[1];
  const float* __restrict c = rows[2];
  const float* __restrict d = rows[3];
  const float weak = limits.weak, steep = limits.steep, lonely = limits.lonely;
  for (std::size_t k = 0; k < n; ++k) {
    const float step = std::abs(c[k] - b[k]), least = lonely * step;
    const int goes_on = static_cast<int>(std::abs(b[k] - a[k]) >= least) | static_cast<int>(std::abs(d[k] - c[k]) >= least);
    const int none = static_cast<int>(step <= weak) | (static_cast<int>(step <= steep) & goes_on);
    marks[k] = none != 0 ? marks[k] : mark;
  }
}

SCANSION_INLINE std::size_t reaching_body(const double* values, double limit, std::uint32_t* indexes, std::size_t from,
                                          std::size_t n) noexcept {
  std::size_t found = 0;
  for (std::size_t k = from; k < n; ++k) {
    indexes[found] = static_cast<std::uint32_t>(k);
    found += static_cast<std::size_t>(values[k] >= limit);
  }
  return found;
}

SCANSION_INLINE Standing standing_body(const double* values, const Grid& grid, std::size_t n) noexcept {
  const double per_mm = grid.per_mm, origin = values[0] * per_mm;
  const float low = grid.low, high = grid.high, even = grid.even;
  std::uint32_t outside = 0, uneven = 0;
  const auto end = static_cast<std::int32_t>(n);
  for (std::int32_t k = 0; k < end; ++k) {
    const auto shift = static_cast<float>(values[k] * per_mm - origin - k);
    outside |= static_cast<std::uint32_t>(shift < low) | static_cast<std::uint32_t>(shift >= high);
    uneven |= static_cast<std::uint32_t>(std::abs(shift) > even);
  }
  return {outside == 0, uneven == 0};
}

SCANSION_INLINE bool sample_block(const double* s, const double* w, const std::uint32_t* number, const ColumnBlocks& blocks,
                                  double first, float* __restrict height, std::uint32_t* __restrict source) noexcept {
  constexpr double kMidway = 0.5; // what stands there belongs to the second sample
  const double pitch = blocks.pitch, base = blocks.base, widest = blocks.widest, jump = blocks.jump, slack = blocks.slack;
  std::int64_t outside = 0; // in its sign
  for (std::size_t i = 0; i < ColumnBlocks::kSize; ++i) {
    const double at = (first + static_cast<std::int32_t>(i)) * pitch, ds = s[i + 1] - s[i], dw = w[i + 1] - w[i];
    const double share = (at - s[i]) / ds;
    outside |= std::bit_cast<std::int64_t>(at + slack - s[i]) | std::bit_cast<std::int64_t>(s[i + 1] + slack - at) |
               std::bit_cast<std::int64_t>(widest - ds) | std::bit_cast<std::int64_t>(jump - std::abs(dw));
    height[i] = static_cast<float>(w[i] + dw * share - base);
    const auto behind = static_cast<std::int32_t>(share + kMidway);
    const std::uint32_t near = number[i], far = number[i + 1];
    source[i] = behind == 0 ? near : far;
  }
  return outside >= 0;
}

SCANSION_INLINE std::size_t sample_columns_body(const ColumnSamples& samples, const ColumnBlocks& blocks, std::size_t count,
                                                float* height, std::uint32_t* source) noexcept {
  const double* const s = samples.s;
  for (std::size_t done = 0; done < count; ++done) {
    const std::size_t k = done * ColumnBlocks::kSize;
    const double first = blocks.first + static_cast<double>(k), place = first * blocks.pitch;
    const bool in_step = k == 0 || (s[k] < place && s[k + 1] >= place);
    if (!in_step || !sample_block(s + k, samples.w + k, samples.number + k, blocks, first, height + k, source + k)) return done;
  }
  return count;
}

using Eight = float __attribute__((vector_size(32))); // where there are no such vectors, several narrower ones

SCANSION_INLINE void weigh_body(const float* const* rows, const float* weights, std::size_t count, float* to,
                                std::size_t n) noexcept {
  constexpr std::size_t kLanes = sizeof(Eight) / sizeof(float);
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes) {
    Eight sum{};
    for (std::size_t k = 0; k < count; ++k) {
      Eight row;
      std::memcpy(&row, rows[k] + i, sizeof row);
      sum += weights[k] * row;
    }
    std::memcpy(to + i, &sum, sizeof sum);
  }
  for (; i < n; ++i) {
    float sum = 0.0F;
    for (std::size_t k = 0; k < count; ++k) sum += weights[k] * rows[k][i];
    to[i] = sum;
  }
}

SCANSION_INLINE void lower_body(const double* __restrict from, double base, float* __restrict to, std::size_t n) noexcept {
  for (std::size_t k = 0; k < n; ++k) to[k] = static_cast<float>(from[k] - base);
}

#if defined(__x86_64__)

#define SCANSION_AVX2 __attribute__((target("avx2")))
constexpr std::size_t kBlock = 32; // comparisons whose bits are looked at together: few are set, and are taken one by one

using Four = double __attribute__((vector_size(32)));
using Bits = std::uint64_t __attribute__((vector_size(32)));

// (The header with the processor's own names is not included: behind it GCC 12 compiles with the options of the precompiled
// header.)
SCANSION_AVX2 inline std::uint32_t bits_of(Four x) noexcept {
  return static_cast<std::uint32_t>(__builtin_ia32_movmskpd256(x));
}
SCANSION_AVX2 inline std::uint32_t bits_of(Eight x) noexcept {
  return static_cast<std::uint32_t>(__builtin_ia32_movmskps256(x));
}
template <typename Vector>
SCANSION_AVX2 inline Vector size_of(Vector x) noexcept {
  const Vector sign = -Vector{};
  return reinterpret_cast<Vector>(reinterpret_cast<Bits>(x) & ~reinterpret_cast<Bits>(sign));
}
template <typename Vector, typename T>
SCANSION_AVX2 inline Vector load(const T* from) noexcept {
  Vector v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

SCANSION_AVX2 inline std::size_t put(std::uint32_t bits, std::size_t from, std::uint32_t* indexes) noexcept {
  std::size_t count = 0;
  for (; bits != 0; bits &= bits - 1)
    indexes[count++] = static_cast<std::uint32_t>(from + static_cast<std::size_t>(std::countr_zero(bits)));
  return count;
}

// The bits of those of a block that are apart.
template <typename Vector, std::size_t Block, typename T>
SCANSION_AVX2 inline std::uint32_t apart_bits(const T* a, const T* b, Vector limit) noexcept {
  constexpr std::size_t kLanes = sizeof(Vector) / sizeof(T);
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < Block; i += kLanes) {
    bits |= bits_of(reinterpret_cast<Vector>(size_of(load<Vector>(a + i) - load<Vector>(b + i)) > limit)) << i;
  }
  return bits;
}

template <typename Vector, typename T>
SCANSION_AVX2 inline std::size_t apart_avx2(const T* a, const T* b, T limit, std::uint32_t* indexes, std::size_t n) noexcept {
  const Vector limits = Vector{} + limit;
  std::size_t found = 0, from = 0;
  for (; from + kBlock <= n; from += kBlock)
    found += put(apart_bits<Vector, kBlock>(a + from, b + from, limits), from, indexes + found);
  return found + apart_body(a, b, limit, indexes + found, from, n);
}

SCANSION_AVX2 std::size_t bent_or_stepped_avx2(const float* bend, const float* height, const float* next,
                                               const ColumnLimits& limits, std::uint32_t* indexes, std::size_t n) noexcept {
  const Eight least = Eight{} + limits.least, rise = Eight{} + limits.rise;
  std::size_t found = 0, from = 0;
  for (; from + kBlock <= n; from += kBlock) {
    std::uint32_t bits = apart_bits<Eight, kBlock>(next + from, height + from, rise);
    for (std::size_t i = 0; i < kBlock; i += sizeof(Eight) / sizeof(float)) {
      const Eight own = load<Eight>(bend + from + i);
      bits |= bits_of(reinterpret_cast<Eight>((own >= least) | (own <= -least))) << i;
    }
    found += put(bits, from, indexes + found);
  }
  return found + bent_or_stepped_body(bend, height, next, limits, indexes + found, from, n);
}

SCANSION_AVX2 std::size_t reaching_avx2(const double* values, double limit, std::uint32_t* indexes, std::size_t n) noexcept {
  const Four least = Four{} + limit;
  std::size_t found = 0, from = 0;
  for (; from + kBlock <= n; from += kBlock) {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < kBlock; i += sizeof(Four) / sizeof(double))
      bits |= bits_of(reinterpret_cast<Four>(load<Four>(values + from + i) >= least)) << i;
    found += put(bits, from, indexes + found);
  }
  return found + reaching_body(values, limit, indexes + found, from, n);
}

SCANSION_AVX2 std::size_t apart_avx2(const double* a, const double* b, double limit, std::uint32_t* indexes,
                                     std::size_t n) noexcept {
  return apart_avx2<Four>(a, b, limit, indexes, n);
}
SCANSION_AVX2 std::size_t apart_avx2(const float* a, const float* b, float limit, std::uint32_t* indexes,
                                     std::size_t n) noexcept {
  return apart_avx2<Eight>(a, b, limit, indexes, n);
}
SCANSION_AVX2 void project_avx2(const std::array<const std::int32_t*, 3>& xyz, const Projection& projection, double* s,
                                double* w, std::size_t n) noexcept {
  project_body(xyz, projection, s, w, n);
}
SCANSION_AVX2 std::int64_t sum_avx2(const std::int32_t* values, std::size_t n) noexcept {
  return sum_body(values, n);
}
SCANSION_AVX2 std::size_t count_back_avx2(const double* values, std::size_t n) noexcept {
  return count_back_body(values, n);
}
SCANSION_AVX2 Standing standing_avx2(const double* values, const Grid& grid, std::size_t n) noexcept {
  return standing_body(values, grid, n);
}
SCANSION_AVX2 std::size_t sample_columns_avx2(const ColumnSamples& samples, const ColumnBlocks& blocks, std::size_t count,
                                              float* height, std::uint32_t* source) noexcept {
  return sample_columns_body(samples, blocks, count, height, source);
}
SCANSION_AVX2 void weigh_avx2(const float* const* rows, const float* weights, std::size_t count, float* to,
                              std::size_t n) noexcept {
  weigh_body(rows, weights, count, to, n);
}
SCANSION_AVX2 void mark_walls_avx2(const std::array<const float*, 4>& rows, const WallLimits& limits, std::uint32_t mark,
                                   std::uint32_t* marks, std::size_t n) noexcept {
  mark_walls_body(rows, limits, mark, marks, n);
}
SCANSION_AVX2 void lower_avx2(const double* from, double base, float* to, std::size_t n) noexcept {
  lower_body(from, base, to, n);
}

#undef SCANSION_AVX2
#else

template <typename T>
std::size_t apart_avx2(const T* a, const T* b, T limit, std::uint32_t* indexes, std::size_t n) noexcept {
  return apart_body(a, b, limit, indexes, 0, n);
}
std::size_t bent_or_stepped_avx2(const float* bend, const float* height, const float* next, const ColumnLimits& limits,
                                 std::uint32_t* indexes, std::size_t n) noexcept {
  return bent_or_stepped_body(bend, height, next, limits, indexes, 0, n);
}
std::size_t reaching_avx2(const double* values, double limit, std::uint32_t* indexes, std::size_t n) noexcept {
  return reaching_body(values, limit, indexes, 0, n);
}
constexpr auto project_avx2 = project_body;
constexpr auto sum_avx2 = sum_body;
constexpr auto count_back_avx2 = count_back_body;
constexpr auto standing_avx2 = standing_body;
constexpr auto sample_columns_avx2 = sample_columns_body;
constexpr auto weigh_avx2 = weigh_body;
constexpr auto mark_walls_avx2 = mark_walls_body;
constexpr auto lower_avx2 = lower_body;

#endif

} // namespace

void project(const std::array<const std::int32_t*, 3>& xyz, const Projection& projection, double* s, double* w,
             std::size_t n) noexcept {
  has_avx2() ? project_avx2(xyz, projection, s, w, n) : project_body(xyz, projection, s, w, n);
}

std::int64_t sum(const std::int32_t* values, std::size_t n) noexcept {
  return has_avx2() ? sum_avx2(values, n) : sum_body(values, n);
}

std::size_t count_back(const double* values, std::size_t n) noexcept {
  return has_avx2() ? count_back_avx2(values, n) : count_back_body(values, n);
}

std::size_t apart(const double* a, const double* b, double limit, std::uint32_t* indexes, std::size_t n) noexcept {
  return has_avx2() ? apart_avx2(a, b, limit, indexes, n) : portable::apart(a, b, limit, indexes, n);
}

std::size_t apart(const float* a, const float* b, float limit, std::uint32_t* indexes, std::size_t n) noexcept {
  return has_avx2() ? apart_avx2(a, b, limit, indexes, n) : portable::apart(a, b, limit, indexes, n);
}

std::size_t bent_or_stepped(const float* bend, const float* height, const float* next, const ColumnLimits& limits,
                            std::uint32_t* indexes, std::size_t n) noexcept {
  return has_avx2() ? bent_or_stepped_avx2(bend, height, next, limits, indexes, n)
                    : portable::bent_or_stepped(bend, height, next, limits, indexes, n);
}

void mark_walls(const std::array<const float*, 4>& rows, const WallLimits& limits, std::uint32_t mark, std::uint32_t* marks,
                std::size_t n) noexcept {
  has_avx2() ? mark_walls_avx2(rows, limits, mark, marks, n) : mark_walls_body(rows, limits, mark, marks, n);
}

std::size_t reaching(const double* values, double limit, std::uint32_t* indexes, std::size_t n) noexcept {
  return has_avx2() ? reaching_avx2(values, limit, indexes, n) : portable::reaching(values, limit, indexes, n);
}

Standing standing(const double* values, const Grid& grid, std::size_t n) noexcept {
  return has_avx2() ? standing_avx2(values, grid, n) : standing_body(values, grid, n);
}

std::size_t sample_columns(const ColumnSamples& samples, const ColumnBlocks& blocks, std::size_t count, float* height,
                           std::uint32_t* source) noexcept {
  return has_avx2() ? sample_columns_avx2(samples, blocks, count, height, source)
                    : sample_columns_body(samples, blocks, count, height, source);
}

void weigh(const float* const* rows, const float* weights, std::size_t count, float* to, std::size_t n) noexcept {
  has_avx2() ? weigh_avx2(rows, weights, count, to, n) : weigh_body(rows, weights, count, to, n);
}

void lower(const double* from, double base, float* to, std::size_t n) noexcept {
  has_avx2() ? lower_avx2(from, base, to, n) : lower_body(from, base, to, n);
}

std::size_t portable::apart(const double* a, const double* b, double limit, std::uint32_t* indexes, std::size_t n) noexcept {
  return apart_body(a, b, limit, indexes, 0, n);
}
std::size_t portable::apart(const float* a, const float* b, float limit, std::uint32_t* indexes, std::size_t n) noexcept {
  return apart_body(a, b, limit, indexes, 0, n);
}
std::size_t portable::bent_or_stepped(const float* bend, const float* height, const float* next, const ColumnLimits& limits,
                                      std::uint32_t* indexes, std::size_t n) noexcept {
  return bent_or_stepped_body(bend, height, next, limits, indexes, 0, n);
}
std::size_t portable::reaching(const double* values, double limit, std::uint32_t* indexes, std::size_t n) noexcept {
  return reaching_body(values, limit, indexes, 0, n);
}

} // namespace scansion::passes
