// One device at work.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/supervisor/device_session.hpp"

#include "daemon/journal/earlier_scan.hpp"
#include "daemon/journal/raw_dump.hpp"
#include "daemon/supervisor/acquisition.hpp"
#include "daemon/supervisor/worker.hpp"
#include "drivers/port/link_counters.hpp"
#include "drivers/transport/raw_ring.hpp"

#include <spdlog/spdlog.h>

namespace scansion {

namespace {

/// The daemon as a driver sees it.
class SessionHost final : public DriverHost {
public:
  SessionHost(const SessionShared& shared, const JournalDirectory& directory) : shared_(shared), directory_(directory) {}
  Wanted wanted() const noexcept override { return shared_.stopping() ? Wanted::leave : shared_.wanted(); }
  Result<std::optional<EarlierScan>> earlier_scan(std::size_t most) override {
    auto found = find_earlier_scan(directory_, shared_.config.name, most);
    if (!found) {
      spdlog::warn("{}: the newest recording cannot be read again: {}", shared_.config.name, found.assume_error().context);
    } else if (found.assume_value()) {
      spdlog::info("{}: {} holds {} lines of an earlier run", shared_.config.name, found.assume_value()->file,
                   found.assume_value()->lines.size());
    }
    return found;
  }

private:
  const SessionShared& shared_;
  const JournalDirectory& directory_;
};

/// The newest raw bytes into a file, when any came from the device.
void dump(const SessionShared& shared, DumpReason reason, const SessionSettings& settings, const JournalPorts& ports) {
  if (!shared.link.raw || !shared.link.raw->has_received()) return;
  auto path = write_raw_dump(ports.directory, shared.config.name, reason, shared.link.raw->transcript(),
                             settings.recorder.min_free_bytes);
  if (path)
    spdlog::info("{}: raw bytes dumped to {}", shared.config.name, path.assume_value());
  else
    spdlog::warn("{}: no raw dump: {}", shared.config.name, path.assume_error().context);
}

std::optional<LinkStatus> link_status(const LinkView& link) {
  const LinkCounters* counters = link.counters.get();
  if (counters == nullptr) return std::nullopt;
  LinkStatus out{counters->bytes_in, counters->bytes_out, counters->accepted, {}, link.raw ? link.raw->dropped() : 0};
  for (std::size_t i = 0; i < kRejects; ++i) out.rejected.emplace_back(name(static_cast<Reject>(i)), counters->rejects[i]);
  return out;
}

} // namespace

DeviceSession::DeviceSession(DeviceConfig config, std::unique_ptr<Driver> driver, const SessionSettings& settings,
                             const JournalPorts& ports, Clock& clock)
    : shared_(std::make_shared<SessionShared>(std::move(config), clock)), settings_(settings), ports_(ports), clock_(clock) {
  shared_->worker_beat = clock.steady_ns();
  shared_->link = driver->link();
  shared_->tail = settings.tail;
  worker_ = std::thread([shared = shared_, &settings, &ports] { record_lines(*shared, settings, ports); });
  // The thread owns all it touches: when the device never lets go of it, it may outlive the session.
  auto on_fault = [shared = shared_, &settings, &ports] { dump(*shared, DumpReason::fault, settings, ports); };
  acquisition_ =
      std::thread([shared = shared_, driver = std::move(driver), policy = settings.policy, on_fault, &ports]() mutable {
        SessionHost host(*shared, ports.directory);
        driver->attach(host);
        acquire(*shared, *driver, policy, on_fault);
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

void DeviceSession::dump_raw() const {
  dump(*shared_, DumpReason::asked, settings_, ports_);
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
  out.link = link_status(shared_->link);
  if (const std::int64_t last = shared_->last_line_ns; last != 0) out.last_line_ns = last;
  return out;
}

} // namespace scansion
