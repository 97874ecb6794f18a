// A finished stretch of a track, or several joined end to end; a very long one goes out in pieces.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/link/track.hpp"
#include "pipeline/feature/profile/frame.hpp"

#include <optional>
#include <vector>

namespace scansion {

/// In the frame of the scan, mm.
struct CurvePoint {
  double s = 0.0, w = 0.0, c = 0.0;
  FeaturePoint feature;
  std::int64_t row = -1; ///< scan line, as counted by the stage; -1: found between lines
};

/// Where a curve hangs on the pieces of a feature line that went out before: the point at this end is theirs too.
struct Seam {
  LineEnd at;
  std::int32_t piece = 0; ///< number of the piece that comes next there
};

struct CurveEnd {
  FeatureEnd why = FeatureEnd::death;
  std::uint64_t awaits = 0; ///< id of a growing track whose next stretch goes on here; 0: none
  std::optional<Seam> seam;
};

struct Curve {
  std::vector<CurvePoint> points;
  bool convex = true;
  bool loop = false;
  CurveEnd front, back;
  std::uint64_t follows = 0; ///< id of a track whose earlier stretch this one goes on from; 0: none
  std::uint64_t order = 0;   ///< when it was made: ties go by it
  // When it goes out, see FeatureLine:
  std::uint64_t id = 0;
  std::int32_t piece = 0;
  std::optional<LineEnd> begins_at, ends_at;
  std::optional<std::uint64_t> partner;
  std::vector<std::uint64_t> junctions;
  std::vector<LineEnd> met_by;

  void reverse();
};

/// The stretches of the first `count` points of a track that were kept, at least `fewest` points each unless they hang on what
/// was shed before or on the points behind.
void cut_stretches(const Track& track, std::size_t count, std::size_t fewest, std::vector<Curve>& out);

/// Whether a feature line has points enough to be published; more are wanted when it turns less.
[[nodiscard]] bool is_enough(const Curve& curve);

/// The end of a curve and which way it points.
struct Tip {
  double s = 0.0, w = 0.0, c = 0.0;
  double ds = 0.0, dc = 0.0; ///< outwards, unit length
};
[[nodiscard]] Tip tip_of(const Curve& curve, bool back);

/// Length in space against a limit in mm.
[[nodiscard]] bool is_shorter(const Curve& curve, double limit) noexcept;

/// Whether a step in plan is no longer than this.
[[nodiscard]] inline bool is_within(double ds, double dc, double reach) noexcept {
  return ds * ds + dc * dc <= reach * reach;
}

} // namespace scansion
