// What a turning sensor above a profile would measure.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/scip/scip_scan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scansion {
namespace {

constexpr std::int32_t kNothing = 1;
constexpr std::int32_t kTooNear = 2;

/// A place as the sensor sees it: x to the side, y along its front.
struct Seen {
  double x = 0.0, y = 0.0;
};

class Sweep {
public:
  Sweep(const ScipModel& model, std::vector<ScipSample>& samples) : model_(model), samples_(samples) {
    const auto steps = static_cast<std::size_t>(model.last - model.first) + 1;
    samples_.assign(steps, {});
    Ranges none;
    none.fill(HUGE_VAL);
    ranges_.assign(steps, none);
    for (ScipSample& sample : samples_) sample.echoes[0].distance = kNothing;
  }

  void point(const Seen& at) {
    const double step = step_of(at);
    const double nearest = std::round(step);
    // Alone it is seen where its own step is hit.
    if (std::abs(step - nearest) < 1e-3) note(static_cast<std::int32_t>(nearest), std::hypot(at.x, at.y));
  }

  void segment(const Seen& a, const Seen& b) {
    const double from = step_of(a);
    const double to = step_of(b);
    if (std::abs(from - to) > model_.steps_a_turn / 2.0) return; // behind the sensor
    const auto low = static_cast<std::int32_t>(std::ceil(std::min(from, to) - 1e-9));
    const auto high = static_cast<std::int32_t>(std::floor(std::max(from, to) + 1e-9));
    for (std::int32_t step = std::max(low, model_.first); step <= std::min(high, model_.last); ++step) {
      const double angle = angle_of(step);
      const double ray_x = std::sin(angle);
      const double ray_y = std::cos(angle);
      const double across = (b.x - a.x) * ray_y - (b.y - a.y) * ray_x;
      if (across == 0.0) continue; // seen edge-on
      note(step, (a.y * (b.x - a.x) - a.x * (b.y - a.y)) / across);
    }
  }

private:
  [[nodiscard]] double angle_of(std::int32_t step) const noexcept {
    return 2.0 * std::numbers::pi * (step - model_.front) / model_.steps_a_turn;
  }
  [[nodiscard]] double step_of(const Seen& at) const noexcept {
    return std::atan2(at.x, at.y) / (2.0 * std::numbers::pi) * model_.steps_a_turn + model_.front;
  }

  void note(std::int32_t step, double range) {
    if (step < model_.first || step > model_.last || !(range > 0.0)) return;
    const auto i = static_cast<std::size_t>(step - model_.first);
    Ranges& ranges = ranges_[i];
    std::size_t at = 0;
    while (at < ranges.size() && range >= ranges[at] + kEchoesApartMm) ++at;
    if (at == ranges.size()) return;
    if (range <= ranges[at] - kEchoesApartMm)
      std::move_backward(ranges.begin() + static_cast<std::ptrdiff_t>(at), ranges.end() - 1, ranges.end());
    else if (range >= ranges[at])
      return; // part of that echo
    ranges[at] = range;
    ScipSample& sample = samples_[i];
    sample.count = 0;
    for (const double one : ranges) {
      if (one == HUGE_VAL) break;
      sample.echoes[sample.count] = echo_at(one, sample.count);
      ++sample.count;
    }
  }

  /// The `behind`th surface of a ray gets what those before it let through.
  [[nodiscard]] ScipEcho echo_at(double range, std::size_t behind) const noexcept {
    const double whole = std::round(range);
    if (whole > model_.distance_max) return {kNothing, 0};
    if (whole < model_.distance_min) return {kTooNear, 0};
    const double light = 4e6 / (range + 1000.0) / static_cast<double>(behind + 1);
    return {static_cast<std::int32_t>(whole), std::clamp(static_cast<std::int32_t>(light), 0, 4000)};
  }

  const ScipModel& model_;
  std::vector<ScipSample>& samples_;
  using Ranges = std::array<double, ScipSample::kMostEchoes>;
  std::vector<Ranges> ranges_; ///< mm, of every step's ray, the nearest first
};

} // namespace

void scip_scan(const PlayedLine& line, const LineSource& source, const ScipModel& model, const ScipPlace& place,
               std::vector<ScipSample>& samples) {
  Sweep sweep(model, samples);
  Seen before;
  bool has_before = false;
  for (const PlayedPoint& point : line) {
    const Seen seen{source.along(point) - place.along, place.height - point.z};
    if (has_before && !point.starts_run) sweep.segment(before, seen);
    sweep.point(seen);
    before = seen;
    has_before = true;
  }
}

} // namespace scansion
