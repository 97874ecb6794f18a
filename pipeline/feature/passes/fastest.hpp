// Code of a few points, compiled for AVX2 as well: the same sums in the same order, so the same results, in fewer instructions.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/passes/lanes.hpp"
#include "pipeline/model/avx2.hpp"

#include <utility>

namespace scansion::passes {

template <auto body>
struct Fastest;

/// Of a function without exceptions of its own to declare.
template <typename Result, typename... Args, Result (*body)(Args...)>
struct Fastest<body> {
#if defined(__x86_64__)
  // All that `body` calls and that is in sight becomes part of it: only that is compiled for AVX2.
  [[gnu::flatten]] SCANSION_AVX2 static Result with_avx2(Args... args) {
    return body(std::forward<Args>(args)...);
  }
#endif
};

/// `body`, as fast as the processor allows.
template <auto body, typename... Args>
inline auto fastest(Args&&... args) {
#if defined(__x86_64__)
  if (has_avx2()) return Fastest<body>::with_avx2(std::forward<Args>(args)...);
#endif
  return body(std::forward<Args>(args)...);
}

} // namespace scansion::passes
