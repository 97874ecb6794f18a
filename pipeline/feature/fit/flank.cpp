// Least squares over stretches that move away from the edge.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/fit/flank.hpp"

#include "pipeline/feature/fit/pair.hpp"
#include "pipeline/feature/passes/fastest.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace scansion {

namespace {

constexpr std::uint32_t kBeyond = 3; // samples by which the end of a rounding may be missed

// A line through `size` samples, `gap` samples from the edge.
struct Stretch {
  std::uint32_t gap = 0, size = 0;
  Pair middle{};                   // along and up from the edge
  double slope = 0.0, error = 0.0; // sum of squares
};

// Lines through few samples and through many, which begin together.
struct FewAndMany {
  Pair slope, error; // sums of squares times the counts: divisions take longer than all else
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
  struct Walk {
    const double *s, *w;
    std::ptrdiff_t step;
  };
  [[nodiscard]] Walk from(std::uint32_t i) const noexcept {
    const std::ptrdiff_t at = step_ * static_cast<std::ptrdiff_t>(i);
    return {s_ + at, w_ + at, step_};
  }
  [[nodiscard]] Flank flank(const Stretch& line, bool straight) const noexcept {
    return {*s_ + line.middle[0], *w_ + line.middle[1], line.slope, length(line.gap, line.size), line.size, line.gap, straight};
  }
  [[nodiscard]] double length(std::uint32_t gap, std::uint32_t size) const noexcept {
    return std::abs(s(gap + size - 1) - s(gap));
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

  explicit Stretches(const Side& side) noexcept : side_(side), count_(std::min(side.count(), kMost)) { sums_[0] = Sums{}; }
  [[nodiscard]] bool fits(std::uint32_t gap, std::uint32_t size) const noexcept { return gap + size <= count_; }
  [[nodiscard]] Stretch fit(std::uint32_t gap, std::uint32_t size) noexcept {
    make(gap + size);
    const Sums &from = sums_[gap], &to = sums_[gap + size];
    const Pair once = to.once - from.once, middle = once / size;
    if (size < 3) return {gap, size, middle, 0.0, 0.0};
    const Pair square = to.square - from.square - middle * once;
    const double uv = to.uv - from.uv - middle[1] * once[0];
    const double slope = square[0] > 0.0 ? uv / square[0] : 0.0;
    return {gap, size, middle, slope, std::max(0.0, square[1] - slope * uv)};
  }
  // The second one ends where the samples do.
  [[nodiscard]] FewAndMany fit_both(std::uint32_t gap, std::uint32_t few, std::uint32_t many) noexcept {
    constexpr double kNothing = 1e-300;
    const std::uint32_t end = std::min(gap + many, count_);
    make(end);
    const Sums &from = sums_[gap], &a = sums_[gap + few], &b = sums_[end];
    const Pair n{static_cast<double>(few), static_cast<double>(many)};
    const Pair once_a = a.once - from.once, once_b = b.once - from.once;
    const Pair square_a = n[0] * (a.square - from.square) - once_a * once_a;
    const Pair square_b = n[1] * (b.square - from.square) - once_b * once_b;
    const Pair uu = __builtin_shufflevector(square_a, square_b, 0, 2), vv = __builtin_shufflevector(square_a, square_b, 1, 3);
    const Pair u = __builtin_shufflevector(once_a, once_b, 0, 2), v = __builtin_shufflevector(once_a, once_b, 1, 3);
    const Pair uv = n * (Pair{a.uv, b.uv} - from.uv) - u * v;
    const Pair slope = uv / larger(uu, both(kNothing));
    return {slope, vv - slope * uv};
  }

private:
  struct Sums {
    Pair once, square; // of u, v
    double uv;
  };
  void make(std::uint32_t end) noexcept {
    constexpr std::uint32_t kAtOnce = 4;
    if (made_ < end) extend(made_ == 0 ? end : std::min(end + kAtOnce, count_));
  }
  void extend(std::uint32_t end) noexcept {
    const Pair origin{side_.s(0), side_.w(0)};
    Sums* to = &sums_[made_];
    Sums sums = *to;
    const auto [s, w, step] = side_.from(made_);
    std::ptrdiff_t i = 0;
    for (std::uint32_t left = end - made_; left > 0; --left, i += step) {
      const Pair off = Pair{s[i], w[i]} - origin;
      sums.once += off;
      sums.square += off * off;
      sums.uv += off[0] * off[1];
      *++to = sums;
    }
    made_ = end;
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
    if (high_ - low_ <= kNever) return false;
    return (is_above(high_, slope, kBack) && is_above(high_, first_, kMove)) ||
           (is_above(slope, low_, kBack) && is_above(first_, low_, kMove));
  }

private:
  static constexpr double kMove = 0.0701, kBack = 0.266; // tangents of 4 and 15 degrees
  static constexpr double kNever = 0.26;                 // slopes less apart are so by less than 15 degrees, wherever they are
  double first_ = 0.0, low_ = 0.0, high_ = 0.0;          // slopes
  bool any_ = false;
};

// Searches one side of an edge.
class FlankSearch {
public:
  FlankSearch(const Side& side, double radius, double sigma) noexcept
      : side_(side), stretches_(side), radius_(radius), sigma_(sigma) {}

  // The stretch of `size` samples beside the edge.
  [[nodiscard]] Flank beside(std::uint32_t size) noexcept;
  // The first stretch that is straight and long enough to tell: of `many` samples, or of `few` where they are far apart. Else
  // the first of `few` that is straight, else the straightest of them.
  [[nodiscard]] Flank first_straight(std::uint32_t few, std::uint32_t many, std::uint32_t most_gap) noexcept;
  // A longer stretch beyond a flank that a rounding gave: it still sees what is left of the arc.
  [[nodiscard]] Flank longer_stretch(const Flank& flank) noexcept;

private:
  // Whether an arc of this length and slope would show, up to the radius asked for.
  [[nodiscard]] bool tells(double length, double slope) const noexcept {
    const double stretch = 1.0 + slope * slope, square = length * length, least = 16.0 * sigma_ * radius_;
    return square * square * (stretch * stretch * stretch) >= least * least;
  }

  const Side& side_;
  Stretches stretches_;
  double radius_, sigma_;
};

Flank FlankSearch::beside(std::uint32_t size) noexcept {
  const Stretch line = stretches_.fit(0, size);
  return side_.flank(line, line.error <= straight_limit(size, sigma_));
}

Flank FlankSearch::first_straight(std::uint32_t few, std::uint32_t many, std::uint32_t most_gap) noexcept {
  const Pair limit{few * straight_limit(few, sigma_), many * straight_limit(many, sigma_)};
  std::uint32_t best = 0;
  bool straight = false;
  TurningBack passed;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t gap = 0; gap <= most_gap && stretches_.fits(gap, few); ++gap) {
    const FewAndMany line = stretches_.fit_both(gap, few, many);
    const bool is_straight = line.error[0] <= limit[0];
    if (is_straight && tells(side_.length(gap, few), line.slope[0])) return side_.flank(stretches_.fit(gap, few), true);
    if (!straight && (is_straight || line.error[0] < least)) {
      best = gap;
      least = line.error[0];
      straight = is_straight;
    }
    if (line.error[1] <= limit[1] && many > few && stretches_.fits(gap, many))
      return side_.flank(stretches_.fit(gap, many), true);
    if (passed.turns_back(line.slope[0])) break;
  }
  return side_.flank(stretches_.fit(best, few), straight);
}

Flank FlankSearch::longer_stretch(const Flank& flank) noexcept {
  const std::uint32_t size = 2 * flank.samples;
  const double limit = straight_limit(size, sigma_);
  // All of them hold the samples right behind it.
  if (!stretches_.fits(flank.gap, size) || stretches_.fit(flank.gap + flank.samples, flank.samples).error > limit) return flank;
  for (std::uint32_t gap = flank.gap; gap <= flank.gap + flank.samples && stretches_.fits(gap, size); ++gap) {
    const Stretch line = stretches_.fit(gap, size);
    if (line.error <= limit) return side_.flank(line, true);
  }
  return flank;
}

Flank find_flank_body(const Heights& h, std::uint32_t from, std::uint32_t to, std::uint32_t window, std::uint32_t most_gap,
                      const FitScale& scale) {
  constexpr std::uint32_t kFewest = 4;
  constexpr double kFlatter = 3.0; // radius of what is taken for straight against that of the largest rounding
  const Side side(h, from, to);
  const std::uint32_t size = std::min(window, side.count());
  const double sigma = scale.sigma();
  const double radius = kFlatter * scale.arc_radius;
  FlankSearch search(side, radius, sigma);
  if (most_gap == 0 || size < 3) return search.beside(size);
  // The end of a rounding is straight over a short stretch.
  const std::uint32_t many = std::max(size, std::min({2 * size, scale.telling_flank, side.count()}));
  const std::uint32_t few = std::min(size, std::max(kFewest, size / 3));
  Flank best = search.first_straight(few, many, most_gap);
  if (best.straight && best.gap > 0) best = search.longer_stretch(best);
  constexpr double kSmallRounding = 0.35; // mm
  best.rounded = best.straight && best.gap > 0 && (best.gap >= kLeastGap || best.gap * scale.pitch <= kSmallRounding);
  return best;
}

} // namespace

Flank find_flank(const Heights& h, std::uint32_t from, std::uint32_t to, std::uint32_t window, std::uint32_t most_gap,
                 const FitScale& scale) {
  return passes::fastest<find_flank_body>(h, from, to, window, most_gap, scale);
}

namespace {

bool is_chamfered_body(const Heights& h, std::uint32_t from, std::uint32_t to, const Flank& flank, const FitScale& scale) {
  return flank.gap + 1 >= kLeastGap && is_hinged(Side(h, from, to), flank, scale.sigma());
}

} // namespace

bool is_chamfered(const Heights& h, std::uint32_t from, std::uint32_t to, const Flank& flank, const FitScale& scale) {
  return passes::fastest<is_chamfered_body>(h, from, to, flank, scale);
}

} // namespace scansion
