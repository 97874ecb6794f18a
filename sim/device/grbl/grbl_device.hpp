// The simulated controller as a device on a port: its time, its messages, its faults.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/device/device_model.hpp"
#include "sim/device/grbl/firmware.hpp"

namespace scansion::sim::grbl {

struct GrblPlan {
  double speed = 1.0; ///< of the controller's time against the clock; at_maximum: as fast as can be
  bool at_maximum = false;
  bool keeps_power = false;    ///< has its own supply: pulling the cable does not start it anew
  bool resets_on_open = false; ///< as boards do whose reset hangs on DTR; seen on TCP only, a pty tells nothing
};

/// Faults: alarm (number=N), no_contact, stuck_pin, banner (the controller starts anew), no_ok (count=N replies are lost),
/// hold and door (pressed when the fault begins, released when it ends).
class GrblDevice final : public DeviceModel {
public:
  GrblDevice(FirmwareOptions options, Settings settings, GrblPlan plan)
      : firmware_(std::move(options), std::move(settings)), plan_(plan) {}

  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  bool send(std::int64_t now_ns, std::vector<std::uint8_t>& out) override;
  std::int64_t next_at() const override;
  void connected(std::int64_t now_ns) override;
  void power_up(std::int64_t now_ns) override;
  Result<void> fault(const DeviceFault& fault, bool starts, std::int64_t now_ns) override;

private:
  /// Lets the controller go on to the moment that is `now_ns` for it.
  void go_to(std::int64_t now_ns);
  void press(std::uint8_t key) { firmware_.receive({&key, 1}, time_); }

  Firmware firmware_;
  const GrblPlan plan_;
  Ns time_ = 0; ///< the controller's
  bool is_powered_ = false;
};

} // namespace scansion::sim::grbl
