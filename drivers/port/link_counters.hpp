// What came from a device, what of it was understood, and why the rest was not.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string_view>

namespace scansion {

/// Why a frame was not taken. The order is that of the checks: a frame is counted once, by the first cause that is found.
enum class Reject : std::uint8_t {
  framing,  ///< not the shape of a frame; foreign bytes are counted up to the next place where a frame may begin
  overlong, ///< longer than any frame can be
  echo,     ///< not an answer to what was asked
  checksum, ///< its sum is wrong
  count,    ///< has not the number of values that was asked for
  value     ///< a value that cannot be
};
inline constexpr std::size_t kRejects = 6;
[[nodiscard]] constexpr std::string_view name(Reject cause) noexcept {
  switch (cause) {
    case Reject::framing: return "framing";
    case Reject::overlong: return "overlong";
    case Reject::echo: return "echo";
    case Reject::checksum: return "checksum";
    case Reject::count: return "count";
    case Reject::value: return "value";
  }
  return "";
}

/// Since the driver was made; none of them ever goes back. frames = accepted + the sum of rejects. Written by the acquisition
/// thread, read by any.
struct LinkCounters {
  std::atomic<std::uint64_t> bytes_in{0}, bytes_out{0};
  std::atomic<std::uint64_t> accepted{0}; ///< frames that were understood, replies included
  std::array<std::atomic<std::uint64_t>, kRejects> rejects{};

  void accept() noexcept { accepted.fetch_add(1, std::memory_order_relaxed); }
  void reject(Reject cause) noexcept { rejects[static_cast<std::size_t>(cause)].fetch_add(1, std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t rejected(Reject cause) const noexcept { return rejects[static_cast<std::size_t>(cause)]; }
  [[nodiscard]] std::uint64_t rejected() const noexcept {
    std::uint64_t sum = 0;
    for (const auto& count : rejects) sum += count;
    return sum;
  }
};

} // namespace scansion
