// Classes, type and uncertainty of a bend.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/fit/make_point.hpp"

#include <cmath>
#include <numbers>

namespace scansion {

FeaturePoint make_point(const Bend& bend, std::uint32_t k, const FitScale& scale) noexcept {
  FeaturePoint p;
  p.s = bend.s;
  p.w = bend.w;
  p.k = k;
  p.theta_before = bend.theta_before;
  p.theta_after = bend.theta_after;
  p.tau = bend.tau;
  p.sigma_tau = bend.sigma_tau;
  p.sharpness = bend.sharpness;
  p.narrow_sharpness = bend.narrow_sharpness;
  p.window = bend.window;
  const double sine = std::abs(std::sin(bend.tau * std::numbers::pi / 180.0));
  p.sigma_s = std::min(2.0 * scale.pitch, 1.5 * scale.noise / std::max(0.1, sine)) + 0.15 * scale.pitch;
  p.element = classify(p.theta_before, p.theta_after, scale.least_turning);
  p.type = p.tau < 0.0 ? FeatureType::convex : FeatureType::concave;
  if (p.element == ShapeElement::step_top) p.type = FeatureType::step_top;
  if (p.element == ShapeElement::step_bottom) p.type = FeatureType::step_bottom;
  return p;
}

bool is_part(double tau, std::uint32_t window, const FeaturePoint& coarse) noexcept {
  constexpr double kWeaker = 1.4, kWeakerThanStep = 2.5;
  if (coarse.step) return std::abs(tau) * kWeakerThanStep < std::abs(coarse.tau);
  return window < coarse.window && std::abs(tau) * kWeaker < std::abs(coarse.tau);
}

} // namespace scansion
