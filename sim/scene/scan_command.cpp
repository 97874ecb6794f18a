// The scansim command line that makes a scan again.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/scan_command.hpp"

#include <array>
#include <charconv>

namespace scansion {

std::string shortest(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end.ptr};
}

std::string scan_command(const Scene& scene, const ScanPlan& plan) {
  std::string command = "scansim scene " + scene.name;
  const auto option = [&](const char* name, const std::string& value) {
    command.append(" ").append(name).append(" ").append(value);
  };
  if (plan.lines) option("--lines", std::to_string(*plan.lines));
  if (plan.points) option("--points", std::to_string(*plan.points));
  if (plan.pitch_mm) option("--pitch", shortest(*plan.pitch_mm));
  if (plan.spacing_mm) option("--spacing", shortest(*plan.spacing_mm));
  if (plan.direction_deg != 0.0) option("--direction", shortest(plan.direction_deg));
  if (plan.tilt_deg != 0.0) option("--tilt", shortest(plan.tilt_deg));
  option("--seed", std::to_string(plan.seed));
  option("--noise", shortest(plan.noise_um.value_or(scene.noise_um)));
  if (plan.correlated_mm != 0.0) option("--correlated", shortest(plan.correlated_mm));
  if (plan.jitter != 0.0) option("--jitter", shortest(plan.jitter));
  if (plan.outliers != 0.0) option("--outliers", shortest(plan.outliers));
  if (plan.dropouts != 0.0) option("--dropouts", shortest(plan.dropouts));
  if (plan.missing_lines != 0.0) option("--missing-lines", shortest(plan.missing_lines));
  if (plan.zigzag) command += " --zigzag";
  if (plan.backlash_um != 0.0) option("--backlash", shortest(plan.backlash_um));
  return command;
}

std::string scan_header(const Scene& scene, const ScanPlan& plan, const ScanGeometry& geometry) {
  std::string header = "# " + scan_command(scene, plan) + "\n# " + scene.summary + "\n# unit mm; ";
  header += std::to_string(geometry.lines) + " lines, " + std::to_string(geometry.samples) + " samples, pitch ";
  header +=
      shortest(geometry.pitch / 1000.0) + ", spacing " + shortest(geometry.spacing / 1000.0) + "; one block a line, x y z\n";
  return header;
}

} // namespace scansion
