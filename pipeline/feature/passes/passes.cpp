// The loops, twice.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/passes/passes.hpp"

#include "pipeline/feature/passes/lanes.hpp"
#include "pipeline/model/avx2.hpp"

#include <cmath>

namespace scansion::passes {

namespace {

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

// The same where one axis goes along and the other up, one to one: `along` and `up` in mm per count.
SCANSION_INLINE void project_straight_body(const std::int32_t* __restrict x, const std::int32_t* __restrict z, double along,
                                           double up, double* __restrict s, double* __restrict w, std::size_t n) noexcept {
#pragma GCC unroll 4
  for (std::size_t k = 0; k < n; ++k) {
    s[k] = x[k] * along;
    w[k] = z[k] * up;
  }
}

SCANSION_INLINE std::int64_t sum_body(const std::int32_t* values, std::size_t n) noexcept {
  std::int64_t sum = 0;
#pragma GCC unroll 4
  for (std::size_t k = 0; k < n; ++k) sum += values[k];
  return sum;
}

template <typename T, typename Count>
SCANSION_INLINE std::size_t count_back_body(const T* values, std::size_t n) noexcept {
  Count back = 0; // as wide as values are: fewer instructions
#pragma GCC unroll 4
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

SCANSION_INLINE std::size_t reaching_body(const double* values, double limit, std::uint32_t* indexes, std::size_t from,
                                          std::size_t n) noexcept {
  std::size_t found = 0;
  for (std::size_t k = from; k < n; ++k) {
    indexes[found] = static_cast<std::uint32_t>(k);
    found += static_cast<std::size_t>(values[k] >= limit);
  }
  return found;
}

#if defined(__x86_64__)

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
SCANSION_AVX2 void project_straight_avx2(const std::int32_t* x, const std::int32_t* z, double along, double up, double* s,
                                         double* w, std::size_t n) noexcept {
  project_straight_body(x, z, along, up, s, w, n);
}
SCANSION_AVX2 std::size_t count_back_avx2(const double* values, std::size_t n) noexcept {
  return count_back_body<double, std::uint64_t>(values, n);
}
SCANSION_AVX2 std::size_t count_back_avx2(const std::int32_t* values, std::size_t n) noexcept {
  return count_back_body<std::int32_t, std::uint32_t>(values, n);
}
#else

template <typename T>
std::size_t apart_avx2(const T* a, const T* b, T limit, std::uint32_t* indexes, std::size_t n) noexcept {
  return apart_body(a, b, limit, indexes, 0, n);
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

#endif

} // namespace

void project(const std::array<const std::int32_t*, 3>& xyz, const Projection& projection, double* s, double* w,
             std::size_t n) noexcept {
  const auto& [unit, along, up] = projection;
  const std::size_t axis = along[1] == 0.0 ? 0 : 1;
  if (std::abs(along[axis]) == 1.0 && std::abs(up[2]) == 1.0 && up[0] == 0.0 && up[1] == 0.0) {
    const double s_mm = unit * along[axis], w_mm = unit * up[2];
    return has_avx2() ? project_straight_avx2(xyz[axis], xyz[2], s_mm, w_mm, s, w, n)
                      : project_straight_body(xyz[axis], xyz[2], s_mm, w_mm, s, w, n);
  }
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

std::size_t reaching(const double* values, double limit, std::uint32_t* indexes, std::size_t n) noexcept {
  return has_avx2() ? reaching_avx2(values, limit, indexes, n) : portable::reaching(values, limit, indexes, n);
}

std::size_t portable::apart(const double* a, const double* b, double limit, std::uint32_t* indexes, std::size_t n) noexcept {
  return apart_body(a, b, limit, indexes, 0, n);
}
std::size_t portable::apart(const float* a, const float* b, float limit, std::uint32_t* indexes, std::size_t n) noexcept {
  return apart_body(a, b, limit, indexes, 0, n);
}
std::size_t portable::reaching(const double* values, double limit, std::uint32_t* indexes, std::size_t n) noexcept {
  return reaching_body(values, limit, indexes, 0, n);
}

} // namespace scansion::passes
