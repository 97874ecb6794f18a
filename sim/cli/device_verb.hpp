// scansim DEVICE: a simulated device on a pseudo terminal or a TCP port.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/cli/verb.hpp"
#include "sim/device/device_model.hpp"
#include "sim/player/line_source.hpp"

#include <memory>
#include <optional>

namespace scansion {

/// What every simulated device is told.
struct DevicePlan {
  std::optional<double> rate; ///< lines per second; empty: the device's own
  bool at_maximum = false;    ///< as fast as the host takes them
  bool on_network = false;    ///< a TCP port: the device notices when its host goes
  std::uint64_t seed = 1;
};

/// One kind of device. To add one: a folder in sim/device with a function that returns this, and its line in main.cpp.
struct SimulatedDevice {
  std::string name;    ///< the verb
  std::string meaning; ///< one line for a person
  std::function<void(CLI::App&)> add_options;
  /// Called after parsing. Fails with usage.
  std::function<Result<std::unique_ptr<DeviceModel>>(LineSource source, const DevicePlan& plan)> make;
};

[[nodiscard]] Verb add_device_verb(CLI::App& app, SimulatedDevice device);

} // namespace scansion
