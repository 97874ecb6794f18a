// Inner loops of ruled axes.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/ruling_kernels.hpp"

#include "pipeline/model/avx2.hpp"

#include <cmath>
#include <cstring>

namespace scansion::kernels {
namespace {

std::size_t along_pitch_body(const std::int32_t* u, std::size_t n, Spread& spread) noexcept {
  const double half = std::abs(spread.pitch) / 2;
  for (std::size_t i = 0; i < n; ++i) {
    const double step = static_cast<double>(u[i]) - u[static_cast<std::ptrdiff_t>(i) - 1];
    if (std::abs(step - spread.pitch) >= half) return i;
    spread.last += 1;
    spread.take(u[i]);
  }
  return n;
}

inline __attribute__((always_inline)) void ruled_body(std::uint32_t first, std::uint64_t at, std::uint64_t pitch,
                                                      std::int32_t* __restrict to, std::size_t n) noexcept {
  for (std::size_t i = 0; i < n; ++i) {
    at += pitch;
    to[i] = static_cast<std::int32_t>(first + static_cast<std::uint32_t>(at >> 32U));
  }
}

#if defined(__x86_64__)
using Four = double __attribute__((vector_size(32)));
using FourWhole = std::int32_t __attribute__((vector_size(16)));

__attribute__((target("avx2"), always_inline)) inline Four four_of(const std::int32_t* from) noexcept {
  FourWhole whole;
  std::memcpy(&whole, from, sizeof whole);
  return __builtin_convertvector(whole, Four);
}

// Four points at a time as long as none of them says anything new; that is told one by one, in the very same arithmetic.
__attribute__((target("avx2"))) std::size_t along_pitch_avx2(const std::int32_t* u, std::size_t n, Spread& spread) noexcept {
  constexpr std::size_t kLanes = 4;
  const Four pitch = Four{} + spread.pitch;
  const Four origin = Four{} + spread.origin;
  const Four half = Four{} + std::abs(spread.pitch) / 2;
  Four low = Four{} + spread.low;
  Four high = Four{} + spread.high;
  Four sample = Four{1, 2, 3, 4} + spread.last;
  std::size_t i = 0;
  for (; i + kLanes <= n; i += kLanes, sample += 4.0) {
    const Four here = four_of(u + i);
    Four away = (here - four_of(u + i - 1)) - pitch;
    away = away < 0 ? -away : away;
    const Four off = (here - origin) - pitch * sample;
    const auto news = (away >= half) | (off < low) | (off > high);
    if (__builtin_ia32_movmskpd256(reinterpret_cast<Four>(news)) == 0) continue;
    spread.last = sample[0] - 1;
    if (const std::size_t taken = along_pitch_body(u + i, kLanes, spread); taken < kLanes) return i + taken;
    low = Four{} + spread.low;
    high = Four{} + spread.high;
  }
  spread.last = sample[0] - 1;
  return i + along_pitch_body(u + i, n - i, spread);
}
__attribute__((target("avx2"))) void ruled_avx2(std::uint32_t first, std::uint64_t at, std::uint64_t pitch, std::int32_t* to,
                                                std::size_t n) noexcept {
  ruled_body(first, at, pitch, to, n);
}
#else
constexpr auto along_pitch_avx2 = along_pitch_body;
constexpr auto ruled_avx2 = ruled_body;
#endif

} // namespace

std::size_t along_pitch(const std::int32_t* u, std::size_t n, Spread& spread) noexcept {
  return has_avx2() ? along_pitch_avx2(u, n, spread) : along_pitch_body(u, n, spread);
}

void ruled(std::uint32_t first, std::uint64_t at, std::uint64_t pitch, std::int32_t* to, std::size_t n) noexcept {
  has_avx2() ? ruled_avx2(first, at, pitch, to, n) : ruled_body(first, at, pitch, to, n);
}

} // namespace scansion::kernels
