// Inner loops of the fit.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/fit_kernels.hpp"

#include "pipeline/model/avx2.hpp"

#include <array>
#include <cstring>

namespace scansion::kernels {
namespace {

using Four = double __attribute__((vector_size(32)));
using Row = std::array<Four, 4>;

inline __attribute__((always_inline)) Row row_of(const std::int32_t* numbers) noexcept {
  using FourWhole = std::int32_t __attribute__((vector_size(16)));
  Row row;
  for (std::size_t j = 0; j < row.size(); ++j) {
    FourWhole whole;
    std::memcpy(&whole, numbers + 4 * j, sizeof whole);
    row[j] = __builtin_convertvector(whole, Four);
  }
  return row;
}

// Four at a time by hand: left alone, GCC 12 unrolls this loop into single numbers. Several rows together save most loads and
// stores of the sums; the order of additions stays.
template <std::size_t kRows>
inline __attribute__((always_inline)) void add_rows(const std::int32_t* rows, std::size_t stride, const double* factors,
                                                    double* normal, std::size_t count) noexcept {
  std::array<Row, kRows> row;
  for (std::size_t r = 0; r < kRows; ++r) row[r] = row_of(rows + 16 * stride * r);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<double, kRows> x;
    for (std::size_t r = 0; r < kRows; ++r) x[r] = rows[16 * stride * r + i] * factors[r];
    for (std::size_t j = 0; j < std::tuple_size_v<Row>; ++j) {
      if (j > i / 4 && j + 1 < std::tuple_size_v<Row>) continue; // symmetric: what the lower half says
      double* at = normal + 16 * i + 4 * j;
      Four sum;
      std::memcpy(&sum, at, sizeof sum);
      for (std::size_t r = 0; r < kRows; ++r) sum += row[r][j] * x[r];
      std::memcpy(at, &sum, sizeof sum);
    }
  }
}
inline __attribute__((always_inline)) void add_products_body(const std::int32_t* rows, std::size_t stride,
                                                             const double* factors, std::size_t n, double* normal,
                                                             std::size_t count) noexcept {
  constexpr std::size_t kTogether = 3; // as many as registers hold
  std::size_t r = 0;
  for (; r + kTogether <= n; r += kTogether) add_rows<kTogether>(rows + 16 * stride * r, stride, factors + r, normal, count);
  for (; r < n; ++r) add_rows<1>(rows + 16 * stride * r, stride, factors + r, normal, count);
}

// Sums of whole numbers: exact in any order.
inline __attribute__((always_inline)) void row_amounts_body(const std::int32_t* rows, double* amounts, std::size_t n) noexcept {
  constexpr Four kNotMeans{1, 1, 0, 0};
  for (std::size_t r = 0; r < n; ++r) {
    Row x = row_of(rows + 16 * r);
    for (Four& four : x) four = four < 0 ? -four : four;
    const Four sums = (x[0] + x[1] * kNotMeans) + (x[2] + x[3]);
    amounts[r] = (sums[0] + sums[1]) + (sums[2] + sums[3]);
  }
}

// All sums are whole numbers below 2^53, so they come out exact in any order.
inline __attribute__((always_inline)) void left_over_body(const std::int32_t* rows, const double* weights, std::int32_t* left,
                                                          std::size_t n) noexcept {
  constexpr std::size_t kTarget = 14;
  Row w;
  std::memcpy(w.data(), weights, sizeof w);
  for (std::size_t r = 0; r < n; ++r, rows += 16) {
    const Row x = row_of(rows);
    const Four sums = (x[0] * w[0] + x[1] * w[1]) + (x[2] * w[2] + x[3] * w[3]);
    const auto guess = (static_cast<std::int64_t>((sums[0] + sums[1]) + (sums[2] + sums[3])) + 2048) >> 12;
    left[r] = static_cast<std::int32_t>(static_cast<std::uint32_t>(rows[kTarget]) - static_cast<std::uint32_t>(guess));
  }
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void add_products_avx2(const std::int32_t* rows, std::size_t stride, const double* factors,
                                                       std::size_t n, double* normal, std::size_t count) noexcept {
  add_products_body(rows, stride, factors, n, normal, count);
}
__attribute__((target("avx2"))) void row_amounts_avx2(const std::int32_t* rows, double* amounts, std::size_t n) noexcept {
  row_amounts_body(rows, amounts, n);
}
__attribute__((target("avx2"))) void left_over_avx2(const std::int32_t* rows, const double* weights, std::int32_t* left,
                                                    std::size_t n) noexcept {
  left_over_body(rows, weights, left, n);
}
#else
constexpr auto add_products_avx2 = add_products_body;
constexpr auto row_amounts_avx2 = row_amounts_body;
constexpr auto left_over_avx2 = left_over_body;
#endif

} // namespace

void add_products(const std::int32_t* rows, std::size_t stride, const double* factors, std::size_t n, double* normal,
                  std::size_t count) noexcept {
  if (has_avx2())
    add_products_avx2(rows, stride, factors, n, normal, count);
  else
    add_products_body(rows, stride, factors, n, normal, count);
}

void row_amounts(const std::int32_t* rows, double* amounts, std::size_t n) noexcept {
  has_avx2() ? row_amounts_avx2(rows, amounts, n) : row_amounts_body(rows, amounts, n);
}

void left_over(const std::int32_t* rows, const double* weights, std::int32_t* left, std::size_t n) noexcept {
  if (has_avx2())
    left_over_avx2(rows, weights, left, n);
  else
    left_over_body(rows, weights, left, n);
}

} // namespace scansion::kernels
