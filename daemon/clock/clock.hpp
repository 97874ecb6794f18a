// Where all time in the daemon comes from, and how threads wait for it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <limits>
#include <mutex>

namespace scansion {

/// Nanoseconds of CLOCK_MONOTONIC (or of a manual clock).
using SteadyNs = std::int64_t;

inline constexpr SteadyNs kNever = std::numeric_limits<SteadyNs>::max();
inline constexpr SteadyNs kMillisecond = 1'000'000;
inline constexpr SteadyNs kSecond = 1'000'000'000;

/// Thread-safe.
class Clock {
public:
  Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  virtual ~Clock() = default;

  [[nodiscard]] virtual SteadyNs steady_ns() const noexcept = 0;
  /// Nanoseconds since 1970-01-01 UTC; may jump.
  [[nodiscard]] virtual std::int64_t realtime_ns() const noexcept = 0;
  /// Waits until `condition` is notified or `deadline` has come; may wake early, so callers look again at what they wait for.
  virtual void wait_until(std::unique_lock<std::mutex>& lock, std::condition_variable& condition, SteadyNs deadline) = 0;
};

/// The clock of the machine.
class SystemClock final : public Clock {
public:
  [[nodiscard]] SteadyNs steady_ns() const noexcept override;
  [[nodiscard]] std::int64_t realtime_ns() const noexcept override;
  void wait_until(std::unique_lock<std::mutex>& lock, std::condition_variable& condition, SteadyNs deadline) override;
};

/// A clock that stands until it is moved: for tests. A waiting thread looks at it once a millisecond of the machine's time,
/// since a foreign condition cannot be notified without its lock.
class ManualClock final : public Clock {
public:
  explicit ManualClock(SteadyNs steady = kSecond, std::int64_t realtime = 1'700'000'000 * kSecond) noexcept
      : steady_(steady), realtime_(realtime) {}
  [[nodiscard]] SteadyNs steady_ns() const noexcept override { return steady_.load(); }
  [[nodiscard]] std::int64_t realtime_ns() const noexcept override { return realtime_.load(); }
  void wait_until(std::unique_lock<std::mutex>& lock, std::condition_variable& condition, SteadyNs deadline) override;

  void advance(SteadyNs by) noexcept {
    steady_ += by;
    realtime_ += by;
  }
  /// The realtime clock alone jumps, as after a time synchronisation.
  void jump_realtime(std::int64_t by) noexcept { realtime_ += by; }

private:
  std::atomic<SteadyNs> steady_;
  std::atomic<std::int64_t> realtime_;
};

} // namespace scansion
