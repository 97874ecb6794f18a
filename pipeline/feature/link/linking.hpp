// Whether a point continues a track, and how well: the three similarities and the cone of influence.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/link/track.hpp"
#include "pipeline/feature/profile/sampling.hpp"
#include "pipeline/feature/settings.hpp"

#include <cmath>
#include <optional>

namespace scansion {

/// Where a track is expected at r, and how far from there a point may be; mm.
struct Expectation {
  double q = 0.0, w = 0.0, gate_q = 0.0, gate_w = 0.0;
};

// Of a gate along q, what does not grow with the way: steps of the sampling, and sigmas of the last point's place.
inline constexpr double kGateSteps = 0.6, kGateSigmas = 2.0;

/// `pitch` is the sampling step along q.
[[nodiscard]] inline Expectation expect(const Axis& axis, double r, double pitch, double noise, double sigma_q) noexcept {
  const double dr = r - axis.r, way = std::abs(dr);
  Expectation e;
  e.q = axis.q + axis.slope_q * dr;
  e.w = axis.w + axis.slope_w * dr;
  e.gate_q = way * axis.widening + kGateSteps * pitch + kGateSigmas * sigma_q;
  e.gate_w = 1.2 * way + 6.0 * noise + 0.4 * pitch;
  return e;
}

/// The cost of continuing `track` with `point` at place q; empty: it does not. Below kMostCost.
[[nodiscard]] std::optional<double> link_cost(const Track& track, const FeaturePoint& last, const Expectation& expected,
                                              const FeaturePoint& point, double q, double w, Linking linking) noexcept;
inline constexpr double kMostCost = 2.6;

} // namespace scansion
