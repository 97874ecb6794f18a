// The loops, twice.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/passes.hpp"

#include "pipeline/model/avx2.hpp"

#include <algorithm>
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

// The same where one axis goes along and the other up.
SCANSION_INLINE void project_straight_body(const std::int32_t* __restrict x, const std::int32_t* __restrict z, double unit,
                                           double ex, double mz, double* __restrict s, double* __restrict w,
                                           std::size_t n) noexcept {
  for (std::size_t k = 0; k < n; ++k) {
    s[k] = x[k] * unit * ex;
    w[k] = z[k] * unit * mz;
  }
}

SCANSION_INLINE std::int64_t sum_body(const std::int32_t* values, std::size_t n) noexcept {
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < n; ++k) sum += values[k];
  return sum;
}

template <typename T, typename Count>
SCANSION_INLINE std::size_t count_back_body(const T* values, std::size_t n) noexcept {
  Count back = 0; // as wide as values are: fewer instructions
  for (std::size_t k = 1; k < n; ++k) back += static_cast<Count>(values[k] <= values[k - 1]);
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

// Most steps are weak, whole blocks of them.
SCANSION_INLINE bool all_weak(const float* __restrict b, const float* __restrict c, float weak, std::size_t n) noexcept {
  std::int32_t strong = 0;
  for (std::size_t k = 0; k < n; ++k) strong |= static_cast<std::int32_t>(!(std::abs(c[k] - b[k]) <= weak));
  return strong == 0;
}

SCANSION_INLINE void mark_walls_body(const std::array<const float*, 4>& rows, const WallLimits& limits, std::uint32_t mark,
                                     std::uint32_t* __restrict marks, std::size_t n) noexcept {
  constexpr std::size_t kTogether = 64;
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
    }
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

using Eight = float __attribute__((vector_size(32))); // where there are no such vectors, several narrower ones
using EightBits = std::int32_t __attribute__((vector_size(32)));
using Four = double __attribute__((vector_size(32)));
using FourFloats = float __attribute__((vector_size(16)));
constexpr std::size_t kLanes = sizeof(Eight) / sizeof(float);

// (Vectors are handed over by reference: by value they would need the processor that has them.)
template <typename Vector, typename T>
SCANSION_INLINE void get(const T* from, Vector& to) noexcept {
  std::memcpy(&to, from, sizeof to);
}

SCANSION_INLINE Shifts stand_body(const double* s, const double* w, const EvenRow& row, float* shift, float* height,
                                  std::size_t n) noexcept {
  const double per_mm = row.per_mm, base = row.base, origin = s[0] * per_mm;
  constexpr std::size_t kAtOnce = 4;
  Four number{0.0, 1.0, 2.0, 3.0};
  FourFloats least{}, largest{}; // that of the first sample is 0
  std::size_t k = 0;
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

SCANSION_INLINE void weigh_body(const float* const* rows, const float* weights, std::size_t count, float* to,
                                std::size_t n) noexcept {
  std::size_t i = 0;
  for (; i + 4 * kLanes <= n; i += 4 * kLanes) { // rows and weights are looked up once for so many
    Eight a{}, b{}, c{}, d{};
    for (std::size_t k = 0; k < count; ++k) {
      const float* const row = rows[k] + i;
      add_weighed(row, weights[k], a);
      add_weighed(row + kLanes, weights[k], b);
      add_weighed(row + 2 * kLanes, weights[k], c);
      add_weighed(row + 3 * kLanes, weights[k], d);
    }
    std::memcpy(to + i, &a, sizeof a);
    std::memcpy(to + i + kLanes, &b, sizeof b);
    std::memcpy(to + i + 2 * kLanes, &c, sizeof c);
    std::memcpy(to + i + 3 * kLanes, &d, sizeof d);
  }
  for (; i < n; ++i) {
    float sum = 0.0F;
    for (std::size_t k = 0; k < count; ++k) sum += weights[k] * rows[k][i];
    to[i] = sum;
  }
}

#if defined(__x86_64__)

#define SCANSION_AVX2 __attribute__((target("avx2")))
constexpr std::size_t kBlock = 32; // comparisons whose bits are looked at together: few are set, and are taken one by one

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
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < Block; i += sizeof(Vector) / sizeof(T)) {
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
SCANSION_AVX2 void project_straight_avx2(const std::int32_t* x, const std::int32_t* z, double unit, double ex, double mz,
                                         double* s, double* w, std::size_t n) noexcept {
  project_straight_body(x, z, unit, ex, mz, s, w, n);
}
SCANSION_AVX2 std::size_t count_back_avx2(const double* values, std::size_t n) noexcept {
  return count_back_body<double, std::uint64_t>(values, n);
}
SCANSION_AVX2 std::size_t count_back_avx2(const std::int32_t* values, std::size_t n) noexcept {
  return count_back_body<std::int32_t, std::uint32_t>(values, n);
}
SCANSION_AVX2 Shifts stand_avx2(const double* s, const double* w, const EvenRow& row, float* shift, float* height,
                                std::size_t n) noexcept {
  return stand_body(s, w, row, shift, height, n);
}
SCANSION_AVX2 std::size_t sample_columns_avx2(const ColumnRun& run, std::uint32_t first, std::size_t count, float* height,
                                              std::uint32_t* nearest) noexcept {
  return sample_columns_body(run, first, count, height, nearest);
}
SCANSION_AVX2 void weigh_avx2(const float* const* rows, const float* weights, std::size_t count, float* to,
                              std::size_t n) noexcept {
  weigh_body(rows, weights, count, to, n);
}
SCANSION_AVX2 void mark_walls_avx2(const std::array<const float*, 4>& rows, const WallLimits& limits, std::uint32_t mark,
                                   std::uint32_t* marks, std::size_t n) noexcept {
  mark_walls_body(rows, limits, mark, marks, n);
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
constexpr auto project_straight_avx2 = project_straight_body;
std::size_t count_back_avx2(const double* values, std::size_t n) noexcept {
  return count_back_body<double, std::uint64_t>(values, n);
}
std::size_t count_back_avx2(const std::int32_t* values, std::size_t n) noexcept {
  return count_back_body<std::int32_t, std::uint32_t>(values, n);
}
constexpr auto stand_avx2 = stand_body;
constexpr auto sample_columns_avx2 = sample_columns_body;
constexpr auto weigh_avx2 = weigh_body;
constexpr auto mark_walls_avx2 = mark_walls_body;

#endif

} // namespace

void project(const std::array<const std::int32_t*, 3>& xyz, const Projection& projection, double* s, double* w,
             std::size_t n) noexcept {
  const auto& [unit, along, up] = projection;
  const std::size_t axis = along[1] == 0.0 ? 0 : 1;
  if (along[1 - axis] == 0.0 && up[0] == 0.0 && up[1] == 0.0)
    return has_avx2() ? project_straight_avx2(xyz[axis], xyz[2], unit, along[axis], up[2], s, w, n)
                      : project_straight_body(xyz[axis], xyz[2], unit, along[axis], up[2], s, w, n);
  has_avx2() ? project_avx2(xyz, projection, s, w, n) : project_body(xyz, projection, s, w, n);
}

std::int64_t sum(const std::int32_t* values, std::size_t n) noexcept {
  return has_avx2() ? sum_avx2(values, n) : sum_body(values, n);
}

std::size_t count_back(const double* values, std::size_t n) noexcept {
  return has_avx2() ? count_back_avx2(values, n) : count_back_body<double, std::uint64_t>(values, n);
}
std::size_t count_back(const std::int32_t* values, std::size_t n) noexcept {
  return has_avx2() ? count_back_avx2(values, n) : count_back_body<std::int32_t, std::uint32_t>(values, n);
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

Shifts stand(const double* places, const double* heights, const EvenRow& row, float* shift, float* height,
             std::size_t n) noexcept {
  return has_avx2() ? stand_avx2(places, heights, row, shift, height, n) : stand_body(places, heights, row, shift, height, n);
}

std::size_t sample_columns(const ColumnRun& run, std::uint32_t first, std::size_t count, float* height,
                           std::uint32_t* nearest) noexcept {
  return has_avx2() ? sample_columns_avx2(run, first, count, height, nearest)
                    : sample_columns_body(run, first, count, height, nearest);
}

void weigh(const float* const* rows, const float* weights, std::size_t count, float* to, std::size_t n) noexcept {
  has_avx2() ? weigh_avx2(rows, weights, count, to, n) : weigh_body(rows, weights, count, to, n);
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
