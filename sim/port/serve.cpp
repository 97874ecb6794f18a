// Puts a device model on a port and keeps it going.
// SPDX-License-Identifier: Apache-2.0
#include "sim/port/serve.hpp"

#include "drivers/transport/descriptor.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <poll.h>

namespace scansion {
namespace {

constexpr std::int64_t kLongestWaitNs = 100'000'000; // so that a request to stop is seen
constexpr std::int64_t kDripNs = 1'000'000;
constexpr int kMessagesATurn = 64; // then input is looked at again

class Server {
public:
  Server(DeviceModel& device, Port& port, FaultPlan& faults, bool waits_for_host)
      : device_(device), port_(port), faults_(faults), waits_for_host_(waits_for_host), start_(machine_moment().monotonic_ns) {}

  Result<ServeCounts> run(const std::function<bool()>& stop) {
    SCANSION_TRY(port_.plug());
    is_plugged_ = true;
    device_.power_up(0);
    while (!stop()) {
      SCANSION_TRY(change());
      if (is_plugged_) {
        take_input();
        give_output();
      }
      wait();
    }
    return counts_;
  }

private:
  [[nodiscard]] std::int64_t now() const noexcept { return machine_moment().monotonic_ns - start_; }

  Result<void> change() {
    FaultPlan::Change change;
    while (faults_.next_change(now(), change)) {
      const std::string& kind = change.fault->kind;
      if (!FaultPlan::is_of_port(kind)) {
        SCANSION_TRY(device_.fault(*change.fault, change.starts, now()));
      } else if (kind == "unplug") {
        SCANSION_TRY(plug(!change.starts, change.fault->value("power", 0.0) != 0.0));
      } else if (change.starts && kind == "cut") {
        pending_.clear();
        port_.cut();
      } else if (change.starts && kind == "half") {
        faults_.halve_next();
      } else if (change.starts && kind == "garbage") {
        const auto bytes = faults_.garbage(*change.fault);
        pending_.insert(pending_.end(), bytes.begin(), bytes.end());
      }
    }
    return success();
  }

  Result<void> plug(bool in, bool keeps_power) {
    if (in == is_plugged_) return success();
    is_plugged_ = in;
    pending_.clear();
    if (!in) {
      port_.unplug();
      device_.disconnected(now());
      return success();
    }
    if (!keeps_power) device_.power_up(now());
    return port_.plug();
  }

  void take_input() {
    std::array<std::uint8_t, 4096> bytes{};
    for (int turn = 0; turn < kMessagesATurn; ++turn) {
      const Port::Input input = port_.input(bytes);
      switch (input.event) {
        case Port::Event::nothing: return;
        case Port::Event::bytes: device_.receive({bytes.data(), input.count}, now()); break;
        case Port::Event::connected: device_.connected(now()); break;
        case Port::Event::disconnected:
          pending_.clear();
          device_.disconnected(now());
          break;
      }
    }
  }

  /// False: the port takes no more now.
  bool flush() {
    while (!pending_.empty()) {
      std::span<const std::uint8_t> bytes(pending_);
      if (faults_.is_dripping()) {
        if (now() < next_drip_) return false;
        next_drip_ = now() + kDripNs;
        bytes = bytes.first(1);
      }
      const std::size_t put = port_.output(bytes);
      if (put == 0) return false;
      pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(put));
    }
    return true;
  }

  void give_output() {
    for (int turn = 0; turn < kMessagesATurn; ++turn) {
      const bool is_free = flush();
      if (!is_free && waits_for_host_) return;
      message_.clear();
      if (is_free && device_.drops_link()) port_.cut();
      if (!device_.send(now(), message_)) return;
      if (!is_free || faults_.is_muted()) {
        ++counts_.dropped;
        continue;
      }
      faults_.disturb(message_);
      ++counts_.messages;
      std::swap(pending_, message_);
    }
  }

  void wait() const {
    std::int64_t until = std::min(now() + kLongestWaitNs, faults_.next_at());
    const bool is_full = !pending_.empty();
    if (is_plugged_ && !(is_full && waits_for_host_)) until = std::min(until, device_.next_at());
    if (is_full && faults_.is_dripping()) until = std::min(until, next_drip_);
    const std::int64_t left = std::clamp<std::int64_t>(until - now(), 0, kLongestWaitNs);
    const timespec time{0, left};
    std::array<pollfd, 2> fds{pollfd{port_.descriptor(), POLLIN, 0}, pollfd{-1, POLLOUT, 0}};
    if (is_full && !faults_.is_dripping()) fds[1].fd = port_.stream();
    if (left > 0) ::ppoll(fds.data(), fds.size(), &time, nullptr); // interrupted or not, all is looked at again
  }

  DeviceModel& device_;
  Port& port_;
  FaultPlan& faults_;
  const bool waits_for_host_;
  const std::int64_t start_;
  bool is_plugged_ = false;
  std::vector<std::uint8_t> pending_; ///< what the port has not taken yet, one message at most
  std::vector<std::uint8_t> message_;
  std::int64_t next_drip_ = 0;
  ServeCounts counts_;
};

} // namespace

Result<ServeCounts> serve(DeviceModel& device, Port& port, FaultPlan& faults, bool waits_for_host,
                          const std::function<bool()>& stop) {
  return Server(device, port, faults, waits_for_host).run(stop);
}

} // namespace scansion
