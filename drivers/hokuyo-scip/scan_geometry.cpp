// What a sensor says about itself, and how its ranges become points of a plane.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/hokuyo-scip/scan_geometry.hpp"

#include "drivers/hokuyo-scip/scip_frame.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scansion::scip {
namespace {

constexpr std::int32_t kMostSteps = 10'000; ///< requests have four digits
constexpr std::int32_t kMostDistance = 262'143;

} // namespace

Result<Sensor> read_sensor(std::string_view pp_body) {
  Sensor out;
  struct Row {
    std::string_view key;
    std::int32_t& value;
    std::int32_t min, max;
  };
  const Row rows[] = {{"DMIN", out.distance_min, 0, kMostDistance}, {"DMAX", out.distance_max, 1, kMostDistance},
                      {"ARES", out.steps_a_turn, 1, 1'000'000},     {"AMIN", out.first, 0, kMostSteps - 1},
                      {"AMAX", out.last, 0, kMostSteps - 1},        {"AFRT", out.front, 0, kMostSteps - 1},
                      {"SCAN", out.turns_a_minute, 1, 1'000'000}};
  for (const Row& row : rows) {
    const auto value = find_number(pp_body, row.key);
    if (!value || *value < row.min || *value > row.max) {
      return fail(Errc::undecodable, "the sensor's answer to PP has no sound ", row.key);
    }
    row.value = *value;
  }
  if (out.last < out.first || out.distance_max < out.distance_min) {
    return fail(Errc::undecodable, "the sensor's answer to PP contradicts itself");
  }
  out.model = find_key(pp_body, "MODL").value_or("");
  return out;
}

ScanGeometry::ScanGeometry(const Sensor& sensor, const ScanPlan& plan) {
  directions_.resize(static_cast<std::size_t>(plan.values()));
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    const std::int32_t first = plan.start + static_cast<std::int32_t>(i) * plan.cluster;
    const std::int32_t last = std::min(first + plan.cluster - 1, plan.end);
    // Which step of a cluster was the nearest is not told: its middle.
    const double step = (first + last) / 2.0;
    const double angle = 2.0 * std::numbers::pi * (step - sensor.front) / sensor.steps_a_turn;
    directions_[i] = {kCountsPerMm * std::sin(angle), -kCountsPerMm * std::cos(angle)};
  }
}

std::array<std::int32_t, 2> ScanGeometry::point(std::size_t number, std::int32_t distance) const noexcept {
  const auto& direction = directions_[number];
  return {static_cast<std::int32_t>(std::lround(direction[0] * distance)),
          static_cast<std::int32_t>(std::lround(direction[1] * distance))};
}

Lattice ScanGeometry::lattice(double height_mm) noexcept {
  Lattice out;
  out.resolution = {1, kCountsPerMm};
  out.origin[2] = std::llround(height_mm * kCountsPerMm);
  return out;
}

} // namespace scansion::scip
