// The frame in which profiles are looked at: along the scan line, up in its plane, across the lines (docs/FEATURES.md,
// "Frame").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/scan_line.hpp"

#include <array>
#include <cstdint>
#include <span>

namespace scansion {

using Vector3 = std::array<double, 3>;
using Counts = std::array<std::span<const std::int32_t>, 3>; ///< points on the lattice, axis by axis

[[nodiscard]] constexpr double dot(const Vector3& a, const Vector3& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Right-handed: along x up = -normal. `along` is horizontal, `up` has a positive z.
struct Frame {
  Vector3 along{1.0, 0.0, 0.0};  ///< e: the s axis
  Vector3 up{0.0, 0.0, 1.0};     ///< m: the w axis
  Vector3 normal{0.0, 1.0, 0.0}; ///< n: the c axis, towards later lines

  [[nodiscard]] Vector3 position(double s, double w, double c) const noexcept {
    Vector3 p{};
    for (std::size_t i = 0; i < 3; ++i) p[i] = s * along[i] + w * up[i] + c * normal[i];
    return p;
  }
};

/// Finds the frame from the first lines of a scan: the plane that the points of each line share, one direction for all lines.
class FrameFinder {
public:
  static constexpr std::size_t kLines = 16; ///< enough for a frame

  /// Points of one line, `resolution` in any unit of length per count.
  void add(const Counts& xyz, double resolution);
  [[nodiscard]] std::size_t lines() const noexcept { return lines_; }
  /// Lines that are straight, or that show no plane that stands up, get a vertical plane through their direction.
  [[nodiscard]] Frame frame() const;

private:
  std::array<std::array<double, 3>, 3> scatter_{}; // about the middle of each line
  Vector3 first_middle_{}, last_middle_{};
  std::size_t lines_ = 0;
};

} // namespace scansion
