// Scans a scene line by line.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/scanner.hpp"

#include "sim/scene/portable_math.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scansion {
namespace {

// Streams of random numbers of a line.
enum Purpose : std::uint64_t { kLoss, kDropouts, kJitter, kNoise, kSpikes, kCoin };

// Along the ray of a leaning scan plane the surface is looked for at this distance in plan, mm: a tenth of the narrowest
// feature of all scenes.
constexpr double kTraceStep = 0.05;

/// First of `count` places `step` apart around `middle`; whole where the step is, so that a regular line stays regular.
double first_place(double middle, double step, std::uint64_t count) noexcept {
  const double first = middle - step * 0.5 * static_cast<double>(count - 1);
  return step == std::floor(step) ? std::floor(first + 0.5) : first;
}

std::int32_t count_of(double um) noexcept {
  return static_cast<std::int32_t>(round_half_up(um));
}

} // namespace

Result<SceneScanner> SceneScanner::create(Scene scene, const ScanPlan& plan) {
  SCANSION_TRY(geometry, plan_scan(scene, plan));
  return SceneScanner(std::move(scene), plan, geometry);
}

SceneScanner::SceneScanner(Scene scene, const ScanPlan& plan, const ScanGeometry& geometry)
    : scene_(std::move(scene)), plan_(plan), geometry_(geometry) {
  if (plan_.correlated_mm > 0.0) {
    keep_ = portable_exp_minus(geometry_.pitch / 1000.0 / plan_.correlated_mm);
    fresh_ = std::sqrt(1.0 - keep_ * keep_);
  }
}

bool SceneScanner::next(SceneLine& line) {
  if (line_ == geometry_.lines) return false;
  line.index = line_;
  line.points.clear();
  const std::uint32_t samples = samples_of_line(line_);
  line.missing = Random(plan_.seed, line_, kLoss).uniform() < plan_.missing_lines;
  ++line_;
  if (line.missing) {
    ++counts_.missing_lines;
    return true;
  }
  line.points.resize(samples);
  mark_dropouts(line.index, line.points);
  measure(line);
  if (plan_.zigzag && deceived_ && line.index % 2 == 1) std::reverse(line.points.begin(), line.points.end());
  count(line);
  return true;
}

void SceneScanner::count(const SceneLine& line) noexcept {
  std::uint64_t kept = 0;
  for (const ScenePoint& point : line.points) {
    kept += point.is_there() ? 1U : 0U;
    counts_.outliers += point.state == SampleState::outlier ? 1U : 0U;
    counts_.dropouts += point.state == SampleState::missing ? 1U : 0U;
    counts_.in_holes += point.state == SampleState::hole ? 1U : 0U;
  }
  counts_.lines += kept > 0 ? 1U : 0U;
  counts_.points += kept;
}

// Hands out all samples by weight; the remainder goes on to the next line, so the last line ends at the exact total.
std::uint32_t SceneScanner::samples_of_line(std::uint32_t index) noexcept {
  carry_ += geometry_.samples * line_weight(scene_, index, geometry_.lines);
  const std::uint64_t samples = carry_ / geometry_.weight;
  carry_ %= geometry_.weight;
  return static_cast<std::uint32_t>(samples);
}

void SceneScanner::mark_dropouts(std::uint32_t index, std::vector<ScenePoint>& points) const {
  if (plan_.dropouts <= 0.0) return;
  // Bursts last 2 to 20 samples, 11 in the mean: one burst to eleven single dropouts makes both halves of the share.
  constexpr double kMeanBurst = 11.0;
  Random random(plan_.seed, index, kDropouts);
  const double burst = plan_.dropouts / (2.0 * kMeanBurst - (kMeanBurst - 1.0) * plan_.dropouts);
  const double single = burst * kMeanBurst;
  std::size_t at = 0;
  while (at < points.size()) {
    const double draw = random.uniform();
    std::size_t lost = 0;
    if (draw < burst) {
      lost = 2 + random.below(19);
    } else if (draw < burst + single) {
      lost = 1;
    }
    const std::size_t end = std::min(points.size(), at + lost);
    for (std::size_t k = at; k < end; ++k) points[k].state = SampleState::missing;
    at = lost == 0 ? at + 1 : end;
  }
}

void SceneScanner::measure(SceneLine& line) const {
  Random jitter(plan_.seed, line.index, kJitter);
  Random noise(plan_.seed, line.index, kNoise);
  Random spikes(plan_.seed, line.index, kSpikes);
  Random coin(plan_.seed, line.index, kCoin);
  const auto count = static_cast<std::uint32_t>(line.points.size());
  if (count == 0) return;
  double middle = 0.0;
  if (scene_.span != nullptr) {
    const double t = (static_cast<double>(line.index) + 0.5) / static_cast<double>(geometry_.lines);
    middle = scene_.span(t).centre * geometry_.window;
  }
  const double first = first_place(middle, geometry_.pitch, count);
  const double t = first_place(0.0, geometry_.spacing, geometry_.lines) + geometry_.spacing * static_cast<double>(line.index);
  // The machine counts to the same places on its way back, but the carriage is not there yet.
  const double late = line.index % 2 == 1 ? plan_.backlash_um : 0.0;
  double drift = geometry_.noise > 0.0 ? noise.normal() : 0.0;
  for (std::uint32_t k = 0; k < count; ++k) {
    // Every stream moves on at every sample, so a fault switched on changes nothing else.
    double s = first + geometry_.pitch * static_cast<double>(k);
    if (plan_.jitter > 0.0) s += plan_.jitter * geometry_.pitch * (jitter.uniform() - 0.5);
    if (geometry_.noise > 0.0) drift = keep_ * drift + fresh_ * noise.normal();
    double disturbance = geometry_.noise * drift + texture(k, coin);
    bool spike = false;
    if (plan_.outliers > 0.0) {
      const double size = 300.0 + 4700.0 * spikes.uniform();
      const double side = spikes.uniform() < 0.5 ? -1.0 : 1.0;
      spike = spikes.uniform() < plan_.outliers;
      if (spike) disturbance += side * size;
    }
    ScenePoint& point = line.points[k];
    if (point.state == SampleState::missing) continue;
    point = place(s - late, t, disturbance);
    if (late != 0.0 && deceived_) move_along(point, late);
    if (spike && point.is_there()) point.state = SampleState::outlier;
  }
}

double SceneScanner::texture(std::uint32_t sample, Random& coin) const noexcept {
  switch (scene_.texture) {
    case Texture::none: return 0.0;
    case Texture::zigzag: return sample % 2 == 1 ? scene_.texture_um : 0.0;
    case Texture::two_step: return coin.next() >> 63U != 0 ? scene_.texture_um : 0.0;
  }
  return 0.0;
}

/// The point at `s` along line and `t` across lines (um from the middle); `disturbance` um along the plane's height direction.
ScenePoint SceneScanner::place(double s, double t, double disturbance) const noexcept {
  const SinCos& turn = geometry_.direction;
  double x = geometry_.centre_x + s * turn.cos - t * turn.sin;
  double y = geometry_.centre_y + s * turn.sin + t * turn.cos;
  ScenePoint point;
  if (geometry_.tilt.sin == 0.0) {
    if (scene_.hole_at(x / 1000.0, y / 1000.0)) point.state = SampleState::hole;
    point.z = count_of(scene_.height(x / 1000.0, y / 1000.0) * 1000.0 + disturbance);
  } else {
    const double seen = trace(x / 1000.0, y / 1000.0) * 1000.0;
    if (scene_.hole_at((x - seen * geometry_.tilt.sin * turn.sin) / 1000.0,
                       (y + seen * geometry_.tilt.sin * turn.cos) / 1000.0))
      point.state = SampleState::hole;
    const double h = seen + disturbance;
    x -= h * geometry_.tilt.sin * turn.sin;
    y += h * geometry_.tilt.sin * turn.cos;
    point.z = count_of(h * geometry_.tilt.cos);
  }
  point.x = count_of(x);
  point.y = count_of(y);
  return point;
}

void SceneScanner::move_along(ScenePoint& point, double um) const noexcept {
  point.x = count_of(point.x + um * geometry_.direction.cos);
  point.y = count_of(point.y + um * geometry_.direction.sin);
}

/// Where the ray that comes down the leaning plane above (x, y) first meets the part, mm along the plane from z = 0; at a
/// vertical wall that is a point of the wall.
double SceneScanner::trace(double x, double y) const noexcept {
  const double dx = -geometry_.tilt.sin * geometry_.direction.sin;
  const double dy = geometry_.tilt.sin * geometry_.direction.cos;
  // h where the ray passes a given relief; the incline's slope is far below that of the ray.
  const double rise = geometry_.tilt.cos - scene_.base.incline(dx, dy);
  const double ground = scene_.base.incline(x, y);
  const auto above = [&](double h) { return h * geometry_.tilt.cos - scene_.height(x + h * dx, y + h * dy); };
  const double step = kTraceStep / std::fabs(geometry_.tilt.sin);
  const double end = (ground + scene_.relief_low) / rise;
  double high = (ground + scene_.relief_high) / rise;
  double low = high;
  while (low > end && above(low) > 0.0) {
    high = low;
    low = std::max(end, low - step);
  }
  while (high - low > 1e-7) { // a ten-thousandth of the lattice
    const double middle = 0.5 * (low + high);
    (above(middle) > 0.0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

} // namespace scansion
