// Wall intervals, grown with hysteresis, and the plateaus beside them.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/fit/steps.hpp"

#include "pipeline/feature/fit/flank.hpp"
#include "pipeline/feature/passes/passes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace scansion {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr std::uint32_t kLineEnd = 3; // samples at the end of a run that show no feature

std::uint32_t steepest_interval(const Heights& h, std::uint32_t first, std::uint32_t last) noexcept {
  std::uint32_t best = first;
  for (std::uint32_t k = first + 1; k < last; ++k)
    if (std::abs(h.w[k + 1] - h.w[k]) > std::abs(h.w[best + 1] - h.w[best])) best = k;
  return best;
}

bool is_upright(const Heights& h, std::uint32_t k, const WallTest& test) noexcept {
  const auto dw = [&](std::uint32_t i) { return i + 1 < h.size() ? h.w[i + 1] - h.w[i] : 0.0; };
  return test.is_upright(h.s[k + 1] - h.s[k], dw(k), k > 0 ? dw(k - 1) : 0.0, dw(k + 1));
}

// The slope of the wall itself.
double wall_slope(const Heights& h, std::uint32_t first, std::uint32_t last) noexcept {
  double s = 0.0, w = 0.0, uu = 0.0, uv = 0.0;
  const double n = last - first;
  for (std::uint32_t k = first; k < last; ++k) {
    s += h.s[k] / n;
    w += h.w[k] / n;
  }
  for (std::uint32_t k = first; k < last; ++k) {
    uu += (h.s[k] - s) * (h.s[k] - s);
    uv += (h.s[k] - s) * (h.w[k] - w);
  }
  return uv / uu;
}

// Whether a short wall of the run [begin, end) is but a piece of a slope.
bool is_piece(const Heights& h, std::uint32_t begin, std::uint32_t end, const WallRun& wall, const WallTest& test) noexcept {
  constexpr std::uint32_t n = WallTest::kBeside;
  const auto rise = [&](std::uint32_t from, std::uint32_t to) { return (h.w[to] - h.w[from]) / (to - from); };
  const double before = wall.first >= begin + n ? rise(wall.first - n, wall.first) : 0.0;
  const double after = wall.last + n < end ? rise(wall.last, wall.last + n) : 0.0;
  const double ds = (h.s[wall.last] - h.s[wall.first]) / (wall.last - wall.first);
  return test.is_piece(ds, rise(wall.first, wall.last), before, after);
}

// Few samples on the wall, or none where it stands upright between its roundings.
bool is_step(const Heights& h, std::uint32_t begin, std::uint32_t end, const WallRun& wall, const WallTest& test) {
  const std::uint32_t intervals = wall.last - wall.first;
  if (intervals <= kMostIntervals) return !is_piece(h, begin, end, wall, test);
  return intervals <= kMostRounded && is_upright(h, steepest_interval(h, wall.first, wall.last), test);
}

} // namespace

WallTest::WallTest(double sigma, double least_step) noexcept
    : strong(std::max(8.0 * sigma, least_step)), weak(std::max(8.0 * sigma, 5.0 / 9.0 * least_step)), noise(4.0 * sigma) {}

namespace {

// Grows walls of the run [begin, end) from intervals, in order, and adds them.
class WallGrower {
public:
  WallGrower(const Heights& h, std::uint32_t begin, std::uint32_t end, const WallTest& test,
             std::vector<WallRun>& walls) noexcept
      : h_(h), begin_(begin), end_(end), floor_(begin), test_(test), walls_(walls) {}

  // The interval behind sample k starts a wall if it is large enough, stands out, and is not part of the last one.
  void look_at(std::uint32_t k) {
    constexpr double kNone = std::numeric_limits<double>::infinity(); // the ends of a run start no wall by themselves
    if (k < floor_ || !test_.may_seed(ds(k), dw(k))) return;
    if (test_.stands_out(ds(k), dw(k), k > begin_ ? dw(k - 1) : kNone, k + 2 < end_ ? dw(k + 1) : kNone)) grow(k);
  }

private:
  [[nodiscard]] double ds(std::uint32_t k) const noexcept { return h_.s[k + 1] - h_.s[k]; }
  [[nodiscard]] double dw(std::uint32_t k) const noexcept { return h_.w[k + 1] - h_.w[k]; }
  void grow(std::uint32_t k) {
    const bool rising = dw(k) > 0.0;
    WallRun wall{k, k + 1, 0, 0, false};
    while (wall.first > floor_ && test_.grows(ds(wall.first - 1), dw(wall.first - 1), rising)) --wall.first;
    while (wall.last + 1 < end_ && test_.grows(ds(wall.last), dw(wall.last), rising)) ++wall.last;
    wall.low = wall.first;
    wall.high = floor_ = wall.last;
    wall.step = is_step(h_, begin_, end_, wall, test_) && wall.first >= begin_ + kLineEnd && wall.last + kLineEnd < end_;
    walls_.push_back(wall);
  }

  const Heights& h_;
  const std::uint32_t begin_, end_;
  std::uint32_t floor_; // the last sample of the wall before
  const WallTest& test_;
  std::vector<WallRun>& walls_;
};

} // namespace

void find_walls(const Heights& h, std::uint32_t begin, std::uint32_t end, const FitScale& scale, std::vector<WallRun>& walls) {
  constexpr std::uint32_t kBlock = 128;
  if (begin == end) return;
  const WallTest test(scale);
  WallGrower grower(h, begin, end, test, walls);
  const std::uint32_t last = end - 1;
  std::array<std::uint32_t, kBlock> high;
  for (std::uint32_t k = begin; k < last; k += kBlock) {
    const double* const w = h.w.data() + k;
    const std::size_t count = passes::apart(w + 1, w, test.weak, high.data(), std::min(kBlock, last - k));
    for (std::size_t i = 0; i < count; ++i) grower.look_at(k + high[i]);
  }
}

namespace {

// What the plateau before wall i may reach back to, and the one behind it on to.
std::uint32_t lowest(std::span<const WallRun> walls, std::size_t i, std::uint32_t begin) noexcept {
  return i > 0 ? std::min(walls[i - 1].last + 1, walls[i].first) : begin;
}
std::uint32_t highest(std::span<const WallRun> walls, std::size_t i, std::uint32_t end) noexcept {
  return i + 1 < walls.size() ? std::max(walls[i + 1].first - 1, walls[i].last) : end - 1;
}

// Leaves out the ends of the wall, and what rounds its edge.
Flank plateau(const Heights& h, std::uint32_t foot, std::uint32_t limit, const FitScale& scale) {
  if (foot == limit) return Flank{h.s[foot], h.w[foot], 0.0, 0.0, 0, 0, false};
  const std::uint32_t n = scale.least_window, from = limit < foot ? foot - 1 : foot + 1;
  Flank flank = find_flank(h, from, limit, n, scale.widest_gap, scale);
  if (is_chamfered(h, from, limit, flank, scale)) return find_flank(h, from, limit, std::min(n, flank.gap), 0, scale);
  return flank.straight || flank.gap == 0 ? flank : find_flank(h, from, limit, n, 0, scale);
}

// Samples from an edge that its rounding may be seen in: its end is seen somewhat off.
std::uint32_t reach_of(const Flank& flank) noexcept {
  return 2 * flank.gap + 3;
}

} // namespace

bool may_round_to(const Heights& h, std::uint32_t begin, std::uint32_t end, std::span<const WallRun> walls, std::size_t i,
                  const FitScale& scale, double s) {
  constexpr double kOff = 3.0; // samples from the foot of a wall to its edge at most
  const WallRun& wall = walls[i];
  const bool before = s < h.s[wall.first];
  const double off = (before ? h.s[wall.first] - s : s - h.s[wall.last]) / scale.pitch - kOff;
  if (off <= reach_of({})) return true;
  const Flank beside =
      before ? plateau(h, wall.first, lowest(walls, i, begin), scale) : plateau(h, wall.last, highest(walls, i, end), scale);
  return off <= reach_of(beside);
}

void measure_step(const Heights& h, std::uint32_t begin, std::uint32_t end, std::span<WallRun> walls, std::size_t i,
                  const FitScale& scale, std::vector<FeaturePoint>& out) {
  WallRun& wall = walls[i];
  const std::uint32_t low = lowest(walls, i, begin), high = highest(walls, i, end);
  const Flank before = plateau(h, wall.first, low, scale), after = plateau(h, wall.last, high, scale);
  const double middle = 0.5 * (h.s[wall.first] + h.s[wall.last]);
  const double height = std::abs(after.at(middle) - before.at(middle));
  const double off = std::max({4.0 * scale.noise, 0.05 * height, 0.015});
  // Samples of the wall itself: the inner ones, and an end that is off its plateau.
  const std::uint32_t a = std::abs(h.w[wall.first] - before.at(h.s[wall.first])) > off ? wall.first : wall.first + 1;
  const std::uint32_t b = std::abs(h.w[wall.last] - after.at(h.s[wall.last])) > off ? wall.last + 1 : wall.last;
  const std::uint32_t edge_before = a > 0 ? a - 1 : a;
  const auto edge_after = std::min(b, static_cast<std::uint32_t>(h.size() - 1));
  double s_before = 0.5 * (h.s[edge_before] + h.s[edge_after]), s_after = s_before;
  double slope = std::copysign(1e3, after.at(middle) - before.at(middle));
  const std::uint32_t steepest = steepest_interval(h, wall.first, wall.last);
  bool upright = b < a + 2;
  // A rounding falls by its radius where it meets an upright wall; what falls more is a slope with few samples.
  const auto rounds = [&](const Flank& flank, std::uint32_t foot, std::uint32_t flat) {
    return std::abs(h.w[foot] - flank.at(h.s[foot])) <= 1.3 * std::abs(h.s[foot] - h.s[flat]) + off;
  };
  const std::uint32_t flat_before = wall.first - std::min(wall.first, before.gap + 1);
  const std::uint32_t flat_after = std::min(wall.last + after.gap + 1, static_cast<std::uint32_t>(h.size() - 1));
  if (before.gap + after.gap > 0 && is_upright(h, steepest, WallTest(scale)) && rounds(before, steepest, flat_before) &&
      rounds(after, steepest + 1, flat_after)) {
    upright = true;
    s_before = s_after = 0.5 * (h.s[steepest] + h.s[steepest + 1]);
  } else if (b >= a + 2) {
    // The rounded ends of a wall are less steep than its middle.
    const std::uint32_t trim_a = before.gap > 0 && b - a > 3 ? a + 1 : a, trim_b = after.gap > 0 && b - a > 3 ? b - 1 : b;
    const double steep = wall_slope(h, trim_a, trim_b);
    const std::uint32_t inner = (trim_a + trim_b) / 2;
    const double s = trim_b - trim_a > 2 ? h.s[inner] : 0.5 * (h.s[trim_a] + h.s[trim_b - 1]);
    const double w = trim_b - trim_a > 2 ? h.w[inner] : 0.5 * (h.w[trim_a] + h.w[trim_b - 1]);
    const auto meet = [&](const Flank& flank) { return s + (flank.at(s) - w) / (steep - flank.slope); };
    slope = steep;
    const double reach = 1.5 * scale.pitch;
    s_before = std::clamp(meet(before), h.s[edge_before] - reach, h.s[edge_after]);
    s_after = std::clamp(meet(after), s_before, h.s[edge_after] + reach);
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
    p->drop = upright ? height : 0.0;
    p->element = p->tau < 0.0 ? ShapeElement::step_top : ShapeElement::step_bottom;
    p->type = p->tau < 0.0 ? FeatureType::step_top : FeatureType::step_bottom;
  }
  first.window = reach_of(before);
  second.window = reach_of(after);
  first.partner = static_cast<std::int32_t>(out.size()) + 1;
  second.partner = static_cast<std::int32_t>(out.size());
  out.push_back(first);
  out.push_back(second);
  // What rounds the edges belongs to them.
  const auto margin = [](std::uint32_t gap) { return gap > 0 ? gap + 2 : 0; };
  wall.low = wall.first - std::min(margin(before.gap), wall.first - low);
  wall.high = wall.last + std::min(margin(after.gap), high - wall.last);
}

void find_steps(const Heights& h, std::uint32_t begin, std::uint32_t end, std::span<const std::uint32_t> rises,
                const FitScale& scale, std::vector<FeaturePoint>& out, std::vector<WallRun>& walls) {
  const std::size_t known = walls.size();
  const WallTest test(scale);
  WallGrower grower(h, begin, end, test, walls);
  for (const std::uint32_t k : rises) grower.look_at(k);
  const std::span run = std::span(walls).subspan(known);
  for (std::size_t i = 0; i < run.size(); ++i)
    if (run[i].step) measure_step(h, begin, end, run, i, scale, out);
}

} // namespace scansion
