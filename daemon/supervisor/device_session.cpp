// One device at work.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/supervisor/device_session.hpp"

#include "daemon/supervisor/acquisition.hpp"
#include "daemon/supervisor/worker.hpp"

#include <spdlog/spdlog.h>

namespace scansion {

DeviceSession::DeviceSession(DeviceConfig config, std::unique_ptr<Driver> driver, const SessionSettings& settings,
                             const JournalPorts& ports, Clock& clock)
    : shared_(std::make_shared<SessionShared>(std::move(config), clock)), clock_(clock) {
  shared_->worker_beat = clock.steady_ns();
  worker_ = std::thread([shared = shared_, &settings, &ports] { record_lines(*shared, settings, ports); });
  // The thread owns all it touches: when the device never lets go of it, it may outlive the session.
  acquisition_ = std::thread([shared = shared_, driver = std::move(driver), policy = settings.policy]() mutable {
    acquire(*shared, *driver, policy);
    driver.reset();
  });
}

DeviceSession::~DeviceSession() {
  request_stop();
  // Left behind or not: either way the worker can end now.
  [[maybe_unused]] const bool device_let_go = wait_device(clock_.steady_ns() + kSecond);
  if (worker_.joinable()) worker_.join();
}

void DeviceSession::request_stop() {
  shared_->stop();
}

bool DeviceSession::wait_device(SteadyNs deadline) {
  if (!acquisition_.joinable()) return true;
  if (shared_->wait_acquisition(deadline)) {
    acquisition_.join();
    return true;
  }
  spdlog::error("{}: the device does not let go; it is left behind", shared_->config.name);
  acquisition_.detach();
  shared_->queue.close();
  return false;
}

bool DeviceSession::wait_recording(SteadyNs deadline) {
  if (!worker_.joinable()) return true;
  if (!shared_->wait_worker(deadline)) return false;
  worker_.join();
  return true;
}

SteadyNs DeviceSession::progress_at() const {
  return shared_->wait_worker(0) ? kNever : shared_->worker_beat.load();
}

DeviceStatus DeviceSession::status() const {
  const SessionShared::View view = shared_->view();
  const RecorderStatus& recorder = view.recorder;
  DeviceStatus out;
  out.name = shared_->config.name;
  out.driver = shared_->config.driver->name;
  out.state = name(view.state);
  out.error = view.error;
  out.lines = shared_->lines;
  out.points = shared_->points;
  out.invalid = shared_->invalid;
  out.gaps = shared_->gaps;
  out.lost_lines = recorder.lost_lines;
  out.groups_written = recorder.groups_written;
  out.lines_written = recorder.lines_written;
  out.queue_depth = shared_->queue.depth();
  out.queue_bound = LineQueue::kLines;
  out.pending_groups = recorder.pending_groups;
  const SteadyNs oldest = std::min(shared_->queue.oldest(), shared_->oldest_unwritten.load());
  if (oldest != kNever) out.lag_ms = std::max<SteadyNs>(0, clock_.steady_ns() - oldest) / kMillisecond;
  out.recording = recorder.path;
  out.recording_bytes = recorder.bytes;
  out.last_recording = recorder.last_path;
  out.blocked = recorder.blocked;
  if (const std::int64_t last = shared_->last_line_ns; last != 0) out.last_line_ns = last;
  return out;
}

} // namespace scansion
