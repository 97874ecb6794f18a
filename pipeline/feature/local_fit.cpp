// Total least squares a side, a broken line against a parabola over both.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/local_fit.hpp"

#include "pipeline/feature/parabola.hpp"
#include "pipeline/feature/rounding.hpp"

#include <cmath>
#include <numbers>

namespace scansion {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kMisfit = 3.0; // of the residuals' variance against that of the noise

// Sum of squares of the best broken line with its corner at u0, from what lies left and right of it.
double broken_error(const LineSums& left, const LineSums& right, double u0) noexcept {
  const double n = left.n + right.n, v = left.v + right.v, vv = left.vv + right.vv;
  const double a = left.u - u0 * left.n, b = right.u - u0 * right.n;
  const double aa = left.uu - u0 * (left.u + a), bb = right.uu - u0 * (right.u + b);
  const double av = left.uv - u0 * left.v, bv = right.uv - u0 * right.v;
  const double fa = aa > 0.0 ? a / aa : 0.0, fb = bb > 0.0 ? b / bb : 0.0;
  const double norm = n - a * fa - b * fb;
  const double offset = norm > 1e-12 ? (v - fa * av - fb * bv) / norm : 0.0;
  const double sa = aa > 0.0 ? (av - offset * a) / aa : 0.0, sb = bb > 0.0 ? (bv - offset * b) / bb : 0.0;
  return std::max(0.0, vv - offset * v - sa * av - sb * bv);
}

struct Line {
  double u = 0.0, v = 0.0; // a point of it
  Direction direction;
};

Line fit_line(const LineSums& m) noexcept {
  const double u = m.u / m.n, v = m.v / m.n;
  const double uu = m.uu - m.u * u, uv = m.uv - m.u * v, vv = m.vv - m.v * v;
  // The angle of the larger axis is half that of (uu - vv, 2 uv).
  const double size = std::sqrt((uu - vv) * (uu - vv) + 4.0 * uv * uv);
  const double twice = size > 0.0 ? (uu - vv) / size : 1.0;
  return {u, v, {std::sqrt(0.5 * (1.0 + twice)), std::copysign(std::sqrt(std::max(0.0, 0.5 * (1.0 - twice))), uv)}};
}

// A broken line over one window. Angles in radians, unlike those of a Bend: most corners are refused without any.
struct Corner {
  Line before, after;
  Turning turning;
  bool fitted = false;
  std::uint32_t window = 0;
  // What it takes more to know:
  double s = 0.0, w = 0.0, sigma = 1.0, sharpness = 0.0, radius = 0.0, misfit = 0.0;

  [[nodiscard]] bool is_significant(double sigmas) const noexcept { return turning.exceeds(sigmas * sigma); }
  [[nodiscard]] Bend bend() const noexcept {
    Bend b;
    b.s = s;
    b.w = w;
    b.theta_before = before.direction.angle() * kDegrees;
    b.theta_after = after.direction.angle() * kDegrees;
    b.tau = b.theta_after - b.theta_before;
    b.sigma_tau = sigma * kDegrees;
    b.sharpness = sharpness;
    b.radius = radius;
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

  void grow(std::uint32_t samples) noexcept {
    const std::uint32_t l = k_ - before_ > samples ? k_ - samples : before_;
    const std::uint32_t r = std::min(after_, k_ + samples);
    PowerSums left = left_, right = right_; // in registers
    while (l_ > l) add(left, --l_);
    while (r_ < r) add(right, ++r_);
    left_ = left;
    right_ = right;
  }
  [[nodiscard]] std::uint32_t samples() const noexcept { return r_ - l_; }
  /// How the window turns at sample k.
  [[nodiscard]] Corner corner(std::uint32_t window) const noexcept;
  /// Where it turns, how surely and how sharply.
  void measure(Corner& corner, const FitScale& scale) const noexcept;

private:
  [[nodiscard]] double du(std::uint32_t j) const noexcept { return s_[j] - s_[k_]; }
  [[nodiscard]] double dv(std::uint32_t j) const noexcept { return w_[j] - w_[k_]; }
  template <class Sums>
  void add(Sums& side, std::uint32_t j) const noexcept {
    side.add(du(j), dv(j));
  }
  [[nodiscard]] Line side(const LineSums& m, std::uint32_t neighbour) const noexcept {
    if (m.n >= kFewest) return fit_line(m);
    const double u = du(neighbour), v = dv(neighbour), norm = std::copysign(1.0 / std::sqrt(u * u + v * v), u);
    return {0.0, 0.0, {norm * u, norm * v}};
  }
  [[nodiscard]] double sigma(const Corner& corner) const noexcept;
  void place(Corner& corner, const FitScale& scale) const noexcept;
  [[nodiscard]] double corner_error(double s) const noexcept;

  static constexpr double kFewest = 3.0; // samples of a line
  const double* const s_;
  const double* const w_;
  std::uint32_t k_, before_, after_, l_, r_;
  PowerSums left_, right_;
};

Corner Window::corner(std::uint32_t window) const noexcept {
  Corner corner;
  corner.before = side(left_, before_);
  corner.after = side(right_, after_);
  corner.turning = Turning::between(corner.before.direction, corner.after.direction);
  corner.fitted = left_.n >= kFewest && right_.n >= kFewest;
  corner.window = window;
  return corner;
}

// Standard deviation of the turning where the noise is 1 mm.
double Window::sigma(const Corner& corner) const noexcept {
  const auto share = [&](double n, double length, double cosine) {
    const double along = length / std::max(0.05, cosine);
    return 12.0 / (std::max(n, 2.0) * along * along);
  };
  return std::sqrt(share(left_.n, -du(std::min(l_, k_ - 1)), corner.before.direction.cosine) +
                   share(right_.n, du(std::max(r_, k_ + 1)), corner.after.direction.cosine));
}

// Where the two lines meet, if that is nearby.
void Window::place(Corner& corner, const FitScale& scale) const noexcept {
  corner.s = s_[k_];
  corner.w = w_[k_];
  const Line &before = corner.before, &after = corner.after;
  if (std::abs(corner.turning.sine) < 1e-9) return;
  const double t =
      ((after.u - before.u) * after.direction.sine - (after.v - before.v) * after.direction.cosine) / corner.turning.sine;
  const double u = before.u + t * before.direction.cosine, v = before.v + t * before.direction.sine;
  const double wider = corner.window > scale.least_window ? 2.0 * corner.window / scale.least_window : 1.0;
  const double room = std::min(-du(before_), du(after_));
  const double limit = std::min(3.5 * scale.pitch * wider, 0.6 * room + scale.pitch);
  if (u * u + v * v > limit * limit) return;
  corner.s += u;
  corner.w += v;
}

// Sum of squares of the best broken line with its corner at s.
double Window::corner_error(double s) const noexcept {
  LineSums left = left_, right = right_, passed;
  const double u0 = s - s_[k_];
  (u0 > 0.0 ? left : right).n += 1.0; // sample k itself
  if (u0 > 0.0) {
    for (std::uint32_t j = k_ + 1; j <= r_ && s_[j] < s; ++j) add(passed, j);
    left.add(passed);
    right.remove(passed);
  } else {
    for (std::uint32_t j = k_; j-- > l_ && s_[j] > s;) add(passed, j);
    left.remove(passed);
    right.add(passed);
  }
  return broken_error(left, right, u0);
}

void Window::measure(Corner& corner, const FitScale& scale) const noexcept {
  corner.sigma = scale.noise * sigma(corner);
  place(corner, scale);
  PowerSums all = left_;
  all.add(right_);
  all.n += 1.0;
  if (all.n < 5.0) return;
  const Parabola arc = Parabola::fit(all);
  const double floor = scale.noise / 2.0 + 0.0005; // mm
  const double least = (all.n - 3.0) * floor * floor;
  const double error = corner_error(corner.s);
  corner.misfit = error / std::max(1.0, all.n - 4.0) / (scale.noise * scale.noise + 2.5e-7);
  corner.sharpness = 0.5 * all.n * std::log(std::max(arc.error, least) / std::max(error, least)) - 1.0;
  const double stretch = 1.0 + arc.slope * arc.slope;
  corner.radius = stretch * std::sqrt(stretch) / std::max(2.0 * std::abs(arc.curvature), 1e-12);
}

// The sharpest corner over windows of 1, 2, 4 and 8 times the least one, or the first clear one. Empty: an arc, or straight.
std::optional<Corner> find_corner(const Heights& heights, std::uint32_t k, const Reach& reach, const FitScale& scale) {
  constexpr double kClearSharpness = 2.0, kClearSignificance = 8.0, kArc = -1.0, kSureCorner = 4.0;
  constexpr double kStraight = 4.0 / kDegrees; // what turns no more over a wider window was noise
  Window window(heights, k, reach.before, reach.after);
  std::optional<Corner> best;
  bool arc = false;
  std::uint32_t samples = 0;
  for (std::uint32_t factor = 1; factor <= 8; factor *= 2) {
    window.grow(factor * scale.least_window);
    if (window.samples() == samples) break;
    samples = window.samples();
    Corner corner = window.corner(factor * scale.least_window);
    if (factor > 1 && !corner.turning.exceeds(kStraight)) return std::nullopt;
    window.measure(corner, scale);
    if (corner.sharpness < kArc && corner.radius > scale.arc_radius && corner.is_significant(kLeastSignificance)) arc = true;
    if (factor > 1 && corner.misfit > kMisfit && best) break;
    if (corner.sharpness > kClearSharpness && corner.is_significant(kClearSignificance)) {
      best = corner;
      break;
    }
    if (!best || corner.sharpness > best->sharpness) best = corner;
  }
  if (best && arc && best->sharpness < kSureCorner) best.reset();
  return best;
}

} // namespace

double Bend::significance() const noexcept {
  return std::abs(tau) / sigma_tau;
}

std::uint32_t FitScale::wanted_window(double noise, double pitch) noexcept {
  const double wanted = std::cbrt(12.0 * noise * noise / (pitch * pitch * 0.026 * 0.026));
  return static_cast<std::uint32_t>(std::min(24.0, std::ceil(wanted)));
}

FitScale FitScale::of(double noise, double pitch, double coarse) noexcept {
  FitScale scale;
  scale.noise = noise;
  scale.pitch = pitch;
  scale.least_window = std::max(5U, wanted_window(noise, pitch));
  scale.arc_radius = std::max(3.0, 6.0 * coarse);
  return scale;
}

std::uint32_t FitScale::widest_gap() const noexcept {
  constexpr double kAslant = 1.6; // a section aslant shows roundings wider than they are
  return static_cast<std::uint32_t>(std::min(400.0, std::ceil(kAslant * arc_radius / pitch)));
}

Bend fit_bend(const Heights& heights, std::uint32_t k, std::uint32_t before, std::uint32_t after, std::uint32_t window,
              const FitScale& scale) {
  Window w(heights, k, before, after);
  w.grow(window);
  Corner corner = w.corner(window);
  w.measure(corner, scale);
  return corner.bend();
}

std::optional<Bend> find_bend(const Heights& heights, std::uint32_t k, const Reach& reach, const FitScale& scale) {
  constexpr double kStrong = 20.0 / kDegrees; // what turns more is an edge even if its flanks are bent
  std::optional<Corner> corner = find_corner(heights, k, reach, scale);
  if (!corner || !corner->turning.exceeds(kLeastTurning / kDegrees) || !corner->is_significant(kLeastSignificance))
    return std::nullopt;
  RoundedEdge edge;
  switch (find_rounding(heights, k, reach.first, reach.last, corner->window, corner->s, corner->turning, scale, edge)) {
    case RoundingSearch::too_wide: return std::nullopt;
    case RoundingSearch::none:
      if (corner->misfit > kMisfit && !corner->turning.exceeds(kStrong)) return std::nullopt;
      return corner->bend();
    case RoundingSearch::edge: break;
  }
  corner->s = edge.s;
  corner->w = edge.w;
  corner->before.direction = edge.before;
  corner->after.direction = edge.after;
  corner->sharpness = edge.sharpness;
  corner->window = std::max(corner->window, edge.window);
  Bend bend = corner->bend();
  bend.rounding = edge.radius;
  return bend;
}

std::optional<Bend> find_crest(const Heights& heights, std::uint32_t k, std::uint32_t before, std::uint32_t after,
                               double radius_limit, const FitScale& scale) {
  const double reach = 0.6 * std::min(heights.s[k] - heights.s[before], heights.s[after] - heights.s[k]);
  PowerSums m;
  std::uint32_t l = k, r = k;
  while (l > before && heights.s[k] - heights.s[l - 1] <= reach) --l;
  while (r < after && heights.s[r + 1] - heights.s[k] <= reach) ++r;
  for (std::uint32_t j = l; j <= r; ++j) m.add(heights.s[j] - heights.s[k], heights.w[j] - heights.w[k]);
  if (m.n < 5.0) return std::nullopt;
  const Parabola arc = Parabola::fit(m);
  if (std::abs(arc.curvature) < 1e-12) return std::nullopt;
  const double top = -arc.slope / (2.0 * arc.curvature); // from the middle of the window
  const double radius = 1.0 / (2.0 * std::abs(arc.curvature));
  if (radius > radius_limit || std::abs(top + arc.middle) > reach) return std::nullopt;
  Bend bend;
  bend.s = heights.s[k] + arc.middle + top;
  bend.w = heights.w[k] + arc.offset + arc.slope * top + arc.curvature * top * top;
  bend.radius = radius;
  bend.window = std::max(k - l, r - k);
  bend.sigma_tau = scale.noise;
  bend.fitted = true;
  return bend;
}

} // namespace scansion
