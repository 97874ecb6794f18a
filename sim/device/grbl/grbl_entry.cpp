// scansim grbl: options, and the device made of them.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/grbl/grbl_entry.hpp"

#include "sim/device/grbl/grbl_device.hpp"
#include "sim/device/grbl/scan_surface.hpp"

#include <CLI/CLI.hpp>

namespace scansion {
namespace {

using namespace sim::grbl;

struct GrblRequest {
  std::string dialect = "grbl";
  std::array<double, 3> at{}; ///< mm
  std::vector<std::string> settings;
  GrblPlan plan;
};

void add_options(CLI::App& command, GrblRequest& request) {
  command.add_option("--dialect", request.dialect, "grbl (1.1h) or grblhal")->check(CLI::IsMember({"grbl", "grblhal"}));
  command.add_option("--at", request.at, "X Y Z, mm: where the scan's origin lies in machine coordinates");
  command.add_option("--set", request.settings, "N=VALUE: a $ setting; may be given more than once")->delimiter('\0');
  command.add_option("--speed", request.plan.speed, "how much faster than a real one the machine lives (default 1)")
      ->check(CLI::Range(0.001, 10'000.0));
  command.add_flag("--keeps-power", request.plan.keeps_power, "an unplugged cable does not start the controller anew");
  command.add_flag("--resets-on-open", request.plan.resets_on_open, "a new connection starts the controller anew (with --tcp)");
}

Result<Settings> settings_of(const std::vector<std::string>& texts) {
  Settings out;
  for (const std::string& text : texts) {
    std::string_view rest = text;
    const auto number = take_number(rest);
    const bool has_equals = rest.starts_with('=');
    if (has_equals) rest.remove_prefix(1);
    const auto value = take_number(rest);
    if (!number || !has_equals || !value || !rest.empty() || out.set(*number, *value) != 0) {
      return fail(Errc::usage, "--set ", text, ": is no setting that Grbl takes; write N=VALUE");
    }
  }
  return out;
}

Result<std::unique_ptr<DeviceModel>> make(const GrblRequest& request, LineSource source, const DevicePlan& plan) {
  if (plan.rate) return fail(Errc::usage, "grbl: lines come when rows are probed; use --speed, or --rate max");
  SCANSION_TRY(settings, settings_of(request.settings));
  SCANSION_TRY(read, ScanSurface::read(source));
  auto surface = std::make_shared<const ScanSurface>(std::move(read));
  FirmwareOptions options;
  options.dialect = request.dialect == "grblhal" ? Dialect::grblhal : Dialect::grbl;
  options.surface = [surface, at = request.at](double x, double y) { return surface->height(x - at[0], y - at[1]) + at[2]; };
  GrblPlan grbl = request.plan;
  grbl.at_maximum = plan.at_maximum;
  return std::unique_ptr<DeviceModel>(std::make_unique<GrblDevice>(std::move(options), std::move(settings), grbl));
}

} // namespace

SimulatedDevice grbl_entry() {
  auto request = std::make_shared<GrblRequest>(); // CLI11 writes into it while parsing
  return {"grbl", "a Grbl machine with a touch probe over the part that is played",
          [request](CLI::App& command) { add_options(command, *request); },
          [request](LineSource source, const DevicePlan& plan) { return make(*request, std::move(source), plan); }};
}

} // namespace scansion
