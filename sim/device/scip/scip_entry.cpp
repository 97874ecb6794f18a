// scansim scip: the entry of the simulated SCIP 2 line scanner.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/scip/scip_entry.hpp"

#include "sim/device/scip/scip_device.hpp"

#include <CLI/CLI.hpp>

namespace scansion {
namespace {

/// On the network stands the sensor's Ethernet version.
constexpr std::string_view kSerialModel = "UTM-30LX", kNetworkModel = "UTM-30LX-EW";

Result<ScipModel> find_model(std::string_view name) {
  const ScipModel models[] = {
      {std::string(kSerialModel), 23, 60000, 1440, 0, 1080, 540, 2400, false},
      {std::string(kNetworkModel), 23, 60000, 1440, 0, 1080, 540, 2400, true},
      {"UST-20LX", 20, 60000, 1440, 0, 1080, 540, 2400, false},
      {"URG-04LX", 20, 5600, 1024, 44, 725, 384, 600, false},
  };
  for (const ScipModel& model : models) {
    if (model.name == name) return model;
  }
  return fail(Errc::usage, "--model ", name, ": unknown; there are UTM-30LX, UTM-30LX-EW, UST-20LX and URG-04LX");
}

struct Options {
  ScipPlan plan;
  std::string model;
};

} // namespace

SimulatedDevice scip_entry() {
  auto options = std::make_shared<Options>();
  SimulatedDevice out;
  out.name = "scip";
  out.meaning = "a Hokuyo line scanner that speaks SCIP 2";
  out.add_options = [options](CLI::App& app) {
    ScipPlan& plan = options->plan;
    app.add_option("--model", options->model,
                   "UTM-30LX (default), UTM-30LX-EW (default on TCP; with echoes), UST-20LX or URG-04LX");
    app.add_option("--standoff", plan.standoff_mm, "mm from the part's highest point to the sensor (default 300)");
    app.add_option("--clock", plan.clock_ms, "ms, the sensor's time at power-up; 16777215 is the last before it wraps");
    app.add_option("--drift", plan.drift_ppm, "ppm by which the sensor's clock is too fast");
    app.add_option("--jitter", plan.jitter_ms, "ms by which scans come late at most");
    app.add_option("--warm-up", plan.warm_up_s, "seconds in which the laser cannot be lit");
    app.add_flag("--single", plan.is_single_only, "know single scans (GD, GS, GE) only");
    app.add_option("--baud", plan.baud, "bit/s at power-up, as SS sees it (default 19200)");
    app.add_flag("--scip1", plan.starts_in_scip1, "begin in SCIP 1.1");
    app.add_flag("--streaming", plan.starts_streaming, "measure already at the start, as after a host that died");
  };
  out.make = [options](LineSource source, const DevicePlan& common) -> Result<std::unique_ptr<DeviceModel>> {
    ScipPlan plan = options->plan;
    SCANSION_TRY(model, find_model(!options->model.empty() ? options->model
                                   : common.on_network     ? kNetworkModel
                                                           : kSerialModel));
    plan.model = model;
    plan.rate = common.rate;
    plan.at_maximum = common.at_maximum;
    plan.stops_on_disconnect = common.on_network;
    plan.seed = common.seed;
    return std::unique_ptr<DeviceModel>(std::make_unique<ScipDevice>(std::move(source), std::move(plan)));
  };
  return out;
}

} // namespace scansion
