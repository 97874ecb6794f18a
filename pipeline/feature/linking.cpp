// Costs of links.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/linking.hpp"

#include <cmath>
#include <numbers>

namespace scansion {

namespace {

double square(double x) noexcept {
  return x * x;
}

// The paper's rules: every similarity holds or does not.
bool is_similar(const FeaturePoint& a, const FeaturePoint& b) noexcept {
  constexpr double kAngle = 15.0; // degrees
  return std::floor(a.width) == std::floor(b.width) && a.element == b.element &&
         std::abs(a.inner_angle() - b.inner_angle()) < kAngle && std::abs(a.orientation() - b.orientation()) < kAngle;
}

} // namespace

Expectation expect(const Axis& axis, double r, double pitch, double noise, double sigma_q) noexcept {
  const double dr = r - axis.r;
  Expectation e;
  e.q = axis.q + axis.slope_q * dr;
  e.w = axis.w + axis.slope_w * dr;
  e.gate_q = std::abs(dr) * axis.widening + kGateSteps * pitch + kGateSigmas * sigma_q;
  e.gate_w = 1.2 * std::abs(dr) + 6.0 * noise + 0.4 * pitch;
  return e;
}

std::optional<double> link_cost(const Track& track, const FeaturePoint& last, const Expectation& expected,
                                const FeaturePoint& point, double q, double w, Linking linking) noexcept {
  const double dq = (q - expected.q) / expected.gate_q, dw = (w - expected.w) / expected.gate_w;
  if (std::abs(dq) > 1.0 || std::abs(dw) > 1.0) return std::nullopt;
  if (point.convex() != track.convex()) return std::nullopt;
  double cost = square(dq) + square(dw);
  if (linking == Linking::paper) {
    if (!is_similar(last, point)) return std::nullopt;
    return cost;
  }
  constexpr double kTurning = 30.0, kOrientation = 30.0; // degrees
  if (last.step != point.step)
    cost += 0.5;
  else
    cost += std::min(1.5, square((point.tau - track.means.tau) / kTurning)) +
            std::min(1.0, square((point.orientation() - track.means.beta) / kOrientation));
  cost += std::min(0.7, 0.15 * square((point.width - track.means.width) * std::numbers::ln2));
  cost += 0.1 * shape_distance(last, point);
  if (cost >= kMostCost) return std::nullopt;
  return cost;
}

} // namespace scansion
