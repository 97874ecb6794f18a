// Wall intervals, grown with hysteresis, and the plateaus beside them.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/steps.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scansion {

namespace {

constexpr double kWallSlope = 2.7474774194546; // tan 70
constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr std::uint32_t kMostIntervals = 6; // a longer wall is sampled well enough to be ranked
constexpr std::uint32_t kLineEnd = 3;       // samples at the end of a run that show no feature

struct WallTest {
  double strong, weak, noise;
  explicit WallTest(const FitScale& scale)
      : strong(std::max(8.0 * scale.noise, 0.09)), weak(std::max(8.0 * scale.noise, 0.05)), noise(4.0 * scale.noise) {}

  [[nodiscard]] bool seed(const Heights& h, std::uint32_t k, std::uint32_t begin, std::uint32_t end) const noexcept {
    const double dw = std::abs(h.w[k + 1] - h.w[k]);
    if (dw <= weak) return false;
    const double ds = h.s[k + 1] - h.s[k];
    if (dw > kWallSlope * ds && dw > strong) return true;
    if (dw <= 0.7 * ds || k < begin + 1 || k + 2 >= end) return false;
    return std::abs(h.w[k] - h.w[k - 1]) < 0.35 * dw && std::abs(h.w[k + 2] - h.w[k + 1]) < 0.35 * dw;
  }
  [[nodiscard]] bool grows(const Heights& h, std::uint32_t k, bool rising) const noexcept {
    const double dw = h.w[k + 1] - h.w[k];
    const double size = rising ? dw : -dw;
    return size > 0.5 * kWallSlope * (h.s[k + 1] - h.s[k]) && size > noise;
  }
};

// The straight line through some samples; level when there are too few for a slope.
struct Straight {
  double s = 0.0, w = 0.0, slope = 0.0;
  std::uint32_t samples = 0;
  [[nodiscard]] double at(double place) const noexcept { return w + slope * (place - s); }
};

Straight fit(const Heights& h, std::uint32_t first, std::uint32_t last) noexcept {
  Straight line;
  double uu = 0.0, uv = 0.0;
  for (std::uint32_t k = first; k < last; ++k) {
    line.s += h.s[k];
    line.w += h.w[k];
    ++line.samples;
  }
  if (line.samples == 0) return line;
  line.s /= line.samples;
  line.w /= line.samples;
  for (std::uint32_t k = first; k < last; ++k) {
    uu += (h.s[k] - line.s) * (h.s[k] - line.s);
    uv += (h.s[k] - line.s) * (h.w[k] - line.w);
  }
  if (line.samples >= 3 && uu > 0.0) line.slope = uv / uu;
  return line;
}

} // namespace

void StepFinder::find_walls(const Heights& h, std::uint32_t begin, std::uint32_t end, const FitScale& scale,
                            std::vector<WallRun>& walls) const {
  const WallTest test(scale);
  const std::size_t known = walls.size();
  for (std::uint32_t k = begin; k + 1 < end; ++k) {
    if (!test.seed(h, k, begin, end)) continue;
    const bool rising = h.w[k + 1] > h.w[k];
    WallRun wall{k, k + 1, false};
    const std::uint32_t floor = walls.size() > known ? walls.back().last : begin;
    while (wall.first > floor && test.grows(h, wall.first - 1, rising)) --wall.first;
    while (wall.last + 1 < end && test.grows(h, wall.last, rising)) ++wall.last;
    walls.push_back(wall);
    k = wall.last - 1;
  }
}

void StepFinder::measure(const Heights& h, const WallRun& wall, std::uint32_t low, std::uint32_t high, const FitScale& scale,
                         std::vector<FeaturePoint>& out) const {
  const std::uint32_t n = scale.least_window;
  const std::uint32_t l = wall.first - low > n ? wall.first - n : low;
  const std::uint32_t r = std::min(high, wall.last + 1 + n);
  Straight before = fit(h, l, wall.first), after = fit(h, wall.last + 1, r);
  if (before.samples == 0) before = {h.s[wall.first], h.w[wall.first], 0.0, 0};
  if (after.samples == 0) after = {h.s[wall.last], h.w[wall.last], 0.0, 0};
  const double middle = 0.5 * (h.s[wall.first] + h.s[wall.last]);
  const double height = std::abs(after.at(middle) - before.at(middle));
  const double off = std::max({4.0 * scale.noise, 0.05 * height, 0.015});
  // Samples of the wall itself: the inner ones, and an end that is off its plateau.
  const std::uint32_t a = std::abs(h.w[wall.first] - before.at(h.s[wall.first])) > off ? wall.first : wall.first + 1;
  const std::uint32_t b = std::abs(h.w[wall.last] - after.at(h.s[wall.last])) > off ? wall.last + 1 : wall.last;
  const std::uint32_t edge_before = a == wall.first && wall.first > low ? a - 1 : a > 0 ? a - 1 : a;
  const std::uint32_t edge_after = b < h.size() ? b : b - 1;
  double s_before = 0.5 * (h.s[edge_before] + h.s[edge_after]), s_after = s_before;
  double slope = std::copysign(1e3, after.at(middle) - before.at(middle));
  if (b >= a + 2) {
    const Straight line = fit(h, a, b);
    const double steep = line.samples >= 3 ? line.slope : (h.w[b - 1] - h.w[a]) / (h.s[b - 1] - h.s[a]);
    const auto meet = [&](const Straight& plateau) {
      return line.s + (plateau.at(line.s) - line.w) / (steep - plateau.slope);
    };
    slope = steep;
    s_before = std::clamp(meet(before), h.s[edge_before], h.s[edge_after]);
    s_after = std::clamp(meet(after), s_before, h.s[edge_after]);
  }
  FeaturePoint first, second;
  first.s = s_before;
  first.w = before.at(s_before);
  second.s = s_after;
  second.w = after.at(s_after);
  first.k = edge_before;
  second.k = edge_after;
  first.theta_before = std::atan(before.slope) * kDegrees;
  second.theta_after = std::atan(after.slope) * kDegrees;
  first.theta_after = second.theta_before = std::atan(slope) * kDegrees;
  for (FeaturePoint* p : {&first, &second}) {
    p->tau = p->theta_after - p->theta_before;
    p->sigma_tau = std::max(0.5, scale.noise / height * kDegrees);
    p->sharpness = 6.0;
    p->sigma_s = 0.5 * scale.pitch;
    p->step = true;
    p->element = p->tau < 0.0 ? ShapeElement::step_top : ShapeElement::step_bottom;
    p->type = p->tau < 0.0 ? FeatureType::step_top : FeatureType::step_bottom;
  }
  first.partner = static_cast<std::int32_t>(out.size()) + 1;
  second.partner = static_cast<std::int32_t>(out.size());
  out.push_back(first);
  out.push_back(second);
}

void StepFinder::find(const Heights& heights, std::uint32_t begin, std::uint32_t end, const FitScale& scale,
                      std::vector<FeaturePoint>& out, std::vector<WallRun>& walls) {
  const std::size_t known = walls.size();
  find_walls(heights, begin, end, scale, walls);
  for (std::size_t i = known; i < walls.size(); ++i) {
    WallRun& wall = walls[i];
    if (wall.last - wall.first > kMostIntervals) continue;
    if (wall.first < begin + kLineEnd || wall.last + kLineEnd >= end) continue;
    const std::uint32_t low = i > known ? walls[i - 1].last + 1 : begin;
    const std::uint32_t high = i + 1 < walls.size() ? walls[i + 1].first : end;
    wall.step = true;
    measure(heights, wall, std::min(low, wall.first), std::max(high, wall.last + 1), scale, out);
  }
}

} // namespace scansion
