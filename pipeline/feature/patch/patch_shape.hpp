// Sums over the samples of a patch: area, plane, quadric.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_line.hpp"
#include "pipeline/feature/patch/row_samples.hpp"
#include "pipeline/feature/profile/frame.hpp"
#include "pipeline/feature/profile/sampling.hpp"

#include <array>
#include <cstdint>
#include <utility>

namespace scansion {

/// w over (s, c) by least squares, mm.
struct PatchPlane {
  double s = 0.0, c = 0.0, w = 0.0; ///< centroid
  double gs = 0.0, gc = 0.0;        ///< slopes
  [[nodiscard]] double at(double s_at, double c_at) const noexcept { return w + gs * (s_at - s) + gc * (c_at - c); }
};

/// A stretch of a row.
struct RowStretch {
  const RowPlaces& s;
  const RowHeights& w;
  std::size_t first = 0, count = 0;
};

/// Power sums of (s, c, w), mm. Adding runs and adding sums of other patches give the same.
class PatchSums {
public:
  /// Samples of one scan line at c.
  void add(const RowStretch& samples, double c) noexcept;
  void add(const PatchSums& other) noexcept;
  [[nodiscard]] double count() const noexcept { return s_[0][0]; }
  [[nodiscard]] PatchPlane plane() const noexcept;
  /// Length and width of the rectangle in plan with the same spread.
  [[nodiscard]] std::pair<double, double> box() const noexcept;
  /// Degrees by which it turns across its width, as its quadric has it; 0 where a plane does as well in this noise (mm).
  [[nodiscard]] double turning(double noise) const;
  /// How much worse one quadric fits the samples of both than one each: mean square for a sample of the smaller one, in units
  /// of what lies about their own quadrics and of the noise (mm). Up to about 2 both lie on one surface.
  [[nodiscard]] double misfit_with(const PatchSums& other, double noise) const;
  /// Fills shape, area, centroid, normal and residuals.
  void describe(const Frame& frame, const Sampling& sampling, const Vector3& origin, Patch& out) const;

private:
  struct Quadric;
  [[nodiscard]] Quadric quadric() const noexcept;
  [[nodiscard]] double moment(std::size_t i, std::size_t j, double s0, double c0) const noexcept;
  [[nodiscard]] double lifted(std::size_t i, std::size_t j, double s0, double c0, double w0) const noexcept;

  std::array<std::array<double, 5>, 5> s_{}; // [i][j]: sum of s^i c^j, i + j <= 4
  std::array<std::array<double, 3>, 3> w_{}; // sum of w s^i c^j, i + j <= 2
  double ww_ = 0.0;
};

} // namespace scansion
