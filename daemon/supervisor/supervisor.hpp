// All devices of the daemon: started, reloaded, watched and stopped together.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/supervisor/device_session.hpp"

namespace scansion {

/// Settings of the recording side made from the configuration.
[[nodiscard]] SessionSettings session_settings(const Config& config);

/// start(), reload() and stop() come from one thread; want(), status() and progress_at() may come from any.
class Supervisor {
public:
  Supervisor(SessionSettings settings, JournalPorts ports, Clock& clock)
      : settings_(std::move(settings)), ports_(std::move(ports)), clock_(clock) {}

  /// Starts every device. Fails with the driver's reason before any has started.
  [[nodiscard]] Result<void> start(const std::vector<DeviceConfig>& devices);

  /// What a reload did.
  struct Changes {
    std::size_t kept = 0, started = 0, stopped = 0; ///< a changed device is stopped and started
  };
  /// Brings the devices to `devices`. Those whose table is unchanged keep streaming. On failure nothing has changed.
  [[nodiscard]] Result<Changes> reload(const std::vector<DeviceConfig>& devices);

  /// Stops all devices, writes what they delivered, finishes their recordings. False: something was left behind at the end of
  /// `budget`; the process must then end without running destructors.
  [[nodiscard]] bool stop(SteadyNs budget);

  /// Holds, closes or starts one device by command. Fails with not_found when there is none of this name.
  [[nodiscard]] Result<void> want(std::string_view device, Wanted wanted);

  [[nodiscard]] std::vector<DeviceStatus> status() const;
  /// Writes the newest raw bytes of every device into the recording directory.
  void dump_raw() const;
  /// The oldest sign of life of any worker; kNever when there is none to expect.
  [[nodiscard]] SteadyNs progress_at() const;

private:
  using Sessions = std::vector<std::unique_ptr<DeviceSession>>;
  struct Prepared {
    DeviceConfig config;
    std::unique_ptr<Driver> driver;
  };

  [[nodiscard]] static Result<std::vector<Prepared>> prepare(const std::vector<DeviceConfig>& devices);
  void launch(std::vector<Prepared> prepared);
  /// True: none was left behind.
  [[nodiscard]] bool stop_sessions(Sessions& sessions, SteadyNs budget);

  const SessionSettings settings_;
  const JournalPorts ports_;
  Clock& clock_;
  mutable std::mutex mutex_; ///< guards sessions_
  Sessions sessions_;
  Sessions leaving_; ///< stopped by a reload, but their disk is not done yet
};

} // namespace scansion
