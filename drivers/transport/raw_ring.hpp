// The newest raw bytes of a device, both directions, in bounded memory.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/transport/raw_event.hpp"

#include <atomic>
#include <mutex>

namespace scansion {

/// Thread-safe. The oldest events go when the bound is reached.
class RawRing {
public:
  static constexpr std::size_t kBytes = std::size_t{256} << 10U;

  RawRing() : ring_(kBytes) {}

  void push(RawEvent::Kind kind, const Moment& at, std::span<const std::uint8_t> bytes);
  /// As a transcript; empty when nothing ever happened.
  [[nodiscard]] std::string transcript() const;
  /// Events that a transcript at its bound did not take.
  void note_dropped() noexcept { dropped_.fetch_add(1, std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }
  /// Whether anything came from the device since the ring was made.
  [[nodiscard]] bool has_received() const;

private:
  struct Head {
    RawEvent::Kind kind;
    Moment at;
    std::uint32_t size;
  };
  void put(const void* data, std::size_t size) noexcept;
  void get(std::size_t from, void* data, std::size_t size) const noexcept;
  void drop_oldest() noexcept;

  mutable std::mutex mutex_;
  std::vector<std::uint8_t> ring_;
  std::size_t first_ = 0; ///< offset of the oldest event
  std::size_t used_ = 0;  ///< bytes
  bool received_ = false;
  std::atomic<std::uint64_t> dropped_{0};
};

} // namespace scansion
