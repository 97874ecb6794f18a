// The inner loops of ruled axes, for vector units.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace scansion::kernels {

/// How far the points of a run lie off multiples of a pitch, in steps.
struct Spread {
  double origin = 0; ///< u of the first point
  double pitch = 0;
  double last = 0;                ///< sample of the last point taken
  double low = 0, high = 0;       ///< of u less the multiple, the first point's 0 included
  double low_at = 0, high_at = 0; ///< samples, the first of equal ones

  /// The point of sample `last`.
  void take(double u) noexcept {
    const double off = (u - origin) - pitch * last;
    if (off < low) {
      low = off;
      low_at = last;
    }
    if (off > high) {
      high = off;
      high_at = last;
    }
  }
};

/// Takes the points that follow each other sample by sample: up to the first of n whose step from the point before it, which is
/// read too, is half a pitch or more off. Returns how many.
[[nodiscard]] std::size_t along_pitch(const std::int32_t* u, std::size_t n, Spread& spread) noexcept;

/// to[i] = first + floor((at + pitch * (i + 1)) / 2^32), modulo 2^32; the product modulo 2^64.
void ruled(std::uint32_t first, std::uint64_t at, std::uint64_t pitch, std::int32_t* to, std::size_t n) noexcept;

} // namespace scansion::kernels
