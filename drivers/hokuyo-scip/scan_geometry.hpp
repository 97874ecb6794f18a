// What a sensor says about itself, and how its ranges become points of a plane.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/lattice.hpp"

#include <array>
#include <vector>

namespace scansion::scip {

/// The reply to PP.
struct Sensor {
  std::string model;
  std::int32_t distance_min = 0, distance_max = 0; ///< mm
  std::int32_t steps_a_turn = 0;
  std::int32_t first = 0, last = 0, front = 0; ///< steps
  std::int32_t turns_a_minute = 0;
};
/// Fails with undecodable when a key is missing or a value cannot be.
[[nodiscard]] Result<Sensor> read_sensor(std::string_view pp_body);

/// Which of several echoes of a step is the point.
enum class EchoChoice : std::uint8_t { nearest, farthest, strongest };

/// What is measured.
struct ScanPlan {
  char kind = 'D'; ///< D: 3 characters, S: 2 characters, E: with intensity
  std::int32_t start = 0, end = 0, cluster = 1, skip = 0;
  bool has_echoes = false; ///< N and H commands: further echoes of a step follow its first
  bool is_polled = false;  ///< G and H commands: each scan is asked for
  EchoChoice echo = EchoChoice::nearest;

  [[nodiscard]] std::int32_t values() const noexcept { return (end - start) / cluster + 1; }
  [[nodiscard]] std::size_t width() const noexcept { return kind == 'S' ? 2 : kind == 'D' ? 3 : 6; }
  [[nodiscard]] std::int64_t period_ns(const Sensor& sensor) const noexcept {
    return 60'000'000'000 / sensor.turns_a_minute * (skip + 1);
  }
};

inline constexpr std::int32_t kCountsPerMm = 100;

/// The plane of a line: x to the left of the front direction seen from above the sensor, z against it, so that a sensor that
/// looks down sees the part with z upwards. Coordinates are counts of 0.01 mm; the sensor itself counts millimetres.
class ScanGeometry {
public:
  ScanGeometry() = default;
  ScanGeometry(const Sensor& sensor, const ScanPlan& plan);

  /// Of the sample `number`, `distance` mm away: x and z.
  [[nodiscard]] std::array<std::int32_t, 2> point(std::size_t number, std::int32_t distance) const noexcept;
  /// `height_mm`: z of the sensor.
  [[nodiscard]] static Lattice lattice(double height_mm) noexcept;

private:
  std::vector<std::array<double, 2>> directions_; ///< counts a millimetre, of each sample
};

} // namespace scansion::scip
