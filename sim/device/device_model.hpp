// What a simulated device is: bytes from the host in, messages out, in a time of its own.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace scansion {

inline constexpr std::int64_t kNoTime = std::numeric_limits<std::int64_t>::max();

/// A fault that is the device's own (an alarm, a stuck pin), as asked for by --fault.
struct DeviceFault {
  std::string kind;
  std::map<std::string, double, std::less<>> values;

  [[nodiscard]] double value(std::string_view key, double standard) const {
    const auto at = values.find(key);
    return at == values.end() ? standard : at->second;
  }
};

/// Thread-bound. It reads no clock: `now_ns` is given, and only grows. Random numbers come from a seed.
class DeviceModel {
public:
  DeviceModel() = default;
  DeviceModel(const DeviceModel&) = delete;
  DeviceModel& operator=(const DeviceModel&) = delete;
  virtual ~DeviceModel() = default;

  virtual void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) = 0;
  /// One message that is due by now at the end of `out`; false: none is. A message is sent with one write. A device at
  /// maximum rate always has one while it measures; it is asked again when the host has taken the one before.
  [[nodiscard]] virtual bool send(std::int64_t now_ns, std::vector<std::uint8_t>& out) = 0;
  /// When send() has something next, as far as is known now; kNoTime: not before the host speaks.
  [[nodiscard]] virtual std::int64_t next_at() const = 0;

  /// True once when the connection ends behind the message before (a device that restarts).
  [[nodiscard]] virtual bool drops_link() { return false; }

  /// A host connected, or went away. On a serial line a device learns of neither.
  virtual void connected(std::int64_t /*now_ns*/) {}
  virtual void disconnected(std::int64_t /*now_ns*/) {}
  /// Power comes back: the device starts anew.
  virtual void power_up(std::int64_t now_ns) = 0;
  /// Fails with usage for a kind it does not know. `starts` false: the fault is over.
  [[nodiscard]] virtual Result<void> fault(const DeviceFault& fault, bool starts, std::int64_t now_ns) = 0;
};

} // namespace scansion
