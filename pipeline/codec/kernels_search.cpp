// Loops for vector units that look for the first value out of order.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/kernels.hpp"
#include "pipeline/model/avx2.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace scansion::kernels {
namespace {

// Differences of two numbers of 32 bits need 33; their amounts fit 32 without a sign.
inline std::uint32_t amount(std::int32_t a, std::int32_t b) noexcept {
  return static_cast<std::uint32_t>(std::max(a, b)) - static_cast<std::uint32_t>(std::min(a, b));
}

std::size_t in_step_body(const std::int32_t* here, const std::int32_t* above, std::size_t n) noexcept {
  std::size_t i = 0;
  for (; i < n; ++i) {
    const std::uint32_t beside = amount(here[i], above[i + 1]);
    if (beside > amount(here[i], above[i]) || beside >= amount(here[i], above[i + 2])) break;
  }
  return i;
}

bool share_step_body(const std::int32_t* values, std::uint32_t step, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i)
    if (amount(values[i], values[0]) % step != 0) return false;
  return true;
}

void nonzero_body(const std::uint32_t* counts, std::size_t from, std::size_t n, std::uint64_t* bits) noexcept {
  for (std::size_t i = from; i < n; ++i) bits[i / 64] |= std::uint64_t{counts[i] != 0 ? 1U : 0U} << i % 64;
}

#if defined(__x86_64__)
constexpr std::size_t kLanes = 8;
using Whole = std::int32_t __attribute__((vector_size(4 * kLanes)));
using Positive = std::uint32_t __attribute__((vector_size(4 * kLanes)));
using Real = float __attribute__((vector_size(4 * kLanes)));

__attribute__((target("avx2"), always_inline)) inline Whole load(const std::int32_t* from) noexcept {
  Whole v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
__attribute__((target("avx2"), always_inline)) inline Positive amounts(Whole a, Whole b) noexcept {
  return reinterpret_cast<Positive>(a > b ? a : b) - reinterpret_cast<Positive>(a > b ? b : a);
}
__attribute__((target("avx2"), always_inline)) inline std::uint32_t marks(Whole lanes) noexcept {
  return static_cast<std::uint32_t>(__builtin_ia32_movmskps256(reinterpret_cast<Real>(lanes)));
}

__attribute__((target("avx2"))) void nonzero_avx2(const std::uint32_t* counts, std::size_t n, std::uint64_t* bits) noexcept {
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes) {
    Whole v;
    std::memcpy(&v, counts + i, sizeof v);
    bits[i / 64] |= std::uint64_t{marks(v != 0)} << i % 64;
  }
  nonzero_body(counts, i, n, bits);
}

__attribute__((target("avx2"))) std::size_t in_step_avx2(const std::int32_t* here, const std::int32_t* above,
                                                         std::size_t n) noexcept {
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes) {
    const Whole h = load(here + i);
    const Positive before = amounts(h, load(above + i));
    const Positive beside = amounts(h, load(above + i + 1));
    const Positive behind = amounts(h, load(above + i + 2));
    const std::uint32_t out =
        marks(reinterpret_cast<Whole>(beside > before)) | marks(reinterpret_cast<Whole>(beside >= behind));
    if (out != 0) return i + static_cast<std::size_t>(std::countr_zero(out));
  }
  return i + in_step_body(here + i, above + i, n - i);
}

// Multiples of step = 2^shift * odd are those whose product with the inverse of `odd`, modulo 2^32, is a small one, shift zeros
// behind it.
__attribute__((target("avx2"))) bool share_step_avx2(const std::int32_t* values, std::uint32_t step, std::size_t n) noexcept {
  const auto shift = static_cast<std::uint32_t>(std::countr_zero(step));
  const std::uint32_t odd = step >> shift;
  std::uint32_t inverse = 1;
  for (int turn = 0; turn < 5; ++turn) inverse *= 2U - odd * inverse; // each turn doubles the bits that are right
  const std::uint32_t most = ~std::uint32_t{0} / step;
  const Whole first = Whole{} + values[0];
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes) {
    const Positive product = amounts(load(values + i), first) * inverse;
    const Positive turned = shift == 0 ? product : product >> shift | product << (32 - shift);
    if (marks(reinterpret_cast<Whole>(turned > most)) != 0) return false;
  }
  for (; i < n; ++i)
    if (amount(values[i], values[0]) % step != 0) return false;
  return true;
}
#else
void nonzero_avx2(const std::uint32_t* counts, std::size_t n, std::uint64_t* bits) noexcept {
  nonzero_body(counts, 0, n, bits);
}
constexpr auto in_step_avx2 = in_step_body;
constexpr auto share_step_avx2 = share_step_body;
#endif

} // namespace

std::size_t in_step(const std::int32_t* here, const std::int32_t* above, std::size_t n) noexcept {
  return has_avx2() ? in_step_avx2(here, above, n) : in_step_body(here, above, n);
}

void nonzero(const std::uint32_t* counts, std::size_t n, std::uint64_t* bits) noexcept {
  has_avx2() ? nonzero_avx2(counts, n, bits) : nonzero_body(counts, 0, n, bits);
}

bool share_step(const std::int32_t* values, std::uint32_t step, std::size_t n) noexcept {
  return has_avx2() ? share_step_avx2(values, step, n) : share_step_body(values, step, n);
}

} // namespace scansion::kernels
