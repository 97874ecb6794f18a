// The inner loops of the fit, for vector units. A row is 16 numbers: deviations, target, nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace scansion::kernels {

/// normal[i][j] += x[i] * factor * x[j] for i < count: for j up to i and from 12 on, at least; for n rows, `stride` apart, each
/// with its own factor, one after the other. Multiplies and adds apart, so every machine rounds alike.
void add_products(const std::int32_t* rows, std::size_t stride, const double* factors, std::size_t n, double* normal,
                  std::size_t count) noexcept;
/// amounts[r] = the sum of the amounts of all numbers of row r but the seventh and the eighth.
void row_amounts(const std::int32_t* rows, double* amounts, std::size_t n) noexcept;
/// left[r] = target - ((the sum of 14 weights times what they weigh + 2048) >> 12), modulo 2^32. `weights` are 16, whole
/// numbers of 16 bits, the last two 0.
void left_over(const std::int32_t* rows, const double* weights, std::int32_t* left, std::size_t n) noexcept;

} // namespace scansion::kernels
