// The daemon's life: start, signals, watchdog, stop.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/service.hpp"

#include "daemon/control/server.hpp"
#include "daemon/control/status.hpp"
#include "daemon/supervisor/supervisor.hpp"

#include <csignal>
#include <ctime>
#include <spdlog/spdlog.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

namespace scansion {
namespace {

constexpr SteadyNs kStopBudget = 1700 * kMillisecond; ///< of the 2 s in which the daemon must be gone
constexpr SteadyNs kTick = 500 * kMillisecond;

/// Tells systemd; not an error when there is none.
void notify(const std::string& state) {
  static_cast<void>(sd_notify(0, state.c_str()));
}

sigset_t handled_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int number : {SIGTERM, SIGINT, SIGHUP, SIGUSR1}) sigaddset(&set, number);
  return set;
}

/// The number of a signal, or 0 after `wait`.
int next_signal(const sigset_t& set, SteadyNs wait) {
  const timespec time{wait / kSecond, wait % kSecond};
  const int number = ::sigtimedwait(&set, nullptr, &time);
  return number > 0 ? number : 0;
}

/// Says that the daemon lives, as long as every worker does.
class Watchdog {
public:
  explicit Watchdog(Clock& clock) : clock_(clock) {
    std::uint64_t interval_us = 0;
    if (sd_watchdog_enabled(0, &interval_us) > 0) interval_ = static_cast<SteadyNs>(interval_us) * 1000;
  }
  [[nodiscard]] SteadyNs tick() const noexcept { return interval_ > 0 ? std::min(kTick, interval_ / 4) : kTick; }

  void look(SteadyNs progress_at) {
    if (interval_ == 0) return;
    const SteadyNs silent = progress_at == kNever ? 0 : clock_.steady_ns() - progress_at;
    if (silent < interval_ / 2) {
      notify("WATCHDOG=1");
      warned_ = false;
    } else if (!warned_) {
      spdlog::error("a pipeline worker has not gone on for {} ms; systemd will restart the daemon", silent / kMillisecond);
      warned_ = true;
    }
  }

private:
  Clock& clock_;
  SteadyNs interval_ = 0;
  bool warned_ = false;
};

std::string summary(const std::vector<DeviceStatus>& devices) {
  std::size_t streaming = 0;
  std::uint64_t lines = 0;
  bool blocked = false;
  for (const DeviceStatus& device : devices) {
    if (device.state == "streaming") ++streaming;
    lines += device.lines;
    blocked |= !device.blocked.empty();
  }
  return std::to_string(streaming) + " of " + std::to_string(devices.size()) + " devices streaming, " + std::to_string(lines) +
         " lines" + (blocked ? ", recording blocked" : "");
}

class Service {
public:
  Service(Config config, SystemClock& clock) : config_(std::move(config)), clock_(clock), started_(clock.steady_ns()) {}

  Result<void> start() {
    if (config_.socket.empty()) {
      SCANSION_TRY(found, default_socket_path());
      config_.socket = found;
    }
    SCANSION_TRY(directory, JournalDirectory::open(config_.recording.directory));
    directory_.emplace(std::move(directory));
    SCANSION_TRY(repair());
    SCANSION_TRY(hub, TailHub::make());
    hub_ = std::move(hub);
    SessionSettings settings = session_settings(config_);
    settings.tail = hub_.get();
    supervisor_.emplace(std::move(settings), JournalPorts{*directory_, telling_sinks(file_sinks(), *hub_), {}}, clock_);
    SCANSION_TRY(server, ControlServer::listen(config_.socket, clock_));
    server_ = std::move(server);
    SCANSION_TRY(supervisor_->start(config_.devices));
    server_->serve([this](std::string_view request) { return answer(request, answers()); }, hub_.get());
    if (config_.devices.empty()) spdlog::warn("{}: no [[device]] is configured, so nothing is recorded", config_.file);
    spdlog::info("scansiond {} started: {} devices, recordings in {}, control socket {}", kVersion, config_.devices.size(),
                 directory_->path(), config_.socket);
    return success();
  }

  void loop(const sigset_t& signals) {
    Watchdog watchdog(clock_);
    std::string told;
    notify("READY=1");
    for (;;) {
      const int number = next_signal(signals, watchdog.tick());
      if (number == SIGTERM || number == SIGINT) {
        spdlog::info("stopping on signal {}", number);
        return;
      }
      if (number == SIGHUP) reload();
      if (number == SIGUSR1) supervisor_->dump_raw();
      watchdog.look(supervisor_->progress_at());
      if (std::string now = summary(supervisor_->status()); now != told) {
        told = std::move(now);
        notify("STATUS=" + told);
      }
    }
  }

  /// False: something was left behind, destructors must not run.
  [[nodiscard]] bool stop() {
    notify("STOPPING=1");
    const bool clean = supervisor_->stop(kStopBudget);
    server_.reset();
    spdlog::info("stopped{}", clean ? "" : ", leaving a stuck device or disk behind");
    return clean;
  }

private:
  Result<void> repair() {
    SCANSION_TRY(repaired, directory_->repair_all());
    for (const auto& one : repaired) {
      if (!one.problem.empty())
        spdlog::error("{}: left as it is: {}", one.file, one.problem);
      else if (one.removed)
        spdlog::warn("{}: removed, it held no line", one.file);
      else
        spdlog::warn("{}: completed after an unclean end, {} bytes of an unfinished group cut off", one.file, one.cut_bytes);
    }
    return success();
  }

  void reload() {
    notify("RELOADING=1");
    auto next = load_config(config_.file);
    if (!next) {
      spdlog::error("the new configuration is refused, the old one stays in force:\n{}", next.assume_error().context);
    } else {
      take(next.assume_value());
    }
    notify("READY=1");
  }

  void take(const Config& next) {
    if (!(next.recording_values == config_.recording_values && next.control_values == config_.control_values &&
          next.pipeline_values == config_.pipeline_values)) {
      spdlog::warn("changes of [recording], [control] and [pipeline] need a restart of the daemon; only devices are reloaded");
    }
    auto changes = supervisor_->reload(next.devices);
    if (!changes) {
      spdlog::error("the new configuration is refused, the old one stays in force: {}", changes.assume_error().context);
      return;
    }
    const auto& done = changes.assume_value();
    spdlog::info("reloaded: {} devices unchanged, {} stopped, {} started", done.kept, done.stopped, done.started);
  }

  Answers answers() {
    return {[this] { return status(); },
            [this](std::string_view device, Order order) {
              return supervisor_->want(device, order == Order::start     ? Wanted::run
                                               : order == Order::release ? Wanted::leave
                                                                         : Wanted::hold);
            }};
  }

  DaemonStatus status() {
    DaemonStatus out;
    out.version = kVersion;
    out.pid = ::getpid();
    out.uptime_ns = clock_.steady_ns() - started_;
    out.started_ns = clock_.realtime_ns() - out.uptime_ns;
    out.config = config_.file;
    out.directory = directory_->path();
    if (auto free = directory_->free_bytes()) out.free_mb = free.assume_value() >> 20U;
    out.devices = supervisor_->status();
    return out;
  }

  Config config_; ///< not changed after start(), so the control thread may read it
  SystemClock& clock_;
  SteadyNs started_;
  std::optional<JournalDirectory> directory_;
  std::unique_ptr<TailHub> hub_;
  std::optional<Supervisor> supervisor_;
  std::unique_ptr<ControlServer> server_;
};

} // namespace

int serve(Config config) {
  const sigset_t signals = handled_signals();
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  // Both come back as errors of the call instead: EPIPE, EFBIG.
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);

  SystemClock clock;
  auto service = std::make_unique<Service>(std::move(config), clock);
  if (auto started = service->start(); !started) {
    spdlog::critical("{}", started.assume_error().context);
    return exit_code(started.assume_error().code);
  }
  service->loop(signals);
  if (!service->stop()) {
    spdlog::default_logger()->flush();
    ::_exit(0); // a thread that is stuck still uses what destructors would take away
  }
  return 0;
}

} // namespace scansion
