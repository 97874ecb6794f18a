// One device at work: its driver, its two threads and its status.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/control/status.hpp"
#include "daemon/supervisor/session_shared.hpp"

#include <thread>

namespace scansion {

/// Thread-bound, but status() and progress_at() are thread-safe.
class DeviceSession {
public:
  /// Starts both threads. `settings` and `ports` must outlive the session.
  DeviceSession(DeviceConfig config, std::unique_ptr<Driver> driver, const SessionSettings& settings, const JournalPorts& ports,
                Clock& clock);
  DeviceSession(const DeviceSession&) = delete;
  DeviceSession& operator=(const DeviceSession&) = delete;
  ~DeviceSession();

  /// Asks the device to stop; does not wait.
  void request_stop();
  /// Waits for the device until `deadline`; one that is stuck is left behind, its lines so far are kept. False: it was.
  [[nodiscard]] bool wait_device(SteadyNs deadline);
  /// After wait_device(): waits until all is written and the recording closed. False: not yet at `deadline`.
  [[nodiscard]] bool wait_recording(SteadyNs deadline);

  /// What a person wants of the device. Thread-safe.
  void want(Wanted wanted) { shared_->want(wanted); }

  [[nodiscard]] const DeviceConfig& config() const noexcept { return shared_->config; }
  [[nodiscard]] DeviceStatus status() const;
  /// Writes the device's newest raw bytes into the recording directory. Thread-safe.
  void dump_raw() const;
  /// When the worker last went on. kNever once it is done: nothing is expected then.
  [[nodiscard]] SteadyNs progress_at() const;

private:
  std::shared_ptr<SessionShared> shared_;
  const SessionSettings& settings_;
  const JournalPorts& ports_;
  Clock& clock_;
  std::thread acquisition_;
  std::thread worker_;
};

} // namespace scansion
