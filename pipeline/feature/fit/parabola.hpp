// Sums of powers over samples, and the parabola that they give.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/fit/line_sums.hpp"

namespace scansion {

/// About the sample in the middle.
template <typename T>
struct BasicPowerSums : BasicLineSums<T> {
  T uuu{}, uuuu{}, uuv{};

  void add(T du, T dv, T count) noexcept {
    BasicLineSums<T>::add(du, dv, count);
    const T square = du * du;
    uuu += square * du;
    uuuu += square * square;
    uuv += square * dv;
  }
};
using PowerSums = BasicPowerSums<double>;

/// v = offset + slope (u - middle) + curvature (u - middle)^2
template <typename T>
struct BasicParabola {
  T curvature{}; ///< second derivative / 2
  T slope{}, middle{}, offset{};
  T error{};          ///< sum of squares, or a rounding error below 0
  T gain{};           ///< by how much that is below the one of the best straight line
  T skew{}, spread{}; ///< of the samples: third moment / second, second / count

  /// How far it runs above the best straight line, and the slope of that.
  [[nodiscard]] T above_line(T u) const noexcept {
    const T x = u - middle;
    return curvature * (x * x - skew * x - spread);
  }
  [[nodiscard]] T slope_above_line(T u) const noexcept { return curvature * (2.0 * (u - middle) - skew); }

  [[nodiscard]] static BasicParabola fit(const BasicPowerSums<T>& m) noexcept {
    BasicParabola p;
    const T none{};
    const T c = m.u / m.n;
    p.middle = c;
    const T s2 = m.uu - c * m.u;
    const T s3 = m.uuu - 3.0 * c * m.uu + 2.0 * c * c * m.u;
    const T s4 = m.uuuu - 4.0 * c * m.uuu + 6.0 * c * c * m.uu - 3.0 * c * c * c * m.u;
    const T mean = m.v / m.n;
    const T uv = m.uv - c * m.v;
    const T uuv = m.uuv - 2.0 * c * m.uv + c * c * m.v; // over (u - c)^2
    const T vv = m.vv - m.v * mean;
    p.skew = s3 / s2;
    p.spread = s2 / m.n;
    const T norm = s4 - s3 * p.skew - s2 * p.spread;
    const T q = uuv - s2 * mean - p.skew * uv;
    p.curvature = norm > 0.0 ? q / norm : none;
    p.slope = (uv - p.curvature * s3) / s2;
    p.offset = mean - p.curvature * p.spread;
    p.gain = q * p.curvature;
    p.error = vv - uv * uv / s2 - p.gain;
    return p;
  }
};
using Parabola = BasicParabola<double>;

} // namespace scansion
