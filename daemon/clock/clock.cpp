// Where all time in the daemon comes from.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/clock/clock.hpp"

#include <chrono>

namespace scansion {

SteadyNs SystemClock::steady_ns() const noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::int64_t SystemClock::realtime_ns() const noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

void SystemClock::wait_until(std::unique_lock<std::mutex>& lock, std::condition_variable& condition, SteadyNs deadline) {
  if (deadline == kNever) {
    condition.wait(lock);
    return;
  }
  condition.wait_until(lock, std::chrono::steady_clock::time_point(std::chrono::nanoseconds(deadline)));
}

void ManualClock::wait_until(std::unique_lock<std::mutex>& lock, std::condition_variable& condition, SteadyNs deadline) {
  if (steady_.load() < deadline) condition.wait_for(lock, std::chrono::milliseconds(1));
}

} // namespace scansion
