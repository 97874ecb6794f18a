// What the vector code of the order gets and gives: plain pointers, see vector_job.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace scansion {

/// The inner points of a ranked run, n >= 4 points in all.
struct OrderJob {
  const double* distance;     ///< n, finite inside
  const std::uint32_t* depth; ///< n
  std::uint32_t n;
  std::uint32_t* order; ///< n, out: from the third element on

  // Scratch.
  std::uint64_t* keys;   ///< n
  std::uint64_t* sorted; ///< n
  std::uint32_t* digits; ///< n
  std::uint32_t* counts; ///< kOrderCounts
};

/// Two tables of digits.
inline constexpr std::size_t kOrderCounts = std::size_t{2} << 14U;

/// Indexes of more points do not fit a key.
inline constexpr std::size_t kOrderPoints = std::size_t{1} << 24U;

/// False: the order is nearly right, but some distances or depths need more bits than a key has.
[[nodiscard]] bool order_portable(const OrderJob& job);
#if defined(__x86_64__)
[[nodiscard]] bool order_avx2(const OrderJob& job);
[[nodiscard]] bool order_avx512(const OrderJob& job);
#endif

} // namespace scansion
