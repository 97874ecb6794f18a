// The smooth surface under a scene's features: an inclined plane with bumps, waves and rosettes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace scansion {

/// amplitude * (1 - r^2)^3 inside an ellipse, twice continuously differentiable; mm, degrees.
struct Bump {
  double x = 0.0, y = 0.0, radius_x = 1.0, radius_y = 1.0, degrees = 0.0, amplitude = 0.0;
};

/// amplitude * sin(2 pi (distance along `degrees` from (x, y)) / length).
struct Wave {
  double x = 0.0, y = 0.0, degrees = 0.0, length = 1.0, amplitude = 0.0;
};

/// A flower of `petals` smooth petals inside a disc; the amplitude is that of the petals' highest point.
struct Rosette {
  double x = 0.0, y = 0.0, radius = 1.0, amplitude = 0.0;
  int petals = 5;
};

class BaseSurface {
public:
  double slope_x = 0.0, slope_y = 0.0; ///< z = slope_x * x + slope_y * y + the parts below

  void add(Bump bump);
  void add(Wave wave);
  void add(Rosette rosette);

  [[nodiscard]] double incline(double x, double y) const noexcept { return slope_x * x + slope_y * y; }
  /// Height above the incline.
  [[nodiscard]] double relief(double x, double y) const noexcept;

private:
  struct BumpPart {
    double x, y, ux, uy, vx, vy, amplitude; // (u, v): the ellipse made a unit circle
  };
  struct WavePart {
    double x, y, ux, uy, amplitude;
  };
  struct RosettePart {
    double x, y, scale, amplitude;
    int petals;
  };
  std::vector<BumpPart> bumps_;
  std::vector<WavePart> waves_;
  std::vector<RosettePart> rosettes_;
};

} // namespace scansion
