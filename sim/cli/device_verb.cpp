// scansim DEVICE: a simulated device on a pseudo terminal or a TCP port.
// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/device_verb.hpp"

#include "sim/cli/progress.hpp"
#include "sim/port/serve.hpp"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace scansion {
namespace {

struct DeviceRequest {
  SimulatedDevice device;
  PlayPlan play;
  std::string pty, tcp, rate;
  std::vector<std::string> faults;
};

Result<DevicePlan> device_plan(const DeviceRequest& request) {
  DevicePlan plan;
  plan.seed = request.play.plan.seed;
  plan.at_maximum = request.rate == "max";
  plan.on_network = !request.tcp.empty();
  if (request.rate.empty() || plan.at_maximum) return plan;
  double rate = 0.0;
  const char* end = request.rate.data() + request.rate.size();
  const auto [stop, error] = std::from_chars(request.rate.data(), end, rate);
  if (error != std::errc() || stop != end || !(rate >= 1e-3) || !(rate <= 1e6)) {
    return fail(Errc::usage, "--rate ", request.rate, ": is neither max nor 0.001 to 1000000 lines per second");
  }
  plan.rate = rate;
  return plan;
}

Result<void> run_device(const DeviceRequest& request) {
  if (request.pty.empty() == request.tcp.empty()) {
    return fail(Errc::usage, request.device.name, ": give one of --pty LINK and --tcp HOST:PORT");
  }
  SCANSION_TRY(plan, device_plan(request));
  std::vector<FaultSpec> specs;
  for (const std::string& text : request.faults) {
    SCANSION_TRY(spec, parse_fault(text));
    specs.push_back(std::move(spec));
  }
  SCANSION_TRY(source, LineSource::open(request.play));
  SCANSION_TRY(model, request.device.make(std::move(source), plan));
  for (const FaultSpec& spec : specs) { // a mistyped kind is not found out an hour later
    if (FaultPlan::is_of_port(spec.fault.kind)) continue;
    SCANSION_TRY(model->fault(spec.fault, false, 0));
  }
  std::unique_ptr<Port> port;
  if (request.tcp.empty()) {
    port = pty_port(request.pty);
  } else {
    SCANSION_TRY(made, tcp_port(request.tcp));
    port = std::move(made);
  }
  FaultPlan faults(std::move(specs), plan.seed);
  bool told = false;
  const auto stop = [&] {
    if (!std::exchange(told, true))
      std::fprintf(stderr, "scansim: %s on %s\n", request.device.name.c_str(), port->where().c_str());
    return stop_requested();
  };
  SCANSION_TRY(counts, serve(*model, *port, faults, plan.at_maximum, stop));
  std::fprintf(stderr, "scansim: %s: %llu messages sent, %llu dropped\n", request.device.name.c_str(),
               static_cast<unsigned long long>(counts.messages), static_cast<unsigned long long>(counts.dropped));
  return success();
}

} // namespace

Verb add_device_verb(CLI::App& app, SimulatedDevice device) {
  auto request = std::make_shared<DeviceRequest>(); // CLI11 writes into it while parsing
  request->device = std::move(device);
  CLI::App* command = app.add_subcommand(request->device.name, request->device.meaning);
  ScanPlan& plan = request->play.plan;
  command->add_option("--scan", request->play.scan, "recorded scan to play");
  command->add_option("--scene", request->play.scene, "scene to play, see `scansim scene --list`");
  command->add_option("--lines", plan.lines, "scan lines of the scene");
  command->add_option("--points", plan.points, "points a line of the scene");
  command->add_option("--noise", plan.noise_um, "um, sigma of the scene's noise");
  command->add_option("--seed", plan.seed, "seed of everything random (default 1)");
  command->add_option("--pty", request->pty, "name of the link to the pseudo terminal");
  command->add_option("--tcp", request->tcp, "HOST:PORT to listen on; port 0 takes a free one");
  command->add_option("--rate", request->rate,
                      "lines per second, or max: as fast as the host reads (default: the device's own)");
  command->add_flag("--loop", request->play.loop, "start again at the end");
  command->add_option("--fault", request->faults, "KIND[:key=value,...], see scansim(1); may be given more than once")
      ->delimiter('\0');
  request->device.add_options(*command);
  return {command, [request] { return run_device(*request); }};
}

} // namespace scansion
