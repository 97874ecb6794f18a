// Where a scan lies and how far its samples are apart.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/reader.hpp"

namespace scansion {

struct ScanOutline {
  std::array<double, 3> low{}, high{}; ///< mm: no point is outside
  std::uint64_t lines = 0, points = 0;
  double step_mm = 0.0;            ///< mean distance of neighbouring points of a run, seen from above
  std::array<double, 2> advance{}; ///< mm in x and y from a line to the next, at right angles to the lines; 0: not known
};

/// Reads every stored point. Memory follows the group. Fails with undecodable when the scan has no point.
[[nodiscard]] Result<ScanOutline> outline_of(RecordingReader& reader);

/// Counts to millimetres.
class Millimetre {
public:
  explicit Millimetre(const Lattice& lattice, Rational resolution) : origin_(lattice.origin), step_(resolution.value()) {}
  [[nodiscard]] std::array<double, 3> position(const LineGroup& group, std::size_t point) const noexcept {
    std::array<double, 3> out{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      out[axis] = static_cast<double>(origin_[axis] + group.xyz[axis][point]) * step_;
    }
    return out;
  }

private:
  std::array<std::int64_t, 3> origin_;
  double step_;
};

} // namespace scansion
