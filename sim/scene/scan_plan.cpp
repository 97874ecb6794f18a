// How a scene is scanned: checks and geometry.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/scan_plan.hpp"

#include "pipeline/model/scan_line.hpp"
#include "sim/scene/scan_command.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace scansion {
namespace {

constexpr double kUm = 1000.0;          // per mm
constexpr double kLargestScan = 1000.0; // mm, length of a line and of the way across all lines
constexpr std::uint32_t kMaxLines = 10'000'000;
constexpr std::uint64_t kMaxSamples = 100'000'000'000; // keeps samples times weight below 2^63
constexpr double kSmallestWholeStep = 40.0;            // um; a finer step is not rounded, or it would miss the part's far end
constexpr double kWeight = 1e6;                        // of a line that spans the whole window

/// Fails unless low <= value <= high; NaN fails.
Result<void> within(const char* option, double value, double low, double high, const char* unit) {
  if (value >= low && value <= high) return success();
  return fail(Errc::usage, option, " ", shortest(value), " is outside ", shortest(low), " to ", shortest(high), unit);
}

Result<void> check_options(const ScanPlan& plan) {
  SCANSION_TRY(within("--direction", plan.direction_deg, -360.0, 360.0, " degrees"));
  SCANSION_TRY(within("--tilt", plan.tilt_deg, -45.0, 45.0, " degrees"));
  SCANSION_TRY(within("--noise", plan.noise_um.value_or(0.0), 0.0, 10000.0, " micrometres"));
  SCANSION_TRY(within("--correlated", plan.correlated_mm, 0.0, kLargestScan, " mm"));
  SCANSION_TRY(within("--jitter", plan.jitter, 0.0, 1.0, ""));
  SCANSION_TRY(within("--outliers", plan.outliers, 0.0, 1.0, ""));
  SCANSION_TRY(within("--dropouts", plan.dropouts, 0.0, 1.0, ""));
  SCANSION_TRY(within("--missing-lines", plan.missing_lines, 0.0, 1.0, ""));
  SCANSION_TRY(within("--backlash", plan.backlash_um, -10000.0, 10000.0, " micrometres"));
  if (plan.backlash_um != 0.0 && !plan.zigzag) return fail(Errc::usage, "--backlash shows in zigzag scans only; add --zigzag");
  if (plan.pitch_mm) {
    SCANSION_TRY(within("--pitch", *plan.pitch_mm, 1e-6, kLargestScan, " mm"));
  }
  if (plan.spacing_mm) {
    SCANSION_TRY(within("--spacing", *plan.spacing_mm, 1e-6, kLargestScan, " mm"));
  }
  if (plan.lines) {
    SCANSION_TRY(within("--lines", *plan.lines, 1.0, kMaxLines, ""));
  }
  if (plan.points) {
    SCANSION_TRY(within("--points", *plan.points, 1.0, kMaxLinePoints, ""));
  }
  return success();
}

struct Sampling {
  std::uint32_t count = 0;
  double step = 0.0; // um
};

/// Samples over `length` um: a count, a step, both or neither may be given; `default_step` stands in.
Result<Sampling> sample(double length, std::optional<std::uint32_t> count, std::optional<double> step_mm, double default_step,
                        double most, const char* count_option, const char* step_option) {
  Sampling sampling;
  if (count) {
    sampling.step = length / *count;
    if (sampling.step >= kSmallestWholeStep) sampling.step = std::floor(sampling.step + 1e-6);
  } else {
    sampling.step = default_step;
  }
  if (step_mm) sampling.step = *step_mm * kUm;
  const double wanted = count ? static_cast<double>(*count) : std::fmax(1.0, std::floor(length / sampling.step + 1e-6));
  if (wanted > most && count) {
    return fail(Errc::usage, count_option, " ", shortest(wanted), " is more than this scene's ", shortest(most),
                "; ask for fewer");
  }
  if (wanted > most) {
    return fail(Errc::usage, step_option, " ", shortest(sampling.step / kUm), " asks for ", shortest(wanted), " of at most ",
                shortest(most), "; take a longer one or set ", count_option);
  }
  if (wanted * sampling.step > kLargestScan * kUm) {
    return fail(Errc::usage, count_option, " ", shortest(wanted), " at ", step_option, " ", shortest(sampling.step / kUm),
                " mm make ", shortest(wanted * sampling.step / kUm), " mm; at most ", shortest(kLargestScan),
                " mm are possible");
  }
  sampling.count = static_cast<std::uint32_t>(wanted);
  return sampling;
}

/// A length in whole micrometres, also when the decimal in the scene is not exact as a double.
double whole_um(double mm) noexcept {
  return static_cast<double>(round_half_up(mm * kUm));
}

} // namespace

std::uint64_t line_weight(const Scene& scene, std::uint32_t line, std::uint32_t lines) noexcept {
  if (scene.span == nullptr) return 1;
  const double t = (static_cast<double>(line) + 0.5) / static_cast<double>(lines);
  return static_cast<std::uint64_t>(round_half_up(scene.span(t).length * kWeight));
}

Result<ScanGeometry> plan_scan(const Scene& scene, const ScanPlan& plan) {
  SCANSION_TRY(check_options(plan));
  ScanGeometry geometry;
  geometry.direction = portable_sincos_degrees(plan.direction_deg);
  geometry.tilt = portable_sincos_degrees(plan.tilt_deg);
  geometry.noise = plan.noise_um.value_or(scene.noise_um);
  geometry.centre_x = whole_um(scene.length_x / 2.0);
  geometry.centre_y = whole_um(scene.length_y / 2.0);

  // The window that holds the part at any direction; corners beyond the part show its base.
  const double c = std::fabs(geometry.direction.cos);
  const double s = std::fabs(geometry.direction.sin);
  const double x = whole_um(scene.length_x);
  const double y = whole_um(scene.length_y);
  geometry.window = x * c + y * s;
  const double across = x * s + y * c;
  SCANSION_TRY(lines,
               sample(across, plan.lines, plan.spacing_mm, std::floor(y / scene.lines), kMaxLines, "--lines", "--spacing"));
  geometry.lines = lines.count;
  geometry.spacing = lines.step;
  for (std::uint32_t line = 0; line < lines.count; ++line) geometry.weight += line_weight(scene, line, lines.count);

  // Lines that follow a silhouette take a share of the window; the longest are well below twice the mean.
  const bool silhouette = scene.span != nullptr;
  const double share = silhouette ? static_cast<double>(geometry.weight) / (kWeight * lines.count) : 1.0;
  SCANSION_TRY(along, sample(geometry.window * share, plan.points, plan.pitch_mm, std::floor(x / scene.points),
                             silhouette ? kMaxLinePoints / 2.0 : kMaxLinePoints, "--points", "--pitch"));
  geometry.points = along.count;
  geometry.pitch = along.step;
  geometry.samples = std::uint64_t{lines.count} * along.count;
  if (scene.total_points && !plan.points && !plan.pitch_mm && s == 0.0) {
    geometry.samples = std::max<std::uint64_t>(1, *scene.total_points * lines.count / scene.lines);
  }
  if (geometry.samples > kMaxSamples) {
    return fail(Errc::usage, "--lines ", std::to_string(geometry.lines), " of ", std::to_string(geometry.points),
                " points each are more than ", std::to_string(kMaxSamples), " points; ask for fewer");
  }
  return geometry;
}

} // namespace scansion
