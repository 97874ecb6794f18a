// The inner loops of the codec that vector units like: no branch, no dependence from point to point. Each is compiled for the
// baseline and, where it pays, again for AVX2; all are integer arithmetic, so the results are the same.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace scansion::kernels {

/// Writes the indexes of the values above `limit` to `indexes`, which has room for n, and returns how many they are; raises
/// `rest` to the largest of the others. No value is negative.
[[nodiscard]] std::size_t above(const double* values, double limit, std::uint32_t* indexes, std::size_t n,
                                double& rest) noexcept;

/// How many of the values are above `limit`.
[[nodiscard]] std::size_t count_above(const double* values, double limit, std::size_t n) noexcept;

/// Lowers `low` and raises `high` to the smallest and the largest of the values.
void bounds(const std::int32_t* values, std::size_t n, std::int32_t& low, std::int32_t& high) noexcept;

/// to[i] = base + step * u[i], modulo 2^32.
void from_steps(const std::int32_t* u, std::uint32_t base, std::uint32_t step, std::int32_t* to, std::size_t n) noexcept;
/// values[i] = min(values[i], most).
void cap(std::uint8_t* values, std::uint8_t most, std::size_t n) noexcept;
/// to[i] = first + step * i, modulo 2^32.
void ramp(std::uint32_t first, std::uint32_t step, std::int32_t* to, std::size_t n) noexcept;

/// How many of the first n points are nearer to above[i + 1] than to its neighbours on either side, or as near as to above[i]:
/// those of a line along another one with like steps. Reads `above` up to n + 1.
[[nodiscard]] std::size_t in_step(const std::int32_t* here, const std::int32_t* above, std::size_t n) noexcept;
/// Whether all values differ from the first one by multiples of `step`.
[[nodiscard]] bool share_step(const std::int32_t* values, std::uint32_t step, std::size_t n) noexcept;

/// Sets bit i of `bits`, the least significant first, for each of the n counts that is not 0.
void nonzero(const std::uint32_t* counts, std::size_t n, std::uint64_t* bits) noexcept;

/// to[i] = from + (step * (i + 1) >> 16), modulo 2^32.
void slope(std::int32_t from, std::int64_t step, std::int32_t* to, std::size_t n) noexcept;

/// The same to `chord`, and what the values have beyond that to `off`.
void off_slope(std::int32_t from, std::int64_t step, const std::int32_t* values, std::int32_t* chord, std::int32_t* off,
               std::size_t n) noexcept;

/// Points of one line that lie side by side; each pointer is at the first of them.
struct Above {
  const std::int32_t* deviation;
  const std::int32_t* value;
  const std::int32_t* size;
};
/// sum[i] = the weights (three for deviations, three for values) times what stands at i - 1, i and i + 1;
/// size[i] = 1, 2, 1 times the sizes there. Reads one point over either end of `above`.
void weigh_beside(const std::int16_t* weights, const Above& above, std::int64_t* sum, std::int32_t* size,
                  std::size_t n) noexcept;
/// Takes away from sum[i] the three weights times the chord at i - 1, i and i + 1, which is read one point over either end.
void weigh_chord(const std::int16_t* weights, const std::int32_t* chord, std::int64_t* sum, std::size_t n) noexcept;

/// What the points to the left of each point say; each pointer is at the first point.
struct Left {
  const std::int32_t* deviation; ///< read from six before
  const std::int32_t* fast;      ///< running means
  const std::int32_t* slow;
  std::int64_t rounding;
};
/// residual[i] = deviation[i] - ((sum[i] + weights times the six deviations to the left and the means + rounding) >> 12),
/// modulo 2^32. `sum` may be null: all 0.
void residuals(const std::int16_t* weights, const Left& left, const std::int64_t* sum, std::int32_t* residual,
               std::size_t n) noexcept;

/// size[i] = min(|residual[i]|, limit).
void sizes(const std::int32_t* residual, std::uint32_t limit, std::int32_t* size, std::size_t n) noexcept;

/// token[i] = token_of(fold(values[i])) (tokens.hpp). Returns the largest.
[[nodiscard]] std::uint8_t tokens(const std::int32_t* values, std::uint8_t* token, std::size_t n) noexcept;

/// context[i] from size[i - 2], size[i - 3] and above[i]: rest_context(rest_doubt()). `above` may be null: no line before.
void contexts(const std::int32_t* size, const std::int32_t* above, std::uint8_t* context, std::size_t n) noexcept;

/// The baseline versions, for tests.
namespace portable {
void weigh_beside(const std::int16_t* weights, const Above& above, std::int64_t* sum, std::int32_t* size,
                  std::size_t n) noexcept;
void weigh_chord(const std::int16_t* weights, const std::int32_t* chord, std::int64_t* sum, std::size_t n) noexcept;
void residuals(const std::int16_t* weights, const Left& left, const std::int64_t* sum, std::int32_t* residual,
               std::size_t n) noexcept;
void contexts(const std::int32_t* size, const std::int32_t* above, std::uint8_t* context, std::size_t n) noexcept;
[[nodiscard]] std::uint8_t tokens(const std::int32_t* values, std::uint8_t* token, std::size_t n) noexcept;
} // namespace portable

} // namespace scansion::kernels
