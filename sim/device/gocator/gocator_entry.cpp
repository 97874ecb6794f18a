// scansim gocator: the entry of the simulated laser profiler.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/gocator/gocator_entry.hpp"

#include "sim/device/gocator/gocator_device.hpp"

#include <CLI/CLI.hpp>

namespace scansion {

SimulatedDevice gocator_entry() {
  auto options = std::make_shared<GocatorPlan>();
  SimulatedDevice out;
  out.name = "gocator";
  out.meaning = "a running LMI Gocator laser profiler (its data channel, TCP port 3196)";
  out.add_options = [options](CLI::App& app) {
    GocatorPlan& plan = *options;
    app.add_flag("--uniform", plan.is_uniform, "profiles at even x instead of points");
    app.add_option("--x-scale", plan.x_nm, "nm a step of x (default: the finest round one that holds the scan)")
        ->check(CLI::Range(1U, 1'000'000'000U));
    app.add_option("--z-scale", plan.z_nm, "nm a step of z")->check(CLI::Range(1U, 1'000'000'000U));
    app.add_option("--encoder-step", plan.encoder_step, "encoder counts from frame to frame (default 10)");
    app.add_option("--sources", plan.sources, "profiles in each group: top, bottom, top left, top right (default 1)")
        ->check(CLI::Range(1U, 4U));
    app.add_option("--first-frame", plan.first_frame, "frame index at power-up");
  };
  out.make = [options](LineSource source, const DevicePlan& common) -> Result<std::unique_ptr<DeviceModel>> {
    if (!common.on_network)
      return fail(Errc::usage, "gocator: is on the network only; give --tcp HOST:PORT, its own port is 3196");
    GocatorPlan plan = *options;
    plan.rate = common.rate.value_or(plan.rate);
    plan.at_maximum = common.at_maximum;
    return std::unique_ptr<DeviceModel>(std::make_unique<GocatorDevice>(std::move(source), plan));
  };
  return out;
}

} // namespace scansion
