// Least squares over a window that moves away from the edge.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/flank.hpp"

#include "pipeline/feature/line_sums.hpp"

#include <cmath>
#include <limits>

namespace scansion {

namespace {

constexpr double kTelling = 53.0; // a straight stretch of the root of this times radius and noise is no arc, though cut aslant
constexpr std::uint32_t kBeyond = 3; // samples by which the end of a rounding may be missed

// The samples from an edge outwards.
struct Side {
  const double* s;
  const double* w;
  std::ptrdiff_t step; // to the next sample: 1, or -1 to the left
  std::uint32_t count;

  [[nodiscard]] double s_at(std::uint32_t i) const noexcept { return s[step * static_cast<std::ptrdiff_t>(i)]; }
  [[nodiscard]] double w_at(std::uint32_t i) const noexcept { return w[step * static_cast<std::ptrdiff_t>(i)]; }
  [[nodiscard]] double u(std::uint32_t i) const noexcept { return s_at(i) - *s; }
  [[nodiscard]] double v(std::uint32_t i) const noexcept { return w_at(i) - *w; }
  [[nodiscard]] double length(std::uint32_t i, std::uint32_t j) const noexcept { return std::abs(s_at(j) - s_at(i)); }
};

// A broken line against an arc that leaves the flank smoothly, both with the best place to leave it.
bool is_hinged(const Side& outside, const Flank& flank, double sigma) noexcept {
  constexpr double kClearly = 2.0; // twice the least log likelihood
  // The sample at the edge itself tells most.
  const Side side{outside.s - outside.step, outside.w - outside.step, outside.step, outside.count + 1};
  const std::uint32_t gap = flank.gap + 1;
  const double norm = 1.0 / std::sqrt(1.0 + flank.slope * flank.slope);
  const std::uint32_t last = std::min(side.count - 1, gap + kBeyond);
  const std::uint32_t earliest = gap > kBeyond ? gap - kBeyond : 1;
  const double slope = flank.slope, height = *side.w - flank.at(*side.s);
  // In the frame of the flank: x along it from the edge, v off it. Sums over what lies before the place to leave.
  double n = 0.0, x1 = 0.0, x2 = 0.0, x3 = 0.0, x4 = 0.0, v1 = 0.0, xv = 0.0, xxv = 0.0;
  double line = 0.0, arc = 0.0; // most that a fit takes off the sum of squares
  for (std::uint32_t i = 0; i <= last; ++i) {
    const double x = norm * (side.u(i) + slope * side.v(i)), xx = x * x;
    if (i >= earliest) {
      const double about2 = x2 - x * (2.0 * x1 - x * n);
      const double about4 = x4 - x * (4.0 * x3 - x * (6.0 * x2 - x * (4.0 * x1 - x * n)));
      const double once = xv - x * v1, twice = xxv - x * (2.0 * xv - x * v1);
      if (about2 > 0.0) line = std::max(line, once * once / about2);
      if (about4 > 0.0) arc = std::max(arc, twice * twice / about4);
    }
    const double v = norm * (side.v(i) + height - slope * side.u(i));
    n += 1.0;
    x1 += x;
    x2 += xx;
    x3 += xx * x;
    x4 += xx * xx;
    v1 += v;
    xv += x * v;
    xxv += xx * v;
  }
  return line - arc > kClearly * sigma * sigma;
}

// Whether the direction of slope `a` is more than the angle of this tangent above that of slope `b`.
bool is_above(double a, double b, double tangent) noexcept {
  const double scale = 1.0 + a * b;
  return a > b && (scale <= 0.0 || a - b > tangent * scale);
}

// A rounding turns one way until it meets its flank: what turns back lies beyond.
class TurningBack {
public:
  [[nodiscard]] bool turns_back(double slope) noexcept {
    if (!any_) first_ = low_ = high_ = slope;
    any_ = true;
    low_ = std::min(low_, slope);
    high_ = std::max(high_, slope);
    return (is_above(high_, slope, kBack) && is_above(high_, first_, kMove)) ||
           (is_above(slope, low_, kBack) && is_above(first_, low_, kMove));
  }

private:
  static constexpr double kMove = 0.0701, kBack = 0.266; // tangents of 4 and 15 degrees
  double first_ = 0.0, low_ = 0.0, high_ = 0.0;          // slopes
  bool any_ = false;
};

// Least squares over a stretch of samples that moves away from the edge.
class Stretch {
public:
  Stretch(const Side& side, std::uint32_t size, double sigma) : side_(side), size_(size), share_(1.0 / size) {
    // Residuals of a straight flank stay below this with a chance of about one in a thousand.
    const double freedom = size - 2.0;
    limit_ = sigma * sigma * (freedom + 3.1 * std::sqrt(2.0 * std::max(1.0, freedom)));
  }
  [[nodiscard]] bool fits(std::uint32_t gap) const noexcept { return gap + size_ <= side_.count; }
  /// To the samples from `gap` on, which is never less than before.
  void move_to(std::uint32_t gap) noexcept;
  [[nodiscard]] double slope() const noexcept { return slope_; }
  [[nodiscard]] double error() const noexcept { return error_; } // sum of squares
  [[nodiscard]] double limit() const noexcept { return limit_; }
  [[nodiscard]] bool straight() const noexcept { return error_ <= limit_; }
  [[nodiscard]] Flank flank() const noexcept {
    return {*side_.s + share_ * sums_.u,
            *side_.w + share_ * sums_.v,
            slope_,
            side_.length(gap_, gap_ + size_ - 1),
            size_,
            gap_,
            straight()};
  }

private:
  const Side& side_;
  std::uint32_t size_, gap_ = 0, end_ = 0;
  double share_, limit_, slope_ = 0.0, error_ = 0.0;
  LineSums sums_; // of the samples from gap_ to end_
};

void Stretch::move_to(std::uint32_t gap) noexcept {
  LineSums sums = sums_; // in registers
  if (gap >= end_) {
    sums = {};
    gap_ = end_ = gap;
  }
  for (; gap_ < gap; ++gap_) sums.remove(side_.u(gap_), side_.v(gap_));
  for (; end_ < gap + size_; ++end_) sums.add(side_.u(end_), side_.v(end_));
  sums_ = sums;
  if (size_ < 3) return;
  const double uu = sums.uu - share_ * sums.u * sums.u, uv = sums.uv - share_ * sums.u * sums.v;
  slope_ = uu > 0.0 ? uv / uu : 0.0;
  error_ = std::max(0.0, sums.vv - share_ * sums.v * sums.v - slope_ * uv);
}

// The smallest radius that a stretch of this length and noise can have without showing it.
double least_radius(const Flank& flank, double sigma) noexcept {
  const double stretch = 1.0 + flank.slope * flank.slope;
  return flank.length * flank.length * stretch * std::sqrt(stretch) / (16.0 * sigma);
}

// The first stretch that is straight and long enough to tell: of `size` samples, or of `few` where they are far apart. Else the
// first of `few` that is straight, else the straightest of them.
Flank first_straight(const Side& side, std::uint32_t few, std::uint32_t size, std::uint32_t most_gap, double radius,
                     double sigma) noexcept {
  Stretch low(side, few, sigma), high(side, std::min(size, side.count), sigma);
  Flank best;
  TurningBack passed;
  double best_error = std::numeric_limits<double>::infinity();
  for (std::uint32_t gap = 0; gap <= most_gap && low.fits(gap); ++gap) {
    low.move_to(gap);
    if (low.straight()) {
      const Flank flank = low.flank();
      if (least_radius(flank, sigma) >= radius) return flank;
      if (!best.straight) best = flank;
    } else if (!best.straight && low.error() < best_error) {
      best = low.flank();
      best_error = low.error();
    }
    // What is not straight over few samples is less so over more.
    if (size > few && low.error() <= high.limit() && high.fits(gap)) {
      high.move_to(gap);
      if (high.straight()) return high.flank();
    }
    if (passed.turns_back(low.slope())) break;
  }
  return best;
}

// A longer stretch beyond a flank that a rounding gave: it still sees what is left of the arc.
Flank longer_stretch(const Side& side, const Flank& flank, double sigma) noexcept {
  Stretch stretch(side, 2 * flank.samples, sigma);
  for (std::uint32_t gap = flank.gap; gap <= flank.gap + flank.samples && stretch.fits(gap); ++gap) {
    stretch.move_to(gap);
    if (stretch.straight()) return stretch.flank();
  }
  return flank;
}

Side side_of(const Heights& h, std::uint32_t from, std::uint32_t to) noexcept {
  const bool left = to < from;
  return {&h.s[from], &h.w[from], left ? -1 : 1, (left ? from - to : to - from) + 1};
}

double sigma_of(const FitScale& scale) noexcept {
  return scale.noise + 0.0005;
}

} // namespace

Flank find_flank(const Heights& h, std::uint32_t from, std::uint32_t to, std::uint32_t window, std::uint32_t most_gap,
                 const FitScale& scale) {
  constexpr std::uint32_t kFewest = 4;
  constexpr double kFlatter = 3.0; // radius of what is taken for straight against that of the largest rounding
  const Side side = side_of(h, from, to);
  const std::uint32_t size = std::min(window, side.count);
  const double sigma = sigma_of(scale);
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
  return best;
}

bool is_chamfered(const Heights& h, std::uint32_t from, std::uint32_t to, const Flank& flank, const FitScale& scale) {
  return flank.gap + 1 >= kLeastGap && is_hinged(side_of(h, from, to), flank, sigma_of(scale));
}

} // namespace scansion
