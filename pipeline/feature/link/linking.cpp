// Costs of links.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/link/linking.hpp"

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

std::optional<double> link_cost(const Track& track, const FeaturePoint& last, const Expectation& expected,
                                const FeaturePoint& point, double q, double w, Linking linking) noexcept {
  const double off_q = q - expected.q, off_w = w - expected.w;
  if (std::abs(off_q) > expected.gate_q || std::abs(off_w) > expected.gate_w) return std::nullopt;
  if (point.convex() != track.convex()) return std::nullopt;
  double cost = square(off_q / expected.gate_q) + square(off_w / expected.gate_w);
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
