// Total least squares a side, a broken line against a parabola over both.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/local_fit.hpp"

#include "pipeline/feature/flank.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace scansion {

namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

// Power sums about the sample in the middle: u along, v up.
struct Moments {
  double n = 0.0, u = 0.0, v = 0.0, uu = 0.0, uv = 0.0, vv = 0.0, uuu = 0.0, uuuu = 0.0, uuv = 0.0;

  void add(double du, double dv) noexcept {
    const double square = du * du;
    n += 1.0;
    u += du;
    v += dv;
    uu += square;
    uv += du * dv;
    vv += dv * dv;
    uuu += square * du;
    uuuu += square * square;
    uuv += square * dv;
  }
};

Moments operator+(const Moments& a, const Moments& b) noexcept {
  return {a.n + b.n,   a.u + b.u,     a.v + b.v,       a.uu + b.uu,  a.uv + b.uv,
          a.vv + b.vv, a.uuu + b.uuu, a.uuuu + b.uuuu, a.uuv + b.uuv};
}

Moments operator-(const Moments& a, const Moments& b) noexcept {
  return {a.n - b.n,   a.u - b.u,     a.v - b.v,       a.uu - b.uu,  a.uv - b.uv,
          a.vv - b.vv, a.uuu - b.uuu, a.uuuu - b.uuuu, a.uuv - b.uuv};
}

// Sum of squares of the best broken line with its corner at u0, from what lies left and right of it.
double broken_error(const Moments& left, const Moments& right, double u0) noexcept {
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
  double u = 0.0, v = 0.0;         // a point of it
  double theta = 0.0;              // radians
  double cosine = 1.0, sine = 0.0; // of theta; the cosine is not negative
};

Line with_direction(double u, double v, double cosine, double sine) noexcept {
  return {u, v, std::atan2(sine, cosine), cosine, sine};
}

Line fit_line(const Moments& m) noexcept {
  const double u = m.u / m.n, v = m.v / m.n;
  const double uu = m.uu - m.u * u, uv = m.uv - m.u * v, vv = m.vv - m.v * v;
  // The angle of the larger axis is half that of (uu - vv, 2 uv).
  const double size = std::sqrt((uu - vv) * (uu - vv) + 4.0 * uv * uv);
  const double twice = size > 0.0 ? (uu - vv) / size : 1.0;
  const double cosine = std::sqrt(0.5 * (1.0 + twice));
  return with_direction(u, v, cosine, std::copysign(std::sqrt(std::max(0.0, 0.5 * (1.0 - twice))), uv));
}

struct Parabola {
  double curvature = 0.0;                         // second derivative / 2
  double slope = 0.0, middle = 0.0, offset = 0.0; // v = offset + slope (u - middle) + curvature (u - middle)^2
  double error = 0.0;                             // sum of squares
};

Parabola fit_parabola(const Moments& m) noexcept {
  Parabola p;
  const double c = m.u / m.n;
  p.middle = c;
  const double s2 = m.uu - c * m.u;
  const double s3 = m.uuu - 3.0 * c * m.uu + 2.0 * c * c * m.u;
  const double s4 = m.uuuu - 4.0 * c * m.uuu + 6.0 * c * c * m.uu - 3.0 * c * c * c * m.u;
  const double mean = m.v / m.n;
  const double uv = m.uv - c * m.v;
  const double uuv = m.uuv - 2.0 * c * m.uv + c * c * m.v; // over (u - c)^2
  const double vv = m.vv - m.v * mean;
  const double norm = s4 - s3 * s3 / s2 - s2 * s2 / m.n;
  const double q = uuv - s2 * mean - s3 / s2 * uv;
  p.curvature = norm > 0.0 ? q / norm : 0.0;
  p.slope = (uv - p.curvature * s3) / s2;
  p.offset = mean - p.curvature * s2 / m.n;
  p.error = std::max(0.0, vv - uv * uv / s2 - (norm > 0.0 ? q * q / norm : 0.0));
  return p;
}

// Collects moments a side as the window grows.
class Window {
public:
  Window(const Heights& h, std::uint32_t k, std::uint32_t before, std::uint32_t after)
      : h_(h), k_(k), before_(before), after_(after), l_(k), r_(k) {}

  void grow(std::uint32_t samples) noexcept {
    const std::uint32_t l = k_ - before_ > samples ? k_ - samples : before_;
    const std::uint32_t r = std::min(after_, k_ + samples);
    while (l_ > l) add(left_, --l_);
    while (r_ < r) add(right_, ++r_);
  }
  [[nodiscard]] std::uint32_t samples() const noexcept { return r_ - l_; }
  [[nodiscard]] Bend measure(std::uint32_t window, const FitScale& scale) const;

private:
  [[nodiscard]] double corner_error(double s) const noexcept;
  void add(Moments& side, std::uint32_t j) const noexcept { side.add(h_.s[j] - h_.s[k_], h_.w[j] - h_.w[k_]); }
  [[nodiscard]] Line side(const Moments& m, std::uint32_t neighbour) const noexcept {
    constexpr double kFewest = 3.0;
    if (m.n >= kFewest) return fit_line(m);
    const double du = h_.s[neighbour] - h_.s[k_], dv = h_.w[neighbour] - h_.w[k_];
    const double length = std::sqrt(du * du + dv * dv), sign = du < 0.0 ? -1.0 : 1.0;
    return with_direction(0.0, 0.0, sign * du / length, sign * dv / length);
  }
  void refine(Bend& bend, const Line& before, const Line& after, std::uint32_t window, const FitScale& scale) const noexcept;

  const Heights& h_;
  std::uint32_t k_, before_, after_, l_, r_;
  Moments left_, right_;
};

void Window::refine(Bend& bend, const Line& before, const Line& after, std::uint32_t window,
                    const FitScale& scale) const noexcept {
  bend.s = h_.s[k_];
  bend.w = h_.w[k_];
  const double ca = before.cosine, sa = before.sine, cb = after.cosine, sb = after.sine;
  const double cross = ca * sb - sa * cb;
  if (std::abs(cross) < 1e-9) return;
  const double t = ((after.u - before.u) * sb - (after.v - before.v) * cb) / cross;
  const double u = before.u + t * ca, v = before.v + t * sa;
  const double wider = window > scale.least_window ? 2.0 * window / scale.least_window : 1.0;
  const double room = std::min(h_.s[k_] - h_.s[before_], h_.s[after_] - h_.s[k_]);
  const double limit = std::min(3.5 * scale.pitch * wider, 0.6 * room + scale.pitch);
  if (u * u + v * v > limit * limit) return;
  bend.s += u;
  bend.w += v;
}

// Sum of squares of the best broken line with its corner at s.
double Window::corner_error(double s) const noexcept {
  Moments left = left_, right = right_, passed;
  const double u0 = s - h_.s[k_];
  (u0 > 0.0 ? left : right).n += 1.0; // sample k itself
  for (std::uint32_t j = k_ + 1; j <= r_ && h_.s[j] < s; ++j) add(passed, j);
  left = left + passed;
  right = right - passed;
  passed = {};
  for (std::uint32_t j = k_; j-- > l_ && h_.s[j] > s;) add(passed, j);
  return broken_error(left - passed, right + passed, u0);
}

Bend Window::measure(std::uint32_t window, const FitScale& scale) const {
  Bend bend;
  bend.window = window;
  const Line before = side(left_, before_), after = side(right_, after_);
  bend.theta_before = before.theta * kDegrees;
  bend.theta_after = after.theta * kDegrees;
  bend.tau = bend.theta_after - bend.theta_before;
  bend.fitted = left_.n >= 3.0 && right_.n >= 3.0;
  const auto share = [&](double n, double length) { return 12.0 / (std::max(n, 2.0) * length * length); };
  const double reach_before = (h_.s[k_] - h_.s[std::min(l_, k_ - 1)]) / std::max(0.05, before.cosine);
  const double reach_after = (h_.s[std::max(r_, k_ + 1)] - h_.s[k_]) / std::max(0.05, after.cosine);
  bend.sigma_tau = scale.noise * std::sqrt(share(left_.n, reach_before) + share(right_.n, reach_after)) * kDegrees;
  refine(bend, before, after, window, scale);

  Moments all = left_ + right_;
  all.n += 1.0;
  if (all.n < 5.0) return bend;
  const Parabola arc = fit_parabola(all);
  const double floor = scale.noise / 2.0 + 0.0005; // mm
  const double least = (all.n - 3.0) * floor * floor;
  const double corner = corner_error(bend.s);
  bend.misfit = corner / std::max(1.0, all.n - 4.0) / (scale.noise * scale.noise + 2.5e-7);
  bend.sharpness = 0.5 * all.n * std::log(std::max(arc.error, least) / std::max(corner, least)) - 1.0;
  const double stretch = 1.0 + arc.slope * arc.slope;
  bend.radius = stretch * std::sqrt(stretch) / std::max(2.0 * std::abs(arc.curvature), 1e-12);
  return bend;
}

// Sum of squares of the best parabola over samples [l, r].
double arc_error(const Heights& h, std::uint32_t l, std::uint32_t r) noexcept {
  Moments m;
  const std::uint32_t k = (l + r) / 2;
  for (std::uint32_t j = l; j <= r; ++j) m.add(h.s[j] - h.s[k], h.w[j] - h.w[k]);
  return fit_parabola(m).error;
}

// Replaces the fits a side by those of the straight flanks beyond a rounding, when there is one: the edge of a fillet is where
// its flanks would meet. The rounding hides the neighbours that the ranking gave, so only the run bounds the search. False: it
// rounds so widely that there is no edge.
bool reach_flanks(Bend& bend, const Heights& h, std::uint32_t k, std::uint32_t first, std::uint32_t last,
                  const FitScale& scale) {
  constexpr double kSharpest = 12.0;
  constexpr std::uint32_t kFewest = 4;
  const std::uint32_t window = std::clamp(bend.window, scale.least_window, 2 * scale.least_window);
  if (k - first < 4 || last - k < 4) return true;
  const std::uint32_t most = scale.widest_gap();
  const Flank l = find_flank(h, k - 1, first, window, most, scale);
  if (!l.straight || l.samples < kFewest) return true;
  const Flank r = find_flank(h, k + 1, last, window, most, scale);
  if (!r.straight || r.samples < kFewest || !(l.rounded || r.rounded)) return true;
  if (std::abs(l.slope - r.slope) < 1e-9) return true;
  const double u = ((r.w - r.slope * (r.s - bend.s)) - (l.w - l.slope * (l.s - bend.s))) / (l.slope - r.slope);
  const double s = bend.s + u;
  // The flanks meet over the rounding between them.
  const double low = h.s[k - 1 - l.gap] - scale.pitch, high = h.s[k + 1 + r.gap] + scale.pitch;
  if (s < low || s > high) return true;
  const double before_angle = std::atan(l.slope) * kDegrees, after_angle = std::atan(r.slope) * kDegrees;
  const double tau = after_angle - before_angle;
  if ((tau < 0.0) != (bend.tau < 0.0) || std::abs(tau) < std::abs(bend.tau)) return true;
  if (is_chamfered(h, k - 1, first, l, scale) || is_chamfered(h, k + 1, last, r, scale)) return true;
  // Tangent length over the tangent of half the turning: the radius.
  const double tangent =
      0.5 * (h.s[k + 1 + r.gap] - h.s[k - 1 - l.gap]) / std::max(0.1, std::cos(0.5 * (before_angle + after_angle) / kDegrees));
  const double radius = tangent / std::tan(std::min(89.0, 0.5 * std::abs(tau)) / kDegrees);
  if (radius > scale.arc_radius) return false;
  const std::uint32_t from = k - 1 - l.gap - (l.samples - 1), to = k + 1 + r.gap + (r.samples - 1);
  const double n = to - from + 1;
  const double floor = n * (scale.noise * scale.noise + 2.5e-7);
  bend.sharpness = std::min(kSharpest, 0.5 * n * std::log(std::max(1.0, arc_error(h, from, to) / floor)) - 1.0);
  bend.s = s;
  bend.w = l.at(s);
  bend.theta_before = before_angle;
  bend.theta_after = after_angle;
  bend.tau = tau;
  bend.window = std::max(bend.window, std::max(l.gap + l.samples, r.gap + r.samples));
  bend.rounding = radius;
  return true;
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
  return w.measure(window, scale);
}

std::optional<Bend> find_bend(const Heights& heights, std::uint32_t k, const Reach& reach, const FitScale& scale) {
  constexpr double kClearSharpness = 2.0, kClearSignificance = 8.0, kArc = -1.0, kSureCorner = 4.0;
  constexpr double kStraight = 4.0; // degrees: what turns no more over a wider window was noise
  constexpr double kMisfit = 3.0;   // of the residuals' variance against that of the noise
  constexpr double kStrong = 20.0;  // degrees: what turns more is an edge even if its flanks are bent
  Window window(heights, k, reach.before, reach.after);
  std::optional<Bend> best;
  bool arc = false;
  std::uint32_t samples = 0;
  for (std::uint32_t factor = 1; factor <= 8; factor *= 2) {
    window.grow(factor * scale.least_window);
    if (window.samples() == samples) break;
    samples = window.samples();
    const Bend bend = window.measure(factor * scale.least_window, scale);
    if (factor > 1 && std::abs(bend.tau) < kStraight) return std::nullopt;
    if (bend.sharpness < kArc && bend.significance() >= kLeastSignificance && bend.radius > scale.arc_radius) arc = true;
    if (factor > 1 && bend.misfit > kMisfit && best) break;
    if (bend.sharpness > kClearSharpness && bend.significance() > kClearSignificance) {
      best = bend;
      break;
    }
    if (!best || bend.sharpness > best->sharpness) best = bend;
  }
  if (!best || (arc && best->sharpness < kSureCorner)) return std::nullopt;
  if (std::abs(best->tau) < kLeastTurning || best->significance() < kLeastSignificance) return std::nullopt;
  if (!reach_flanks(*best, heights, k, reach.first, reach.last, scale)) return std::nullopt;
  if (best->misfit > kMisfit && best->rounding == 0.0 && std::abs(best->tau) < kStrong) return std::nullopt;
  return best;
}

std::optional<Bend> find_crest(const Heights& heights, std::uint32_t k, std::uint32_t before, std::uint32_t after,
                               double radius_limit, const FitScale& scale) {
  const double reach = 0.6 * std::min(heights.s[k] - heights.s[before], heights.s[after] - heights.s[k]);
  Moments m;
  std::uint32_t l = k, r = k;
  while (l > before && heights.s[k] - heights.s[l - 1] <= reach) --l;
  while (r < after && heights.s[r + 1] - heights.s[k] <= reach) ++r;
  for (std::uint32_t j = l; j <= r; ++j) m.add(heights.s[j] - heights.s[k], heights.w[j] - heights.w[k]);
  if (m.n < 5.0) return std::nullopt;
  const Parabola arc = fit_parabola(m);
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
