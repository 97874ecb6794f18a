// Sums of powers over samples, and the parabola that they give.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/line_sums.hpp"

#include <algorithm>

namespace scansion {

/// About the sample in the middle.
struct PowerSums : LineSums {
  double uuu = 0.0, uuuu = 0.0, uuv = 0.0;

  void add(double du, double dv) noexcept {
    LineSums::add(du, dv);
    const double square = du * du;
    uuu += square * du;
    uuuu += square * square;
    uuv += square * dv;
  }
};

/// v = offset + slope (u - middle) + curvature (u - middle)^2
struct Parabola {
  double curvature = 0.0; ///< second derivative / 2
  double slope = 0.0, middle = 0.0, offset = 0.0;
  double error = 0.0;              ///< sum of squares
  double gain = 0.0;               ///< by how much that is below the one of the best straight line
  double skew = 0.0, spread = 0.0; ///< of the samples: third moment / second, second / count

  /// How far it runs above the best straight line, and the slope of that.
  [[nodiscard]] double above_line(double u) const noexcept {
    const double x = u - middle;
    return curvature * (x * x - skew * x - spread);
  }
  [[nodiscard]] double slope_above_line(double u) const noexcept { return curvature * (2.0 * (u - middle) - skew); }

  [[nodiscard]] static Parabola fit(const PowerSums& m) noexcept {
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
    p.gain = norm > 0.0 ? q * q / norm : 0.0;
    p.error = std::max(0.0, vv - uv * uv / s2 - p.gain);
    p.skew = s3 / s2;
    p.spread = s2 / m.n;
    return p;
  }
};

} // namespace scansion
