// Sums over samples that give straight lines, and directions of lines without their angles.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace scansion {

/// u along, v up, both from a sample nearby: sums over whole places would lose digits. Numbers, or pairs of them: one a side.
template <typename T>
struct BasicLineSums {
  T n{}, u{}, v{}, uu{}, uv{}, vv{};

  void add(T du, T dv, T count) noexcept {
    n += count;
    u += du;
    v += dv;
    uu += du * du;
    uv += du * dv;
    vv += dv * dv;
  }
};
using LineSums = BasicLineSums<double>;

/// Of a line that does not run backwards: the cosine is not negative.
struct Direction {
  double cosine = 1.0, sine = 0.0;

  [[nodiscard]] static Direction of_slope(double slope) noexcept {
    const double cosine = 1.0 / std::sqrt(1.0 + slope * slope);
    return {cosine, slope * cosine};
  }
  [[nodiscard]] double angle() const noexcept { return std::atan(sine / cosine); } ///< radians
};

/// From one direction to the next, within half a turn each way; angles are compared without finding them.
struct Turning {
  double cosine = 1.0, sine = 0.0;

  [[nodiscard]] static Turning between(const Direction& before, const Direction& after) noexcept {
    return {before.cosine * after.cosine + before.sine * after.sine, before.cosine * after.sine - before.sine * after.cosine};
  }
  [[nodiscard]] bool clockwise() const noexcept { return sine < 0.0; }
  /// Whether it turns by more than this, in radians, either way.
  [[nodiscard]] bool exceeds(double angle) const noexcept {
    const double size = std::abs(sine);
    if (size > angle) return true;
    if (cosine > 0.0 && size <= angle * cosine) return false;
    return std::atan2(size, cosine) > angle;
  }
  /// Whether it turns by less than another one of the same sense.
  [[nodiscard]] bool is_less_than(const Turning& other) const noexcept {
    return std::abs(other.sine) * cosine - other.cosine * std::abs(sine) > 0.0;
  }
  [[nodiscard]] double tangent_of_half() const noexcept { return std::abs(sine) / (1.0 + cosine); }
};

} // namespace scansion
