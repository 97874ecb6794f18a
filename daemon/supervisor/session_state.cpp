// The state machine of one device.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/supervisor/session_state.hpp"

namespace scansion {

std::string_view name(SessionState state) noexcept {
  switch (state) {
    case SessionState::closed: return "closed";
    case SessionState::opening: return "opening";
    case SessionState::starting: return "starting";
    case SessionState::streaming: return "streaming";
    case SessionState::stale: return "stale";
    case SessionState::lost: return "lost";
    case SessionState::backing_off: return "backing off";
    case SessionState::held: return "held";
    case SessionState::stopped: return "stopped";
    case SessionState::finished: return "finished";
  }
  return "closed";
}

void SessionMachine::streaming(SteadyNs now) noexcept {
  state_ = SessionState::streaming;
  streaming_since_ = now;
  last_delivery_ = now;
}

void SessionMachine::delivered(SteadyNs now) noexcept {
  // Time before a silence does not count: only a device that keeps delivering is stable.
  if (state_ == SessionState::stale || state_ == SessionState::held) streaming_since_ = now;
  if (is_open()) {
    state_ = SessionState::streaming;
    last_delivery_ = now;
  }
}

void SessionMachine::silent(SteadyNs now) noexcept {
  if (state_ == SessionState::held) streaming(now);
  if (state_ == SessionState::streaming && now - last_delivery_ >= policy_.stale_after) state_ = SessionState::stale;
}

void SessionMachine::held() noexcept {
  if (is_open()) state_ = SessionState::held;
}

void SessionMachine::failed(Errc code, SteadyNs now) {
  next_ = after_error(code);
  const bool streamed = is_open();
  if (state_ == SessionState::streaming && last_delivery_ - streaming_since_ >= policy_.stable_after) failures_ = 0;
  state_ = SessionState::lost;
  if (!streamed) settle(now);
}

void SessionMachine::settle(SteadyNs now) {
  if (state_ != SessionState::lost) return;
  if (next_ == AfterError::give_up) {
    state_ = SessionState::closed;
    return;
  }
  constexpr std::uint32_t kMostDoublings = 30;
  SteadyNs wait = policy_.first_wait;
  for (std::uint32_t i = 0; i < std::min(failures_, kMostDoublings) && wait < policy_.longest_wait; ++i) wait *= 2;
  wait = std::min(wait, policy_.longest_wait);
  if (failures_ < kMostDoublings) ++failures_;
  std::uniform_real_distribution<double> vary(1.0 - policy_.jitter, 1.0 + policy_.jitter);
  retry_at_ = now + static_cast<SteadyNs>(static_cast<double>(wait) * vary(random_));
  state_ = SessionState::backing_off;
}

} // namespace scansion
