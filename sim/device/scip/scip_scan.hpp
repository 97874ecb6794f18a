// What a turning sensor above a profile would measure: a polyline seen from one place, in whole millimetres.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/player/line_source.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace scansion {

/// Facts of a sensor, as PP reports them.
struct ScipModel {
  std::string name;
  std::int32_t distance_min = 23, distance_max = 60000; ///< mm
  std::int32_t steps_a_turn = 1440;
  std::int32_t first = 0, last = 1080, front = 540; ///< steps
  std::int32_t turns_a_minute = 2400;
  bool has_echoes = false; ///< reports up to kMostEchoes surfaces behind one another
};

struct ScipEcho {
  std::int32_t distance = 0; ///< mm; below distance_min a code: 1, nothing there
  std::int32_t intensity = 0;
};

struct ScipSample {
  static constexpr std::size_t kMostEchoes = 3;
  std::array<ScipEcho, kMostEchoes> echoes{}; ///< the nearest first
  std::size_t count = 1;
};

/// The sensor hangs over the middle of the lines and looks down: its front step points to the part.
struct ScipPlace {
  double along = 0.0;  ///< mm along the lines
  double height = 0.0; ///< mm, z of the sensor
};

/// One sample for each step from model.first to model.last: the surfaces on its ray, rounded to 1 mm. What is less than
/// kEchoesApartMm behind an echo belongs to it.
inline constexpr double kEchoesApartMm = 10.0;
void scip_scan(const PlayedLine& line, const LineSource& source, const ScipModel& model, const ScipPlace& place,
               std::vector<ScipSample>& samples);

} // namespace scansion
