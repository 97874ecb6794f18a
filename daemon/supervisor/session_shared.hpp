// What the threads of one device share: its queue, its stop signal and what status says about it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/config/config.hpp"
#include "daemon/journal/recorder.hpp"
#include "daemon/supervisor/line_queue.hpp"
#include "daemon/supervisor/session_state.hpp"
#include "daemon/supervisor/tail_messages.hpp"

#include <atomic>

namespace scansion {

/// How a device is recorded; the same for all devices.
struct SessionSettings {
  SteadyNs group_age = 250 * kMillisecond;
  LevelSpec levels;
  RecorderSettings recorder;
  SessionPolicy policy;
  TailHub* tail = nullptr; ///< told of lines and states; outlives the sessions
};

/// Thread-safe. Held by shared_ptr: an acquisition thread that is stuck in its device outlives its session.
struct SessionShared {
  SessionShared(DeviceConfig device_config, Clock& session_clock)
      : config(std::move(device_config)), clock(session_clock), queue(session_clock) {}

  const DeviceConfig config;
  LinkView link;           ///< set before the threads start
  TailHub* tail = nullptr; ///< set before the threads start; empty: nobody listens
  Clock& clock;
  LineQueue queue;

  // Written by the acquisition thread.
  std::atomic<std::uint64_t> lines{0}, points{0}, invalid{0}, gaps{0};
  std::atomic<std::int64_t> last_line_ns{0}; ///< realtime; 0: none yet
  /// Every line whose last byte came before this moment has been pushed. Moves on while the device is silent.
  std::atomic<SteadyNs> horizon{0};
  // Written by the worker.
  std::atomic<SteadyNs> oldest_unwritten{kNever}; ///< of the lines that left the queue
  std::atomic<SteadyNs> worker_beat{0};           ///< when the worker last showed that it goes on

  /// Asks both threads to end.
  void stop() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_all();
  }
  [[nodiscard]] bool stopping() const {
    const std::lock_guard lock(mutex_);
    return stopping_;
  }
  /// What a person wants of the device.
  void want(Wanted wanted) {
    wanted_ = wanted;
    const std::lock_guard lock(mutex_);
    changed_.notify_all();
  }
  [[nodiscard]] Wanted wanted() const noexcept { return wanted_; }
  /// Waits until the device may run; false: stop() was called.
  [[nodiscard]] bool wait_until_wanted() {
    std::unique_lock lock(mutex_);
    while (!stopping_ && wanted_ != Wanted::run) clock.wait_until(lock, changed_, clock.steady_ns() + kSecond);
    return !stopping_;
  }
  /// Waits; false: stop() was called.
  [[nodiscard]] bool sleep_until(SteadyNs deadline) {
    std::unique_lock lock(mutex_);
    while (!stopping_ && clock.steady_ns() < deadline) clock.wait_until(lock, changed_, deadline);
    return !stopping_;
  }

  void set_state(SessionState state) {
    {
      const std::lock_guard lock(mutex_);
      if (std::exchange(state_, state) == state) return;
    }
    if (tail != nullptr) tell_state(*tail, config.name, name(state));
  }
  /// Empty: all is well again.
  void set_error(std::string error) {
    const std::lock_guard lock(mutex_);
    error_ = std::move(error);
  }
  void set_recorder(RecorderStatus status) {
    const std::lock_guard lock(mutex_);
    recorder_ = std::move(status);
  }
  void set_acquisition_done() { set_done(acquisition_done_); }
  void set_worker_done() { set_done(worker_done_); }
  /// False: not done at the deadline.
  [[nodiscard]] bool wait_acquisition(SteadyNs deadline) { return wait_done(acquisition_done_, deadline); }
  [[nodiscard]] bool wait_worker(SteadyNs deadline) { return wait_done(worker_done_, deadline); }

  struct View {
    SessionState state = SessionState::closed;
    std::string error;
    RecorderStatus recorder;
  };
  [[nodiscard]] View view() const {
    const std::lock_guard lock(mutex_);
    return {state_, error_, recorder_};
  }

private:
  void set_done(bool& done) {
    {
      const std::lock_guard lock(mutex_);
      done = true;
    }
    changed_.notify_all();
  }
  [[nodiscard]] bool wait_done(const bool& done, SteadyNs deadline) {
    std::unique_lock lock(mutex_);
    while (!done && clock.steady_ns() < deadline) clock.wait_until(lock, changed_, deadline);
    return done;
  }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::atomic<Wanted> wanted_{Wanted::run};
  bool stopping_ = false, acquisition_done_ = false, worker_done_ = false;
  SessionState state_ = SessionState::opening; ///< from the start: closed means given up
  std::string error_;
  RecorderStatus recorder_;
};

} // namespace scansion
