// A recorded scan as a surface: heights between its points.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/player/line_source.hpp"

namespace scansion::sim::grbl {

/// Linear between neighbouring points of a run and between neighbouring lines. At a point of the scan it is that point's
/// height. Lines lie along x or y; points of a run are taken in the order of their coordinate. Reentrant.
class ScanSurface {
public:
  /// Reads all lines. Fails with usage when there is no point.
  [[nodiscard]] static Result<ScanSurface> read(LineSource& source);
  /// mm; -infinity beside the scan and where points are missing.
  [[nodiscard]] double height(double x, double y) const noexcept;

private:
  struct Knot {
    double along = 0.0, z = 0.0;
    bool starts_run = false;
  };
  struct Line {
    double across = 0.0;
    std::vector<Knot> knots;
  };
  [[nodiscard]] static double height(const Line& line, double along) noexcept;
  static Line make_line(const PlayedLine& points, bool is_along_y);

  std::vector<Line> lines_; ///< by `across`
  bool is_along_y_ = false;
};

} // namespace scansion::sim::grbl
