// What passes are written with: vectors of several values, and the marks of functions that are compiled for AVX2.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#define SCANSION_INLINE inline __attribute__((always_inline))

namespace scansion::passes {

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

#endif

} // namespace scansion::passes
