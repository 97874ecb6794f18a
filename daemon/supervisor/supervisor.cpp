// All devices of the daemon.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/supervisor/supervisor.hpp"

#include <spdlog/spdlog.h>

namespace scansion {

SessionSettings session_settings(const Config& config) {
  constexpr std::uint64_t kMegabyte = 1ULL << 20U;
  SessionSettings out;
  out.group_age = config.recording.group_ms * kMillisecond;
  out.levels = config.levels;
  out.recorder.sync_interval = config.recording.sync_interval_ms * kMillisecond;
  out.recorder.rotate_bytes = static_cast<std::uint64_t>(config.recording.rotate_mb) * kMegabyte;
  out.recorder.rotate_age = config.recording.rotate_minutes * 60 * kSecond;
  out.recorder.min_free_bytes = static_cast<std::uint64_t>(config.recording.min_free_mb) * kMegabyte;
  return out;
}

Result<std::vector<Supervisor::Prepared>> Supervisor::prepare(const std::vector<DeviceConfig>& devices) {
  std::vector<Prepared> out;
  for (const DeviceConfig& device : devices) {
    SCANSION_TRY(driver, device.driver->make(device.options));
    out.push_back({device, std::move(driver)});
  }
  return out;
}

void Supervisor::launch(std::vector<Prepared> prepared) {
  for (Prepared& device : prepared) {
    auto session =
        std::make_unique<DeviceSession>(std::move(device.config), std::move(device.driver), settings_, ports_, clock_);
    const std::lock_guard lock(mutex_);
    sessions_.push_back(std::move(session));
  }
}

Result<void> Supervisor::start(const std::vector<DeviceConfig>& devices) {
  SCANSION_TRY(prepared, prepare(devices));
  launch(std::move(prepared));
  return success();
}

Result<Supervisor::Changes> Supervisor::reload(const std::vector<DeviceConfig>& devices) {
  const auto is_wanted = [&](const std::unique_ptr<DeviceSession>& session) {
    return std::find(devices.begin(), devices.end(), session->config()) != devices.end();
  };
  std::vector<DeviceConfig> added;
  for (const DeviceConfig& device : devices) {
    const auto runs = [&](const std::unique_ptr<DeviceSession>& session) { return session->config() == device; };
    if (std::none_of(sessions_.begin(), sessions_.end(), runs)) added.push_back(device);
  }
  SCANSION_TRY(prepared, prepare(added));

  Sessions removed;
  Changes changes;
  {
    const std::lock_guard lock(mutex_);
    const auto first = std::stable_partition(sessions_.begin(), sessions_.end(), is_wanted);
    std::move(first, sessions_.end(), std::back_inserter(removed));
    sessions_.erase(first, sessions_.end());
    changes = {sessions_.size(), prepared.size(), removed.size()};
  }
  // Before the new ones start: a changed device needs its port, and its file must be closed.
  if (!stop_sessions(removed, 2 * kSecond)) spdlog::error("a device or disk did not let go in time; going on without it");
  std::erase_if(leaving_, [&](const std::unique_ptr<DeviceSession>& session) { return session->wait_recording(0); });
  launch(std::move(prepared));
  return changes;
}

bool Supervisor::stop_sessions(Sessions& sessions, SteadyNs budget) {
  const SteadyNs now = clock_.steady_ns();
  for (const auto& session : sessions) session->request_stop();
  bool all = true;
  // Three quarters of the time are for devices (a machine must brake), the rest for what they delivered.
  for (const auto& session : sessions) all &= session->wait_device(now + budget / 4 * 3);
  for (auto& session : sessions) {
    if (session->wait_recording(now + budget)) continue;
    all = false;
    leaving_.push_back(std::move(session));
  }
  sessions.clear();
  return all;
}

bool Supervisor::stop(SteadyNs budget) {
  Sessions sessions;
  {
    const std::lock_guard lock(mutex_);
    sessions.swap(sessions_);
  }
  for (auto& session : leaving_) sessions.push_back(std::move(session));
  leaving_.clear();
  return stop_sessions(sessions, budget);
}

Result<void> Supervisor::want(std::string_view device, Wanted wanted) {
  const std::lock_guard lock(mutex_);
  for (const auto& session : sessions_) {
    if (session->config().name != device) continue;
    session->want(wanted);
    return success();
  }
  return fail(Errc::not_found, "there is no device \"", device, "\"");
}

std::vector<DeviceStatus> Supervisor::status() const {
  const std::lock_guard lock(mutex_);
  std::vector<DeviceStatus> out;
  for (const auto& session : sessions_) out.push_back(session->status());
  return out;
}

void Supervisor::dump_raw() const {
  const std::lock_guard lock(mutex_);
  for (const auto& session : sessions_) session->dump_raw();
}

SteadyNs Supervisor::progress_at() const {
  const std::lock_guard lock(mutex_);
  SteadyNs oldest = kNever;
  for (const auto& session : sessions_) oldest = std::min(oldest, session->progress_at());
  return oldest;
}

} // namespace scansion
