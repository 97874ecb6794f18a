// The state machine of one device: what state it is in, and when to try again.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/clock/clock.hpp"
#include "drivers/driver.hpp"

#include <random>
#include <string_view>

namespace scansion {

enum class SessionState : std::uint8_t {
  closed,      ///< not tried yet, stopped, or given up until the configuration changes
  opening,     ///< taking hold of the device
  starting,    ///< handshake
  streaming,   ///< lines come
  stale,       ///< open, but silent for too long
  lost,        ///< failed while streaming; the run is being ended
  backing_off, ///< waiting before the next attempt
  held,        ///< at rest by command, open, ready to go on
  stopped,     ///< closed by command, until a command starts it again
  finished     ///< a recorded source came to its end
};
[[nodiscard]] std::string_view name(SessionState state) noexcept;

struct SessionPolicy {
  SteadyNs first_wait = 250 * kMillisecond; ///< after a failure; doubles with each further one ...
  SteadyNs longest_wait = kSecond;          ///< ... up to this: a device that returns is open again within 2 s
  double jitter = 0.25;                ///< each wait is varied by up to this fraction, so that devices do not retry in step
  SteadyNs stale_after = 2 * kSecond;  ///< of silence
  SteadyNs stable_after = 5 * kSecond; ///< of streaming: the next failure starts with first_wait again
};

/// Pure logic: no thread, no clock, no input or output. Thread-bound.
class SessionMachine {
public:
  SessionMachine(const SessionPolicy& policy, std::uint64_t seed) noexcept : policy_(policy), random_(seed) {}

  [[nodiscard]] SessionState state() const noexcept { return state_; }
  /// When to open again; only in backing_off.
  [[nodiscard]] SteadyNs retry_at() const noexcept { return retry_at_; }
  [[nodiscard]] std::uint32_t failures() const noexcept { return failures_; }

  void opening() noexcept { state_ = SessionState::opening; }
  void starting() noexcept { state_ = SessionState::starting; }
  void streaming(SteadyNs now) noexcept;
  /// Something came from the device.
  void delivered(SteadyNs now) noexcept;
  /// Nothing came although it was waited for.
  void silent(SteadyNs now) noexcept;
  /// Came to rest by command, or is about to; delivered() and silent() end it.
  void held() noexcept;
  void stopped() noexcept { state_ = SessionState::stopped; }
  void finished() noexcept { state_ = SessionState::finished; }
  void closed() noexcept { state_ = SessionState::closed; }
  /// The device failed. While streaming or stale it is lost until settle(); otherwise settle() happens at once.
  void failed(Errc code, SteadyNs now);
  /// The run has been ended: from lost to backing_off or closed.
  void settle(SteadyNs now);

private:
  [[nodiscard]] bool is_open() const noexcept {
    return state_ == SessionState::streaming || state_ == SessionState::stale || state_ == SessionState::held;
  }

  SessionPolicy policy_;
  std::minstd_rand random_;
  SessionState state_ = SessionState::closed;
  AfterError next_ = AfterError::reopen;
  std::uint32_t failures_ = 0; ///< in a row
  SteadyNs retry_at_ = 0;
  SteadyNs streaming_since_ = 0;
  SteadyNs last_delivery_ = 0;
};

} // namespace scansion
