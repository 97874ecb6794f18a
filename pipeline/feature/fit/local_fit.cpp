// Total least squares a side, a broken line against a parabola over both.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/fit/local_fit.hpp"

#include "pipeline/feature/fit/bent_flanks.hpp"
#include "pipeline/feature/fit/pair.hpp"
#include "pipeline/feature/fit/parabola.hpp"
#include "pipeline/feature/fit/rounding.hpp"
#include "pipeline/feature/passes/fastest.hpp"

#include <cmath>
#include <numbers>

namespace scansion {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMisfit = 3.0;             // of the residuals' variance against that of the noise
constexpr double kStrong = 20.0 / kDegrees; // what turns more is an edge even if its flanks are bent

// About sample k: over what lies before it, and after it.
using SideSums = BasicPowerSums<Pair>;

PowerSums together(const SideSums& m) noexcept {
  return {{sum(m.n), sum(m.u), sum(m.v), sum(m.uu), sum(m.uv), sum(m.vv)}, sum(m.uuu), sum(m.uuuu), sum(m.uuv)};
}

// Moves samples from one side to the other: `share` is 1 for the side that gets them and -1 for the other one.
void move(const LineSums& samples, Pair share, BasicLineSums<Pair>& m) noexcept {
  m.n += share * samples.n;
  m.u += share * samples.u;
  m.v += share * samples.v;
  m.uu += share * samples.uu;
  m.uv += share * samples.uv;
  m.vv += share * samples.vv;
}

// Sum of squares of the best broken line with its corner at u0.
double broken_error(const BasicLineSums<Pair>& m, double u0) noexcept {
  const Pair a = m.u - u0 * m.n, aa = m.uu - u0 * (m.u + a), av = m.uv - u0 * m.v;
  const Pair per = aa > 0.0 ? 1.0 / aa : both(0.0), f = a * per;
  const double v = sum(m.v), norm = sum(m.n) - sum(a * f);
  const double offset = norm > 1e-12 ? (v - sum(f * av)) / norm : 0.0;
  const Pair slope = (av - offset * a) * per;
  return std::max(0.0, sum(m.vv) - offset * v - sum(slope * av));
}

// The lines before and after a corner.
struct Lines {
  Pair u{}, v{}; // a point of each
  Pair cosine = both(1.0), sine{};

  [[nodiscard]] Direction direction(std::size_t side) const noexcept { return {cosine[side], sine[side]}; }
  void set(std::size_t side, const Direction& direction) noexcept {
    cosine[side] = direction.cosine;
    sine[side] = direction.sine;
  }
};
constexpr std::size_t kBefore = 0, kAfter = 1;

Lines fit_lines(const SideSums& m) noexcept {
  Lines lines;
  const Pair share = 1.0 / m.n;
  lines.u = m.u * share;
  lines.v = m.v * share;
  const Pair uu = m.uu - m.u * lines.u, uv = m.uv - m.u * lines.v, vv = m.vv - m.v * lines.v;
  // The angle of the larger axis is half that of (uu - vv, 2 uv).
  const Pair size = root((uu - vv) * (uu - vv) + 4.0 * uv * uv);
  const Pair twice = size > 0.0 ? (uu - vv) / size : both(1.0);
  const Pair sine = root(larger(0.5 * (1.0 - twice), both(0.0)));
  lines.cosine = root(0.5 * (1.0 + twice));
  lines.sine = Pair{std::copysign(sine[0], uv[0]), std::copysign(sine[1], uv[1])};
  return lines;
}

// A broken line over one window. Angles in radians, unlike those of a Bend: most corners are refused without any.
struct Corner {
  Lines lines;
  Turning turning;
  double sigma = 1.0;
  bool fitted = false;
  std::uint32_t window = 0;
  // What it takes more to know:
  double s = 0.0, w = 0.0, sharpness = 0.0, radius = 0.0, misfit = 0.0, narrow_sharpness = kNarrowSharpest;

  [[nodiscard]] bool is_significant(double sigmas) const noexcept { return turning.exceeds(sigmas * sigma); }
  [[nodiscard]] Bend bend() const noexcept {
    Bend b;
    b.s = s;
    b.w = w;
    b.theta_before = lines.direction(kBefore).angle() * kDegrees;
    b.theta_after = lines.direction(kAfter).angle() * kDegrees;
    b.tau = b.theta_after - b.theta_before;
    b.sigma_tau = sigma * kDegrees;
    b.sharpness = sharpness;
    b.narrow_sharpness = narrow_sharpness;
    b.misfit = misfit;
    b.window = window;
    b.fitted = fitted;
    return b;
  }
};

// Collects sums a side as the window grows.
class Window {
public:
  Window(const Heights& h, std::uint32_t k, std::uint32_t before, std::uint32_t after)
      : s_(h.s.data()), w_(h.w.data()), k_(k), before_(before), after_(after), l_(k), r_(k) {}

  void grow(std::uint32_t samples) noexcept;
  [[nodiscard]] std::uint32_t samples() const noexcept { return r_ - l_; }
  /// How the window turns at sample k, and how surely.
  [[nodiscard]] Corner corner(std::uint32_t window, const FitScale& scale) const noexcept;
  /// Where it turns, and how sharply.
  void measure(Corner& corner, const FitScale& scale) const noexcept;

private:
  [[nodiscard]] double du(std::uint32_t j) const noexcept { return s_[j] - s_[k_]; }
  [[nodiscard]] double dv(std::uint32_t j) const noexcept { return w_[j] - w_[k_]; }
  [[nodiscard]] Direction direction_to(std::uint32_t neighbour) const noexcept {
    const double u = du(neighbour), v = dv(neighbour), norm = std::copysign(1.0 / std::sqrt(u * u + v * v), u);
    return {norm * u, norm * v};
  }
  [[nodiscard]] double sigma(const Corner& corner) const noexcept;
  void place(Corner& corner, const FitScale& scale) const noexcept;
  [[nodiscard]] double corner_error(double s) const noexcept;

  static constexpr double kFewest = 3.0; // samples of a line
  const double* const s_;
  const double* const w_;
  std::uint32_t k_, before_, after_, l_, r_;
  SideSums sums_;
};

void Window::grow(std::uint32_t samples) noexcept {
  const std::uint32_t l = k_ - before_ > samples ? k_ - samples : before_;
  const std::uint32_t r = std::min(after_, k_ + samples);
  const Pair s = both(s_[k_]), w = both(w_[k_]);
  SideSums sums = sums_; // in registers
  while (l_ > l && r_ < r) {
    --l_;
    ++r_;
    sums.add(Pair{s_[l_], s_[r_]} - s, Pair{w_[l_], w_[r_]} - w, both(1.0));
  }
  while (l_ > l) {
    --l_;
    sums.add(Pair{du(l_), 0.0}, Pair{dv(l_), 0.0}, Pair{1.0, 0.0});
  }
  while (r_ < r) {
    ++r_;
    sums.add(Pair{0.0, du(r_)}, Pair{0.0, dv(r_)}, Pair{0.0, 1.0});
  }
  sums_ = sums;
}

Corner Window::corner(std::uint32_t window, const FitScale& scale) const noexcept {
  Corner corner;
  corner.lines = fit_lines(sums_);
  const bool before = sums_.n[kBefore] >= kFewest, after = sums_.n[kAfter] >= kFewest;
  for (const std::size_t side : {kBefore, kAfter}) {
    if (side == kBefore ? before : after) continue;
    corner.lines.u[side] = corner.lines.v[side] = 0.0;
    corner.lines.set(side, direction_to(side == kBefore ? before_ : after_));
  }
  corner.turning = Turning::between(corner.lines.direction(kBefore), corner.lines.direction(kAfter));
  corner.fitted = before && after;
  corner.window = window;
  corner.sigma = scale.noise * sigma(corner);
  return corner;
}

// Standard deviation of the turning where the noise is 1 mm.
double Window::sigma(const Corner& corner) const noexcept {
  const Pair reach{du(std::min(l_, k_ - 1)), du(std::max(r_, k_ + 1))}, cosine = larger(corner.lines.cosine, both(0.05));
  return std::sqrt(sum(12.0 * cosine * cosine / (larger(sums_.n, both(2.0)) * reach * reach)));
}

// Where the two lines meet, if that is nearby.
void Window::place(Corner& corner, const FitScale& scale) const noexcept {
  corner.s = s_[k_];
  corner.w = w_[k_];
  if (std::abs(corner.turning.sine) < 1e-9) return;
  const Lines& lines = corner.lines;
  const double across = lines.u[kAfter] - lines.u[kBefore], up = lines.v[kAfter] - lines.v[kBefore];
  const double t = (across * lines.sine[kAfter] - up * lines.cosine[kAfter]) / corner.turning.sine;
  const double u = lines.u[kBefore] + t * lines.cosine[kBefore], v = lines.v[kBefore] + t * lines.sine[kBefore];
  const double wider = corner.window > scale.least_window ? 2.0 * corner.window / scale.least_window : 1.0;
  const double room = std::min(-du(before_), du(after_));
  const double limit = std::min(3.5 * scale.pitch * wider, 0.6 * room + scale.pitch);
  if (u * u + v * v > limit * limit) return;
  corner.s += u;
  corner.w += v;
  if (!corner.fitted || !corner.turning.exceeds(scale.least_turning / kDegrees)) return; // refused anyway
  const BentFlanks flanks{sums_, lines.direction(kBefore), lines.direction(kAfter), scale.variance(),
                          std::min(-du(l_), du(r_))};
  const double moved = flanks.moved(u);
  if (moved == 0.0) return;
  corner.s += moved;
  corner.w += 0.5 * moved * sum(lines.sine / lines.cosine);
}

// Sum of squares of the best broken line with its corner at s.
double Window::corner_error(double s) const noexcept {
  BasicLineSums<Pair> sums = sums_;
  const double u0 = s - s_[k_];
  const bool beyond = u0 > 0.0;
  sums.n[beyond ? kBefore : kAfter] += 1.0; // sample k itself
  LineSums passed;
  if (beyond)
    for (std::uint32_t j = k_ + 1; j <= r_ && s_[j] < s; ++j) passed.add(du(j), dv(j), 1.0);
  else
    for (std::uint32_t j = k_; j-- > l_ && s_[j] > s;) passed.add(du(j), dv(j), 1.0);
  if (passed.n > 0.0) move(passed, beyond ? Pair{1.0, -1.0} : Pair{-1.0, 1.0}, sums);
  return broken_error(sums, u0);
}

void Window::measure(Corner& corner, const FitScale& scale) const noexcept {
  place(corner, scale);
  PowerSums all = together(sums_);
  all.n += 1.0;
  if (all.n < 5.0) return;
  const Parabola arc = Parabola::fit(all);
  const double floor = scale.noise / 2.0 + 0.0005; // mm
  const double least = (all.n - 3.0) * floor * floor;
  const double error = corner_error(corner.s);
  corner.misfit = error / std::max(1.0, all.n - 4.0) / scale.variance();
  corner.sharpness = 0.5 * all.n * std::log(std::max(arc.error, least) / std::max(error, least)) - 1.0;
  const double stretch = 1.0 + arc.slope * arc.slope;
  corner.radius = stretch * std::sqrt(stretch) / std::max(2.0 * std::abs(arc.curvature), 1e-12);
}

// The sharpest corner over windows of 1, 2, 4 and 8 times the least one, or the first clear one. Empty: an arc, or straight.
std::optional<Corner> find_corner(const Heights& heights, std::uint32_t k, const Reach& reach, const FitScale& scale) {
  constexpr double kClearSharpness = 2.0, kClearSignificance = 8.0, kArc = -1.0, kSureCorner = 4.0;
  const double straight = 4.0 / 7.0 * scale.least_turning / kDegrees; // what turns no more is noise, or straight
  constexpr double kHardly = 2.5; // sigmas: what turns no more over the least window hardly does over wider ones
  Window window(heights, k, reach.before, reach.after);
  std::optional<Corner> best;
  bool arc = false;
  double narrow = kNarrowSharpest;
  std::uint32_t samples = 0;
  for (std::uint32_t factor = 1; factor <= 8; factor *= 2) {
    window.grow(factor * scale.least_window);
    if (window.samples() == samples) break;
    samples = window.samples();
    Corner corner = window.corner(factor * scale.least_window, scale);
    if (!corner.turning.exceeds(straight)) return std::nullopt;
    if (factor == 1 && !corner.is_significant(kHardly)) return std::nullopt;
    window.measure(corner, scale);
    if (factor == 1 && corner.radius > scale.arc_radius)
      narrow = std::clamp(corner.sharpness, -kNarrowSharpest, kNarrowSharpest);
    if (corner.sharpness < kArc && corner.radius > scale.arc_radius && corner.is_significant(kLeastSignificance)) arc = true;
    if (factor > 1 && corner.misfit > kMisfit && best) break;
    const bool clear = corner.sharpness > kClearSharpness || corner.misfit > kMisfit; // wider windows would follow no better
    if (clear && corner.is_significant(kClearSignificance)) {
      best = corner;
      break;
    }
    if (!best || corner.sharpness > best->sharpness) best = corner;
  }
  if (best && arc && best->sharpness < kSureCorner) best.reset();
  if (best) best->narrow_sharpness = narrow;
  return best;
}

bool may_be_edge(const Corner& corner, const FitScale& scale) noexcept {
  return corner.turning.exceeds(scale.least_turning / kDegrees) && corner.is_significant(kLeastSignificance);
}

// Whether the samples follow a broken line, or it turns so much that they need not.
bool is_followed(const Corner& corner) noexcept {
  return corner.misfit <= kMisfit || corner.turning.exceeds(kStrong);
}

} // namespace

double Bend::significance() const noexcept {
  return std::abs(tau) / sigma_tau;
}

std::uint32_t FitScale::wanted_window(double noise, double pitch, double least_turning) noexcept {
  const double slope = 0.026 * std::min(1.0, least_turning / kLeastTurning);
  const double wanted = std::cbrt(12.0 * noise * noise / (pitch * pitch * slope * slope));
  return static_cast<std::uint32_t>(std::min(24.0, std::ceil(wanted)));
}

FitScale FitScale::of(double noise, double pitch, double coarse, const FeatureLimits& limits) noexcept {
  FitScale scale;
  scale.noise = noise;
  scale.pitch = pitch;
  scale.least_window = std::max(5U, wanted_window(noise, pitch, limits.least_turning));
  scale.arc_radius = std::max(limits.largest_arc, 6.0 * coarse);
  scale.least_turning = limits.least_turning;
  scale.least_step = limits.least_step;
  constexpr double kMost = 400.0; // samples
  constexpr double kAslant = 1.6; // a section aslant shows roundings wider than they are
  constexpr double kTelling =
      53.0; // a straight stretch of the root of this times radius and noise is no arc, though cut aslant
  scale.widest_gap = static_cast<std::uint32_t>(std::min(kMost, std::ceil(kAslant * scale.arc_radius / pitch)));
  scale.telling_flank =
      static_cast<std::uint32_t>(std::min(kMost, std::ceil(std::sqrt(kTelling * scale.arc_radius * scale.sigma()) / pitch)));
  return scale;
}

Bend fit_bend(const Heights& heights, std::uint32_t k, std::uint32_t before, std::uint32_t after, std::uint32_t window,
              const FitScale& scale) {
  Window w(heights, k, before, after);
  w.grow(window);
  Corner corner = w.corner(window, scale);
  w.measure(corner, scale);
  return corner.bend();
}

namespace {

std::optional<Bend> find_bend_body(const Heights& heights, std::uint32_t k, const Reach& reach, const FitScale& scale) {
  std::optional<Corner> corner = find_corner(heights, k, reach, scale);
  if (!corner || !may_be_edge(*corner, scale)) return std::nullopt;
  RoundedEdge edge;
  switch (find_rounding(heights, k, reach.first, reach.last, corner->window, corner->s, corner->turning, scale, edge)) {
    case RoundingSearch::too_wide: return std::nullopt;
    case RoundingSearch::none:
      if (!is_followed(*corner)) return std::nullopt;
      return corner->bend();
    case RoundingSearch::edge: break;
  }
  corner->s = edge.s;
  corner->w = edge.w;
  corner->lines.set(kBefore, edge.before);
  corner->lines.set(kAfter, edge.after);
  corner->sharpness = edge.sharpness;
  corner->narrow_sharpness = kNarrowSharpest;
  corner->window = std::max(corner->window, edge.window);
  Bend bend = corner->bend();
  bend.rounding = edge.radius;
  bend.flank_after = edge.flank_after;
  return bend;
}

} // namespace

std::optional<Bend> find_bend(const Heights& heights, std::uint32_t k, const Reach& reach, const FitScale& scale) {
  return passes::fastest<find_bend_body>(heights, k, reach, scale);
}

Precedent Precedent::of(const Bend& bend, const FitScale& scale) noexcept {
  const bool sharp = bend.rounding == 0.0 && bend.window == scale.least_window && bend.sharpness >= 0.0;
  return {sharp, bend.tau < 0.0, 0};
}

namespace {

std::optional<Bend> find_sharp_bend_body(const Heights& heights, std::uint32_t k, const Reach& reach, bool clockwise,
                                         const FitScale& scale) {
  Window window(heights, k, reach.before, reach.after);
  window.grow(scale.least_window);
  Corner corner = window.corner(scale.least_window, scale);
  if (corner.turning.clockwise() != clockwise || !may_be_edge(corner, scale)) return std::nullopt;
  window.measure(corner, scale);
  if (corner.sharpness < 0.0 || !is_followed(corner)) return std::nullopt;
  if (corner.radius > scale.arc_radius) corner.narrow_sharpness = std::min(corner.sharpness, kNarrowSharpest);
  return corner.bend();
}

} // namespace

std::optional<Bend> find_sharp_bend(const Heights& heights, std::uint32_t k, const Reach& reach, bool clockwise,
                                    const FitScale& scale) {
  return passes::fastest<find_sharp_bend_body>(heights, k, reach, clockwise, scale);
}

std::optional<Bend> find_crest(const Heights& heights, std::uint32_t k, std::uint32_t before, std::uint32_t after,
                               double radius_limit, const FitScale& scale) {
  const double reach = 0.6 * std::min(heights.s[k] - heights.s[before], heights.s[after] - heights.s[k]);
  PowerSums m;
  std::uint32_t l = k, r = k;
  while (l > before && heights.s[k] - heights.s[l - 1] <= reach) --l;
  while (r < after && heights.s[r + 1] - heights.s[k] <= reach) ++r;
  for (std::uint32_t j = l; j <= r; ++j) m.add(heights.s[j] - heights.s[k], heights.w[j] - heights.w[k], 1.0);
  if (m.n < 5.0) return std::nullopt;
  const Parabola arc = Parabola::fit(m);
  if (std::abs(arc.curvature) < 1e-12) return std::nullopt;
  const double top = -arc.slope / (2.0 * arc.curvature); // from the middle of the window
  const double radius = 1.0 / (2.0 * std::abs(arc.curvature));
  if (radius > radius_limit || std::abs(top + arc.middle) > reach) return std::nullopt;
  Bend bend;
  bend.s = heights.s[k] + arc.middle + top;
  bend.w = heights.w[k] + arc.offset + arc.slope * top + arc.curvature * top * top;
  bend.window = std::max(k - l, r - k);
  bend.sigma_tau = scale.noise;
  bend.fitted = true;
  return bend;
}

} // namespace scansion
