// Least squares over a window that moves away from the edge.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/flank.hpp"

#include <cmath>
#include <limits>

namespace scansion {

namespace {

struct Sums {
  double n = 0.0, u = 0.0, v = 0.0, uu = 0.0, uv = 0.0, vv = 0.0;
  void add(double du, double dv, double sign) noexcept {
    n += sign;
    u += sign * du;
    v += sign * dv;
    uu += sign * du * du;
    uv += sign * du * dv;
    vv += sign * dv * dv;
  }
};

constexpr double kTelling = 53.0; // a straight stretch of the root of this times radius and noise is no arc: off by two sigma
constexpr std::uint32_t kBeyond = 3; // samples by which the end of a rounding may be missed

// The samples from an edge outwards.
struct Side {
  const Heights& h;
  std::uint32_t from;
  bool left;
  std::uint32_t count;

  [[nodiscard]] std::uint32_t sample(std::uint32_t i) const noexcept { return left ? from - i : from + i; }
  [[nodiscard]] double s0() const noexcept { return h.s[from]; }
  [[nodiscard]] double w0() const noexcept { return h.w[from]; }
  [[nodiscard]] double u(std::uint32_t i) const noexcept { return h.s[sample(i)] - h.s[from]; }
  [[nodiscard]] double v(std::uint32_t i) const noexcept { return h.w[sample(i)] - h.w[from]; }
  [[nodiscard]] double length(std::uint32_t i, std::uint32_t j) const noexcept {
    return std::abs(h.s[sample(j)] - h.s[sample(i)]);
  }
  void add(Sums& sums, std::uint32_t i, double sign) const noexcept { sums.add(u(i), v(i), sign); }
};

// Whether what lies between the edge and a flank runs straight up to it, and does not round into it: a broken line against an
// arc that leaves the flank smoothly, both with the best place to leave it.
bool is_chamfer(const Side& outside, const Flank& flank, double sigma) noexcept {
  constexpr double kClearly = 2.0; // twice the least log likelihood
  // The sample at the edge itself tells most.
  const Side side{outside.h, outside.left ? outside.from + 1 : outside.from - 1, outside.left, outside.count + 1};
  const std::uint32_t gap = flank.gap + 1;
  const double norm = 1.0 / std::hypot(1.0, flank.slope);
  const std::uint32_t last = std::min(side.count - 1, gap + kBeyond);
  // In the frame of the flank: places along it from the edge, distances from it.
  const auto along = [&](std::uint32_t i) { return norm * (side.u(i) + flank.slope * side.v(i)); };
  const auto off = [&](std::uint32_t i) { return norm * (side.v(i) + side.w0() - flank.at(side.u(i) + side.s0())); };
  double best_line = std::numeric_limits<double>::infinity(), best_arc = best_line;
  for (std::uint32_t leave = gap > kBeyond ? gap - kBeyond : 1; leave <= last; ++leave) {
    const double from = along(leave);
    double vv = 0.0, xv = 0.0, xx = 0.0, yv = 0.0, yy = 0.0;
    for (std::uint32_t i = 0; i <= last; ++i) {
      const double v = off(i);
      vv += v * v;
      if (i >= leave) continue;
      const double x = along(i) - from, y = x * x;
      xv += x * v;
      xx += x * x;
      yv += y * v;
      yy += y * y;
    }
    if (xx > 0.0) best_line = std::min(best_line, vv - xv * xv / xx);
    if (yy > 0.0) best_arc = std::min(best_arc, vv - yv * yv / yy);
  }
  return best_line + kClearly * sigma * sigma < best_arc;
}

// A rounding turns one way until it meets its flank: what turns back lies beyond.
class TurningBack {
public:
  [[nodiscard]] bool turns_back(double slope) noexcept {
    const double angle = std::atan(slope);
    if (!any_) first_ = low_ = high_ = angle;
    any_ = true;
    low_ = std::min(low_, angle);
    high_ = std::max(high_, angle);
    return (high_ - first_ > kMove && high_ - angle > kBack) || (first_ - low_ > kMove && angle - low_ > kBack);
  }

private:
  static constexpr double kMove = 0.07, kBack = 0.26; // 4 and 15 degrees
  double first_ = 0.0, low_ = 0.0, high_ = 0.0;
  bool any_ = false;
};

// A stretch of samples that moves away from the edge.
class Stretch {
public:
  Stretch(const Side& side, std::uint32_t gap, std::uint32_t size, double sigma)
      : side_(side), size_(size), gap_(gap), n_(size) {
    for (std::uint32_t i = gap; i < gap + size; ++i) side_.add(sums_, i, 1.0);
    // Residuals of a straight flank stay below this with a chance of about one in a thousand.
    limit_ = sigma * sigma * (1.0 + 3.1 * std::sqrt(2.0 / std::max(1.0, n_ - 2.0)));
  }
  [[nodiscard]] bool fits() const noexcept { return gap_ + size_ <= side_.count; }
  void move() noexcept {
    side_.add(sums_, gap_, -1.0);
    if (++gap_ + size_ <= side_.count) side_.add(sums_, gap_ + size_ - 1, 1.0);
  }
  // `error`: its variance.
  [[nodiscard]] Flank flank(double& error) const noexcept {
    const double mu = sums_.u / n_, mv = sums_.v / n_;
    const double uu = sums_.uu - mu * sums_.u, uv = sums_.uv - mu * sums_.v, vv = sums_.vv - mv * sums_.v;
    const double slope = size_ >= 3 && uu > 0.0 ? uv / uu : 0.0;
    error = size_ >= 3 ? std::max(0.0, vv - slope * uv) / (n_ - 2.0) : 0.0;
    return {side_.s0() + mu, side_.w0() + mv, slope, side_.length(gap_, gap_ + size_ - 1), size_, gap_, error <= limit_};
  }

private:
  const Side& side_;
  std::uint32_t size_, gap_;
  double n_, limit_;
  Sums sums_;
};

// The smallest radius that a stretch of this length and noise can have without showing it.
double least_radius(const Flank& flank, double sigma) noexcept {
  const double cosine = 1.0 / std::hypot(1.0, flank.slope);
  const double length = flank.length / cosine;
  return length * length / (16.0 * sigma * cosine);
}

// The first stretch that is straight and long enough to tell: of `size` samples, or of `few` where they are far apart. Else the
// first of `few` that is straight, else the straightest of them.
Flank first_straight(const Side& side, std::uint32_t few, std::uint32_t size, std::uint32_t most_gap, double radius,
                     double sigma) noexcept {
  Stretch low(side, 0, few, sigma), high(side, 0, std::min(size, side.count), sigma);
  Flank best;
  TurningBack passed;
  double best_error = std::numeric_limits<double>::infinity(), error = 0.0;
  for (std::uint32_t gap = 0; gap <= most_gap && low.fits(); ++gap) {
    const Flank flank = low.flank(error);
    if (flank.straight && least_radius(flank, sigma) >= radius) return flank;
    if (!best.straight && (flank.straight || error < best_error)) {
      best = flank;
      best_error = error;
    }
    if (size > few && high.fits()) {
      const Flank longer = high.flank(error);
      if (longer.straight) return longer;
    }
    if (passed.turns_back(flank.slope)) break;
    low.move();
    high.move();
  }
  return best;
}

// A longer stretch beyond a flank that a rounding gave: it still sees what is left of the arc.
Flank longer_stretch(const Side& side, const Flank& flank, double sigma) noexcept {
  const std::uint32_t size = 2 * flank.samples;
  if (flank.gap + size > side.count) return flank;
  Stretch stretch(side, flank.gap, size, sigma);
  for (std::uint32_t gap = flank.gap; gap <= flank.gap + flank.samples && stretch.fits(); ++gap, stretch.move()) {
    double error = 0.0;
    const Flank longer = stretch.flank(error);
    if (longer.straight) return longer;
  }
  return flank;
}

} // namespace

Flank find_flank(const Heights& h, std::uint32_t from, std::uint32_t to, std::uint32_t window, std::uint32_t most_gap,
                 const FitScale& scale) {
  constexpr std::uint32_t kFewest = 4;
  constexpr double kFlatter = 3.0; // radius of what is taken for straight against that of the largest rounding
  const bool left = to < from;
  const Side side{h, from, left, (left ? from - to : to - from) + 1};
  const std::uint32_t size = std::min(window, side.count);
  const double sigma = scale.noise + 0.0005;
  const double radius = kFlatter * scale.arc_radius;
  if (most_gap == 0) return first_straight(side, size, size, 0, radius, sigma);
  // The end of a rounding is straight over a short stretch.
  const double telling = std::sqrt(kTelling * scale.arc_radius * sigma) / scale.pitch;
  const auto most = static_cast<std::uint32_t>(std::min(2.0 * size, std::ceil(telling)));
  const std::uint32_t few = std::min(size, std::max(kFewest, size / 3));
  Flank best = first_straight(side, few, std::max(most, size), most_gap, radius, sigma);
  if (best.straight && best.gap > 0) best = longer_stretch(side, best, sigma);
  constexpr double kSmallRounding = 0.35; // mm
  best.rounded = best.straight && best.gap > 0 && (best.gap >= kLeastGap || best.gap * scale.pitch <= kSmallRounding);
  if (best.gap >= kLeastGap) best.chamfered = is_chamfer(side, best, sigma);
  return best;
}

} // namespace scansion
