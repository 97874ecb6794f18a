// The simulated controller as a device on a port.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/grbl/grbl_device.hpp"

#include <cmath>
#include <utility>

namespace scansion::sim::grbl {

void GrblDevice::go_to(std::int64_t now_ns) {
  if (plan_.at_maximum) {
    // Whatever the controller waits for happens at once; only the host can be waited for.
    for (Ns next = firmware_.next_event(); next != kNever; next = firmware_.next_event()) {
      time_ = std::max(time_, next);
      firmware_.run_until(time_);
    }
    firmware_.run_until(time_);
    return;
  }
  time_ = std::max(time_, static_cast<Ns>(static_cast<double>(now_ns) * plan_.speed));
  firmware_.run_until(time_);
}

void GrblDevice::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  go_to(now_ns);
  firmware_.receive(bytes, time_);
  go_to(now_ns);
}

bool GrblDevice::send(std::int64_t now_ns, std::vector<std::uint8_t>& out) {
  go_to(now_ns);
  std::string& said = firmware_.output();
  const std::size_t end = said.find('\n');
  if (end == std::string::npos) return false;
  out.insert(out.end(), said.begin(), said.begin() + static_cast<std::ptrdiff_t>(end) + 1);
  said.erase(0, end + 1);
  return true;
}

std::int64_t GrblDevice::next_at() const {
  const Ns next = firmware_.next_event();
  if (next == kNever) return kNoTime;
  return plan_.at_maximum ? 0 : static_cast<std::int64_t>(std::ceil(static_cast<double>(next) / plan_.speed));
}

void GrblDevice::connected(std::int64_t now_ns) {
  go_to(now_ns);
  if (plan_.resets_on_open) firmware_.power_on(time_);
}

void GrblDevice::power_up(std::int64_t now_ns) {
  go_to(now_ns);
  // What was said while nobody listened is lost.
  firmware_.output().clear();
  if (!std::exchange(is_powered_, true) || !plan_.keeps_power) firmware_.power_on(time_);
}

Result<void> GrblDevice::fault(const DeviceFault& fault, bool starts, std::int64_t now_ns) {
  if (is_powered_) go_to(now_ns);
  const bool now = starts && is_powered_;
  if (fault.kind == "alarm") {
    if (now) firmware_.raise_alarm(static_cast<int>(std::lround(fault.value("number", 1.0))));
  } else if (fault.kind == "no_contact") {
    firmware_.set_contact_missing(starts);
  } else if (fault.kind == "stuck_pin") {
    firmware_.set_pin_stuck(starts);
  } else if (fault.kind == "banner") {
    if (now) firmware_.power_on(time_);
  } else if (fault.kind == "no_ok") {
    if (now) firmware_.drop_replies(static_cast<std::uint32_t>(std::lround(fault.value("count", 1.0))));
  } else if (fault.kind == "hold" || fault.kind == "door") {
    constexpr std::uint8_t kDoor = 0x84;
    if (is_powered_) press(!starts ? '~' : fault.kind == "door" ? kDoor : static_cast<std::uint8_t>('!'));
  } else {
    return fail(Errc::usage, "grbl: unknown fault \"", fault.kind,
                "\"; its own are alarm, no_contact, stuck_pin, banner, no_ok, hold, door");
  }
  return success();
}

} // namespace scansion::sim::grbl
