// Least squares over stretches that move away from the edge.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/flank.hpp"

#include "pipeline/feature/pair.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace scansion {

namespace {

constexpr double kTelling = 53.0; // a straight stretch of the root of this times radius and noise is no arc, though cut aslant
constexpr std::uint32_t kBeyond = 3; // samples by which the end of a rounding may be missed

// A line through `size` samples, `gap` samples from the edge.
struct Stretch {
  std::uint32_t gap = 0, size = 0;
  Pair middle{};                   // along and up from the edge
  double slope = 0.0, error = 0.0; // sum of squares
};

// The samples from an edge outwards.
class Side {
public:
  Side(const Heights& h, std::uint32_t from, std::uint32_t to) noexcept
      : s_(&h.s[from]), w_(&h.w[from]), step_(to < from ? -1 : 1), count_((to < from ? from - to : to - from) + 1) {}

  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }
  [[nodiscard]] Side with_edge() const noexcept { return {s_ - step_, w_ - step_, step_, count_ + 1}; }
  [[nodiscard]] double s(std::uint32_t i) const noexcept { return s_[step_ * static_cast<std::ptrdiff_t>(i)]; }
  [[nodiscard]] double w(std::uint32_t i) const noexcept { return w_[step_ * static_cast<std::ptrdiff_t>(i)]; }
  [[nodiscard]] Flank flank(const Stretch& line, bool straight) const noexcept {
    return {*s_ + line.middle[0], *w_ + line.middle[1], line.slope, length(line), line.size, line.gap, straight};
  }
  [[nodiscard]] double length(const Stretch& line) const noexcept {
    return std::abs(s(line.gap + line.size - 1) - s(line.gap));
  }

private:
  Side(const double* s, const double* w, std::ptrdiff_t step, std::uint32_t count) noexcept
      : s_(s), w_(w), step_(step), count_(count) {}

  const double* s_;
  const double* w_;
  std::ptrdiff_t step_; // to the next sample: 1, or -1 to the left
  std::uint32_t count_;
};

// Fits stretches of a side from running sums, which are made as far as they are asked for.
class Stretches {
public:
  static constexpr std::uint32_t kMost = 1024; // samples that are looked at

  explicit Stretches(const Side& side) noexcept : side_(side), count_(std::min(side.count(), kMost)) {
    sums_[0] = Sums{Pair{}, Pair{}, 0.0};
  }
  [[nodiscard]] bool fits(std::uint32_t gap, std::uint32_t size) const noexcept { return gap + size <= count_; }
  [[nodiscard]] Stretch fit(std::uint32_t gap, std::uint32_t size) noexcept {
    if (made_ < gap + size) extend(gap + size);
    const Sums &from = sums_[gap], &to = sums_[gap + size];
    const Pair first = to.first - from.first, middle = first / size;
    if (size < 3) return {gap, size, middle, 0.0, 0.0};
    const Pair along = to.along - from.along - middle * first[0]; // uu, uv about the middle
    const double slope = along[0] > 0.0 ? along[1] / along[0] : 0.0;
    const double up = to.up - from.up - middle[1] * first[1];
    return {gap, size, middle, slope, std::max(0.0, up - slope * along[1])};
  }

private:
  struct Sums {
    Pair first, along; // u, v; uu, uv
    double up;         // vv
  };
  void extend(std::uint32_t end) noexcept {
    const Pair origin{side_.s(0), side_.w(0)};
    Sums sums = sums_[made_];
    while (made_ < end) {
      const Pair place = Pair{side_.s(made_), side_.w(made_)} - origin;
      sums.first += place;
      sums.along += place * place[0];
      sums.up += place[1] * place[1];
      sums_[++made_] = sums;
    }
  }

  const Side& side_;
  std::uint32_t count_, made_ = 0;
  std::array<Sums, kMost + 1> sums_; // of the samples before each
};

// Residuals of a straight flank stay below this with a chance of about one in a thousand.
double straight_limit(std::uint32_t size, double sigma) noexcept {
  const double freedom = size - 2.0;
  return sigma * sigma * (freedom + 3.1 * std::sqrt(2.0 * std::max(1.0, freedom)));
}

// A broken line against an arc that leaves the flank smoothly, both with the best place to leave it.
bool is_hinged(const Side& outside, const Flank& flank, double sigma) noexcept {
  constexpr double kClearly = 2.0; // twice the least log likelihood
  // The sample at the edge itself tells most.
  const Side side = outside.with_edge();
  const std::uint32_t gap = flank.gap + 1;
  const double norm = 1.0 / std::sqrt(1.0 + flank.slope * flank.slope);
  const std::uint32_t last = std::min(side.count() - 1, gap + kBeyond);
  const std::uint32_t earliest = gap > kBeyond ? gap - kBeyond : 1;
  const double slope = flank.slope, s0 = side.s(0), w0 = side.w(0), height = w0 - flank.at(s0);
  // In the frame of the flank: x along it from the edge, v off it. Sums over what lies before the place to leave.
  double n = 0.0, x1 = 0.0, x2 = 0.0, x3 = 0.0, x4 = 0.0, v1 = 0.0, xv = 0.0, xxv = 0.0;
  double line = 0.0, arc = 0.0; // most that a fit takes off the sum of squares
  for (std::uint32_t i = 0; i <= last; ++i) {
    const double du = side.s(i) - s0, dv = side.w(i) - w0;
    const double x = norm * (du + slope * dv), xx = x * x;
    if (i >= earliest) {
      const double about2 = x2 - x * (2.0 * x1 - x * n);
      const double about4 = x4 - x * (4.0 * x3 - x * (6.0 * x2 - x * (4.0 * x1 - x * n)));
      const double once = xv - x * v1, twice = xxv - x * (2.0 * xv - x * v1);
      if (about2 > 0.0) line = std::max(line, once * once / about2);
      if (about4 > 0.0) arc = std::max(arc, twice * twice / about4);
    }
    const double v = norm * (dv + height - slope * du);
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

// Searches one side of an edge.
class FlankSearch {
public:
  FlankSearch(const Side& side, double radius, double sigma) noexcept
      : side_(side), stretches_(side), radius_(radius), sigma_(sigma) {}

  // The first stretch that is straight and long enough to tell: of `size` samples, or of `few` where they are far apart. Else
  // the first of `few` that is straight, else the straightest of them.
  [[nodiscard]] Flank first_straight(std::uint32_t few, std::uint32_t size, std::uint32_t most_gap) noexcept;
  // A longer stretch beyond a flank that a rounding gave: it still sees what is left of the arc.
  [[nodiscard]] Flank longer_stretch(const Flank& flank) noexcept;

private:
  // Whether an arc of this length and slope would show, up to the radius asked for.
  [[nodiscard]] bool tells(const Stretch& line) const noexcept {
    const double length = side_.length(line), stretch = 1.0 + line.slope * line.slope;
    return length * length * stretch * std::sqrt(stretch) >= 16.0 * sigma_ * radius_;
  }

  const Side& side_;
  Stretches stretches_;
  double radius_, sigma_;
};

Flank FlankSearch::first_straight(std::uint32_t few, std::uint32_t size, std::uint32_t most_gap) noexcept {
  const double limit = straight_limit(few, sigma_), long_limit = straight_limit(size, sigma_);
  Stretch best;
  bool straight = false;
  TurningBack passed;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t gap = 0; gap <= most_gap && stretches_.fits(gap, few); ++gap) {
    const Stretch line = stretches_.fit(gap, few);
    if (line.error <= limit) {
      if (tells(line)) return side_.flank(line, true);
      if (!straight) best = line;
      straight = true;
    } else if (!straight && line.error < least) {
      best = line;
      least = line.error;
    }
    // What is not straight over few samples is less so over more.
    if (size > few && line.error <= long_limit && stretches_.fits(gap, size)) {
      const Stretch longer = stretches_.fit(gap, size);
      if (longer.error <= long_limit) return side_.flank(longer, true);
    }
    if (passed.turns_back(line.slope)) break;
  }
  return best.size > 0 ? side_.flank(best, straight) : Flank{};
}

Flank FlankSearch::longer_stretch(const Flank& flank) noexcept {
  const std::uint32_t size = 2 * flank.samples;
  const double limit = straight_limit(size, sigma_);
  for (std::uint32_t gap = flank.gap; gap <= flank.gap + flank.samples && stretches_.fits(gap, size); ++gap) {
    const Stretch line = stretches_.fit(gap, size);
    if (line.error <= limit) return side_.flank(line, true);
  }
  return flank;
}

double sigma_of(const FitScale& scale) noexcept {
  return scale.noise + 0.0005;
}

} // namespace

Flank find_flank(const Heights& h, std::uint32_t from, std::uint32_t to, std::uint32_t window, std::uint32_t most_gap,
                 const FitScale& scale) {
  constexpr std::uint32_t kFewest = 4;
  constexpr double kFlatter = 3.0; // radius of what is taken for straight against that of the largest rounding
  const Side side(h, from, to);
  const std::uint32_t size = std::min(window, side.count());
  const double sigma = sigma_of(scale);
  const double radius = kFlatter * scale.arc_radius;
  FlankSearch search(side, radius, sigma);
  if (most_gap == 0) return search.first_straight(size, size, 0);
  // The end of a rounding is straight over a short stretch.
  const double telling = std::sqrt(kTelling * scale.arc_radius * sigma) / scale.pitch;
  const auto most = static_cast<std::uint32_t>(std::min(2.0 * size, std::ceil(telling)));
  const std::uint32_t few = std::min(size, std::max(kFewest, size / 3));
  Flank best = search.first_straight(few, std::min(std::max(most, size), side.count()), most_gap);
  if (best.straight && best.gap > 0) best = search.longer_stretch(best);
  constexpr double kSmallRounding = 0.35; // mm
  best.rounded = best.straight && best.gap > 0 && (best.gap >= kLeastGap || best.gap * scale.pitch <= kSmallRounding);
  return best;
}

bool is_chamfered(const Heights& h, std::uint32_t from, std::uint32_t to, const Flank& flank, const FitScale& scale) {
  return flank.gap + 1 >= kLeastGap && is_hinged(Side(h, from, to), flank, sigma_of(scale));
}

} // namespace scansion
