// The smooth surface under a scene's features.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/base_surface.hpp"

#include "sim/scene/portable_math.hpp"

namespace scansion {
namespace {

double cube(double value) noexcept {
  return value * value * value;
}

} // namespace

void BaseSurface::add(Bump bump) {
  const SinCos turn = portable_sincos_degrees(bump.degrees);
  bumps_.push_back({bump.x, bump.y, turn.cos / bump.radius_x, turn.sin / bump.radius_x, -turn.sin / bump.radius_y,
                    turn.cos / bump.radius_y, bump.amplitude});
}

void BaseSurface::add(Wave wave) {
  constexpr double kTwoPi = 6.28318530717958647692;
  const SinCos turn = portable_sincos_degrees(wave.degrees);
  waves_.push_back({wave.x, wave.y, kTwoPi / wave.length * turn.cos, kTwoPi / wave.length * turn.sin, wave.amplitude});
}

void BaseSurface::add(Rosette rosette) {
  // Re(w^n) (1 - |w|^2)^3 is largest where |w|^2 = n / (n + 6): this makes the amplitude that of the petals' top.
  const double best = static_cast<double>(rosette.petals) / (rosette.petals + 6.0);
  double top = cube(1.0 - best);
  for (int k = 0; k < rosette.petals / 2; ++k) top *= best;
  rosettes_.push_back({rosette.x, rosette.y, 1.0 / rosette.radius, rosette.amplitude / top, rosette.petals});
}

double BaseSurface::relief(double x, double y) const noexcept {
  double z = 0.0;
  for (const BumpPart& bump : bumps_) {
    const double dx = x - bump.x;
    const double dy = y - bump.y;
    const double u = dx * bump.ux + dy * bump.uy;
    const double v = dx * bump.vx + dy * bump.vy;
    const double square = u * u + v * v;
    if (square < 1.0) z += bump.amplitude * cube(1.0 - square);
  }
  for (const WavePart& wave : waves_) {
    z += wave.amplitude * portable_sin((x - wave.x) * wave.ux + (y - wave.y) * wave.uy);
  }
  for (const RosettePart& rosette : rosettes_) {
    const double u = (x - rosette.x) * rosette.scale;
    const double v = (y - rosette.y) * rosette.scale;
    const double square = u * u + v * v;
    if (square >= 1.0) continue;
    double re = 1.0; // (u + i v)^petals: the petals need no arc tangent
    double im = 0.0;
    for (int k = 0; k < rosette.petals; ++k) {
      const double next = re * u - im * v;
      im = re * v + im * u;
      re = next;
    }
    z += rosette.amplitude * re * cube(1.0 - square);
  }
  return z;
}

} // namespace scansion
