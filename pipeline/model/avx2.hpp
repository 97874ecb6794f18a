// Whether the processor has AVX2, asked once.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace scansion {

[[nodiscard]] inline bool has_avx2() noexcept {
#if defined(__x86_64__)
  static const bool has = __builtin_cpu_supports("avx2") != 0;
  return has;
#else
  return false;
#endif
}

} // namespace scansion
