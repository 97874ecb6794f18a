// Inner loops for vector units.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/kernels.hpp"

#include "pipeline/codec/tokens.hpp"
#include "pipeline/model/avx2.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace scansion::kernels {
namespace {

#define SCANSION_INLINE inline __attribute__((always_inline))

SCANSION_INLINE std::int32_t minus(std::int32_t a, std::int32_t b) noexcept {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
}
SCANSION_INLINE std::int64_t times(std::int16_t a, std::int32_t b) noexcept {
  return std::int64_t{a} * b;
}

SCANSION_INLINE void weigh_beside_body(const std::int16_t* __restrict w, const Above& above, std::int64_t* __restrict sum,
                                       std::int32_t* __restrict size, std::size_t n) noexcept {
  const std::int32_t* __restrict d = above.deviation;
  const std::int32_t* __restrict v = above.value;
  const std::int32_t* __restrict s = above.size;
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t* di = d + i;
    const std::int32_t* vi = v + i;
    sum[i] = times(w[0], di[-1]) + times(w[1], di[0]) + times(w[2], di[1]) + times(w[3], vi[-1]) + times(w[4], vi[0]) +
             times(w[5], vi[1]);
    const std::int32_t* si = s + i;
    size[i] = si[-1] + 2 * si[0] + si[1];
  }
}

SCANSION_INLINE void weigh_chord_body(const std::int16_t* __restrict w, const std::int32_t* __restrict chord,
                                      std::int64_t* __restrict sum, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t* c = chord + i;
    sum[i] -= times(w[0], c[-1]) + times(w[1], c[0]) + times(w[2], c[1]);
  }
}

template <bool kSum>
SCANSION_INLINE void residuals_loop(const std::int16_t* __restrict w, const Left& left, const std::int64_t* __restrict sum,
                                    std::int32_t* __restrict residual, std::size_t n) noexcept {
  const std::int32_t* __restrict deviation = left.deviation;
  const std::int32_t* __restrict fast = left.fast;
  const std::int32_t* __restrict slow = left.slow;
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t* d = deviation + i;
    const std::int64_t s = (kSum ? sum[i] : 0) + left.rounding + times(w[0], d[-1]) + times(w[1], d[-2]) + times(w[2], d[-3]) +
                           times(w[3], d[-4]) + times(w[4], d[-5]) + times(w[5], d[-6]) + times(w[6], fast[i]) +
                           times(w[7], slow[i]);
    // The low 32 bits of the shifted sum: a logical shift gives the same, and vector units have it.
    const auto guess = static_cast<std::uint32_t>(static_cast<std::uint64_t>(s) >> 12U);
    residual[i] = static_cast<std::int32_t>(static_cast<std::uint32_t>(d[0]) - guess);
  }
}
SCANSION_INLINE void residuals_body(const std::int16_t* w, const Left& left, const std::int64_t* sum, std::int32_t* residual,
                                    std::size_t n) noexcept {
  sum != nullptr ? residuals_loop<true>(w, left, sum, residual, n) : residuals_loop<false>(w, left, sum, residual, n);
}

// bit_width for values below 2^24 without a bit scan: the exponent of the same value as a float.
template <bool kAbove>
SCANSION_INLINE void contexts_loop(const std::int32_t* __restrict size, const std::int32_t* __restrict above,
                                   std::uint8_t* __restrict context, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t near = size[static_cast<std::ptrdiff_t>(i) - 2];
    const std::int32_t far = size[static_cast<std::ptrdiff_t>(i) - 3];
    const std::int32_t left = 2 * std::max(near, far) + near + far;
    const std::int32_t sum = (kAbove ? left + above[i] : 2 * left) + 1;
    const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(sum));
    context[i] = static_cast<std::uint8_t>((bits >> 22U) - 254U);
  }
}
SCANSION_INLINE void contexts_body(const std::int32_t* size, const std::int32_t* above, std::uint8_t* context,
                                   std::size_t n) noexcept {
  above != nullptr ? contexts_loop<true>(size, above, context, n) : contexts_loop<false>(size, above, context, n);
}

using Four = double __attribute__((vector_size(32)));
SCANSION_INLINE void from_steps_body(const std::int32_t* __restrict u, std::uint32_t base, std::uint32_t step,
                                     std::int32_t* __restrict to, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i) to[i] = static_cast<std::int32_t>(base + step * static_cast<std::uint32_t>(u[i]));
}

SCANSION_INLINE void ramp_body(std::uint32_t first, std::uint32_t step, std::int32_t* to, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i) to[i] = static_cast<std::int32_t>(first + step * static_cast<std::uint32_t>(i));
}

SCANSION_INLINE void slope_body(std::int32_t from, std::int64_t step, std::int32_t* __restrict to, std::size_t n) noexcept {
  std::int64_t sum = std::int64_t{from} * 65536;
  for (std::size_t i = 0; i < n; ++i) {
    sum += step;
    to[i] = static_cast<std::int32_t>(static_cast<std::uint64_t>(sum) >> 16U);
  }
}

SCANSION_INLINE void off_slope_body(std::int32_t from, std::int64_t step, const std::int32_t* __restrict values,
                                    std::int32_t* __restrict chord, std::int32_t* __restrict off, std::size_t n) noexcept {
  std::int64_t sum = std::int64_t{from} * 65536;
  for (std::size_t i = 0; i < n; ++i) {
    sum += step;
    const auto on_chord = static_cast<std::int32_t>(static_cast<std::uint64_t>(sum) >> 16U);
    chord[i] = on_chord;
    off[i] = minus(values[i], on_chord);
  }
}

SCANSION_INLINE void sizes_body(const std::int32_t* __restrict residual, std::uint32_t limit, std::int32_t* __restrict size,
                                std::size_t n) noexcept {
  // The largest negative number is no larger than the limit either way round.
  const auto most = static_cast<std::int32_t>(limit);
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t held = std::max(residual[i], -most);
    size[i] = std::min(held < 0 ? -held : held, most);
  }
}

// Beyond the direct tokens the exponent and the first two bits behind the point of the same value as a float are the token.
// Half the value has a sign bit to spare; a bit cleared behind those that count keeps conversion from rounding up into them.
SCANSION_INLINE std::uint8_t tokens_body(const std::int32_t* __restrict values, std::uint8_t* __restrict token,
                                         std::size_t n) noexcept {
  constexpr std::uint32_t kLess = 4 * (127 + 4) - kDirectTokens; // half of kDirectTokens has the exponent 4
  std::uint32_t any = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t x = fold(values[i]);
    const std::uint32_t half = x >> 1U;
    const auto real = static_cast<float>(static_cast<std::int32_t>(half & ~(half >> 8U)));
    const std::uint32_t over = (std::bit_cast<std::uint32_t>(real) >> 21U) - kLess;
    const std::uint32_t direct = 0U - (x < kDirectTokens ? 1U : 0U);
    const std::uint32_t t = (x & direct) | (over & ~direct);
    token[i] = static_cast<std::uint8_t>(t);
    any = std::max(any, t);
  }
  return static_cast<std::uint8_t>(any);
}

SCANSION_INLINE void bounds_body(const std::int32_t* values, std::size_t n, std::int32_t& low, std::int32_t& high) noexcept {
  std::int32_t least = low;
  std::int32_t most = high;
  for (std::size_t i = 0; i < n; ++i) { // two values at a time, as std::minmax has it, is no work for vector units
    least = std::min(least, values[i]);
    most = std::max(most, values[i]);
  }
  low = least;
  high = most;
}

SCANSION_INLINE std::size_t count_above_body(const double* values, double limit, std::size_t n) noexcept {
  std::uint64_t found = 0; // as wide as the values: vector units count lane by lane
  for (std::size_t i = 0; i < n; ++i) found += values[i] > limit ? 1U : 0U;
  return found;
}

// Where the next one lies cannot be foreseen, so nothing here branches on it. Doubles that are not negative have the order of
// their bits.
std::size_t above_body(const double* values, double limit, std::uint32_t* indexes, std::size_t n, double& rest) noexcept {
  const auto limit_bits = std::bit_cast<std::uint64_t>(limit);
  auto most = std::bit_cast<std::uint64_t>(rest);
  std::size_t found = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto v = std::bit_cast<std::uint64_t>(values[i]);
    indexes[found] = static_cast<std::uint32_t>(i);
    found += v > limit_bits ? 1 : 0;
    most = std::max(most, v > limit_bits ? 0 : v);
  }
  rest = std::bit_cast<double>(most);
  return found;
}

#if defined(__x86_64__)
// 32 comparisons at a time; their bits are few and are taken one by one. (The header with the processor's own names is not
// included: behind it GCC 12 compiles with the options of the precompiled header.)
__attribute__((target("avx2"))) std::size_t above_avx2(const double* values, double limit, std::uint32_t* indexes,
                                                       std::size_t n, double& rest) noexcept {
  constexpr std::size_t kLanes = 4;
  constexpr std::size_t kBlock = 32;
  const Four limits = Four{} + limit;
  Four most = Four{} + rest;
  std::size_t found = 0;
  std::size_t from = 0;
  for (; from + kBlock <= n; from += kBlock) {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < kBlock; i += kLanes) {
      Four v;
      std::memcpy(&v, values + from + i, sizeof v);
      const auto larger = v > limits;
      bits |= static_cast<std::uint32_t>(__builtin_ia32_movmskpd256(reinterpret_cast<Four>(larger))) << i;
      const Four held = larger ? Four{} : v;
      most = held > most ? held : most;
    }
    for (; bits != 0; bits &= bits - 1)
      indexes[found++] = static_cast<std::uint32_t>(from + static_cast<std::size_t>(std::countr_zero(bits)));
  }
  for (std::size_t k = 0; k < kLanes; ++k) rest = std::max(rest, most[k]);
  const std::size_t tail = above_body(values + from, limit, indexes + found, n - from, rest);
  for (std::size_t k = found; k < found + tail; ++k) indexes[k] += static_cast<std::uint32_t>(from);
  return found + tail;
}
__attribute__((target("avx2"))) std::size_t count_above_avx2(const double* values, double limit, std::size_t n) noexcept {
  return count_above_body(values, limit, n);
}
__attribute__((target("avx2"))) void from_steps_avx2(const std::int32_t* u, std::uint32_t base, std::uint32_t step,
                                                     std::int32_t* to, std::size_t n) noexcept {
  from_steps_body(u, base, step, to, n);
}
__attribute__((target("avx2"))) void ramp_avx2(std::uint32_t first, std::uint32_t step, std::int32_t* to,
                                               std::size_t n) noexcept {
  ramp_body(first, step, to, n);
}
__attribute__((target("avx2"))) void slope_avx2(std::int32_t from, std::int64_t step, std::int32_t* to,
                                                std::size_t n) noexcept {
  slope_body(from, step, to, n);
}
__attribute__((target("avx2"))) void off_slope_avx2(std::int32_t from, std::int64_t step, const std::int32_t* values,
                                                    std::int32_t* chord, std::int32_t* off, std::size_t n) noexcept {
  off_slope_body(from, step, values, chord, off, n);
}
__attribute__((target("avx2"))) void sizes_avx2(const std::int32_t* residual, std::uint32_t limit, std::int32_t* size,
                                                std::size_t n) noexcept {
  sizes_body(residual, limit, size, n);
}
__attribute__((target("avx2"))) std::uint8_t tokens_avx2(const std::int32_t* values, std::uint8_t* token,
                                                         std::size_t n) noexcept {
  return tokens_body(values, token, n);
}
__attribute__((target("avx2"))) void bounds_avx2(const std::int32_t* values, std::size_t n, std::int32_t& low,
                                                 std::int32_t& high) noexcept {
  bounds_body(values, n, low, high);
}
__attribute__((target("avx2"))) void weigh_beside_avx2(const std::int16_t* w, const Above& above, std::int64_t* sum,
                                                       std::int32_t* size, std::size_t n) noexcept {
  weigh_beside_body(w, above, sum, size, n);
}
__attribute__((target("avx2"))) void weigh_chord_avx2(const std::int16_t* w, const std::int32_t* chord, std::int64_t* sum,
                                                      std::size_t n) noexcept {
  weigh_chord_body(w, chord, sum, n);
}
__attribute__((target("avx2"))) void residuals_avx2(const std::int16_t* w, const Left& left, const std::int64_t* sum,
                                                    std::int32_t* residual, std::size_t n) noexcept {
  residuals_body(w, left, sum, residual, n);
}
__attribute__((target("avx2"))) void contexts_avx2(const std::int32_t* size, const std::int32_t* above, std::uint8_t* context,
                                                   std::size_t n) noexcept {
  contexts_body(size, above, context, n);
}
#else
constexpr auto above_avx2 = above_body;
constexpr auto count_above_avx2 = count_above_body;
constexpr auto from_steps_avx2 = from_steps_body;
constexpr auto ramp_avx2 = ramp_body;
constexpr auto slope_avx2 = slope_body;
constexpr auto off_slope_avx2 = off_slope_body;
constexpr auto sizes_avx2 = sizes_body;
constexpr auto tokens_avx2 = tokens_body;
constexpr auto bounds_avx2 = bounds_body;
constexpr auto weigh_beside_avx2 = weigh_beside_body;
constexpr auto weigh_chord_avx2 = weigh_chord_body;
constexpr auto residuals_avx2 = residuals_body;
constexpr auto contexts_avx2 = contexts_body;
#endif

} // namespace

void portable::weigh_beside(const std::int16_t* weights, const Above& above, std::int64_t* sum, std::int32_t* size,
                            std::size_t n) noexcept {
  weigh_beside_body(weights, above, sum, size, n);
}
void portable::weigh_chord(const std::int16_t* weights, const std::int32_t* chord, std::int64_t* sum, std::size_t n) noexcept {
  weigh_chord_body(weights, chord, sum, n);
}
void portable::residuals(const std::int16_t* weights, const Left& left, const std::int64_t* sum, std::int32_t* residual,
                         std::size_t n) noexcept {
  residuals_body(weights, left, sum, residual, n);
}
std::uint8_t portable::tokens(const std::int32_t* values, std::uint8_t* token, std::size_t n) noexcept {
  return tokens_body(values, token, n);
}
void portable::contexts(const std::int32_t* size, const std::int32_t* above, std::uint8_t* context, std::size_t n) noexcept {
  contexts_body(size, above, context, n);
}

std::size_t above(const double* values, double limit, std::uint32_t* indexes, std::size_t n, double& rest) noexcept {
  return has_avx2() ? above_avx2(values, limit, indexes, n, rest) : above_body(values, limit, indexes, n, rest);
}

std::size_t count_above(const double* values, double limit, std::size_t n) noexcept {
  return has_avx2() ? count_above_avx2(values, limit, n) : count_above_body(values, limit, n);
}

void from_steps(const std::int32_t* u, std::uint32_t base, std::uint32_t step, std::int32_t* to, std::size_t n) noexcept {
  if (has_avx2())
    from_steps_avx2(u, base, step, to, n);
  else
    from_steps_body(u, base, step, to, n);
}

void ramp(std::uint32_t first, std::uint32_t step, std::int32_t* to, std::size_t n) noexcept {
  if (has_avx2())
    ramp_avx2(first, step, to, n);
  else
    ramp_body(first, step, to, n);
}

void cap(std::uint8_t* values, std::uint8_t most, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i) values[i] = std::min(values[i], most);
}

void slope(std::int32_t from, std::int64_t step, std::int32_t* to, std::size_t n) noexcept {
  has_avx2() ? slope_avx2(from, step, to, n) : slope_body(from, step, to, n);
}

void off_slope(std::int32_t from, std::int64_t step, const std::int32_t* values, std::int32_t* chord, std::int32_t* off,
               std::size_t n) noexcept {
  has_avx2() ? off_slope_avx2(from, step, values, chord, off, n) : off_slope_body(from, step, values, chord, off, n);
}

void bounds(const std::int32_t* values, std::size_t n, std::int32_t& low, std::int32_t& high) noexcept {
  if (has_avx2())
    bounds_avx2(values, n, low, high);
  else
    bounds_body(values, n, low, high);
}

void weigh_beside(const std::int16_t* weights, const Above& above, std::int64_t* sum, std::int32_t* size,
                  std::size_t n) noexcept {
  has_avx2() ? weigh_beside_avx2(weights, above, sum, size, n) : portable::weigh_beside(weights, above, sum, size, n);
}

void weigh_chord(const std::int16_t* weights, const std::int32_t* chord, std::int64_t* sum, std::size_t n) noexcept {
  has_avx2() ? weigh_chord_avx2(weights, chord, sum, n) : portable::weigh_chord(weights, chord, sum, n);
}

void residuals(const std::int16_t* weights, const Left& left, const std::int64_t* sum, std::int32_t* residual,
               std::size_t n) noexcept {
  if (has_avx2())
    residuals_avx2(weights, left, sum, residual, n);
  else
    portable::residuals(weights, left, sum, residual, n);
}

void sizes(const std::int32_t* residual, std::uint32_t limit, std::int32_t* size, std::size_t n) noexcept {
  if (has_avx2())
    sizes_avx2(residual, limit, size, n);
  else
    sizes_body(residual, limit, size, n);
}

std::uint8_t tokens(const std::int32_t* values, std::uint8_t* token, std::size_t n) noexcept {
  return has_avx2() ? tokens_avx2(values, token, n) : portable::tokens(values, token, n);
}

void contexts(const std::int32_t* size, const std::int32_t* above, std::uint8_t* context, std::size_t n) noexcept {
  if (has_avx2())
    contexts_avx2(size, above, context, n);
  else
    portable::contexts(size, above, context, n);
}

} // namespace scansion::kernels
