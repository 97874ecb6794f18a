// Cross-section of a feature.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scansion {
namespace {

constexpr double kVertical = std::numeric_limits<double>::infinity();
constexpr double kWallSlope = 2.7474774194546216; // tan 70 degrees

struct Direction {
  double d = 0.0, z = 0.0;
};

Direction direction(const Corner& from, const Corner& to) noexcept {
  const double d = to.d - from.d;
  const double z = to.z - from.z;
  const double length = std::sqrt(d * d + z * z);
  return length > 0.0 ? Direction{d / length, z / length} : Direction{1.0, 0.0};
}

} // namespace

Profile::Profile(std::initializer_list<Corner> corners) {
  if (corners.size() == 0) return;
  find_bends(corners);
  const Corner* at = corners.begin();
  first_ = at->z;
  start_ = at->d;
  Corner here = *at;
  for (std::size_t k = 1; k < corners.size(); ++k) {
    const Corner& corner = at[k];
    if (k + 1 == corners.size() || !(corner.radius > 0.0)) {
      add_line(here.d, here.z, corner.d, corner.z);
      here = corner;
      continue;
    }
    const Direction in = direction(at[k - 1], corner);
    const Direction out = direction(corner, at[k + 1]);
    const double cosine = in.d * out.d + in.z * out.z;
    const double tangent = corner.radius * std::sqrt((1.0 - cosine) / (1.0 + cosine));
    const double turn = in.d * out.z - in.z * out.d > 0.0 ? 1.0 : -1.0; // +1: to the left, the corner is concave
    const Corner from{corner.d - tangent * in.d, corner.z - tangent * in.z, 0.0};
    const Corner to{corner.d + tangent * out.d, corner.z + tangent * out.z, 0.0};
    add_line(here.d, here.z, from.d, from.z);
    Piece arc;
    arc.end = to.d;
    arc.d = from.d - turn * corner.radius * in.z;
    arc.z = from.z + turn * corner.radius * in.d;
    arc.square = corner.radius * corner.radius;
    arc.side = -turn;
    pieces_.push_back(arc);
    here = to;
  }
  last_ = here.z;
  // A flat tail is what lies beyond the feature: without it reach() is tight.
  while (!pieces_.empty() && pieces_.back().square == 0.0 && pieces_.back().slope == 0.0 && pieces_.back().z == last_) {
    pieces_.pop_back();
  }
}

void Profile::find_bends(std::initializer_list<Corner> corners) {
  const auto slope = [](const Corner& from, const Corner& to) {
    if (to.d > from.d) return (to.z - from.z) / (to.d - from.d);
    return to.z > from.z ? kVertical : -kVertical;
  };
  const auto wall = [&](const Corner& from, const Corner& to) {
    return std::fabs(slope(from, to)) >= kWallSlope ? std::fabs(to.z - from.z) : 0.0;
  };
  const Corner* at = corners.begin();
  const std::size_t last = corners.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    ProfileBend bend{at[k].d, at[k].z, 0.0, 0.0, 0.0, 0.0};
    if (k > 0 && k < last) bend.radius = at[k].radius;
    if (k > 0) {
      bend.slope_inside = slope(at[k - 1], at[k]);
      bend.wall = wall(at[k - 1], at[k]);
    }
    if (k < last) {
      bend.slope_outside = slope(at[k], at[k + 1]);
      bend.wall = std::max(bend.wall, wall(at[k], at[k + 1]));
    }
    if (bend.slope_inside != bend.slope_outside) bends_.push_back(bend);
  }
}

Profile Profile::wall(double height, double draft, double outer, double inner) {
  const double room = std::fabs(height) + draft + outer + inner + 1.0; // more than any tangent's length
  return Profile{{-draft - room, height}, {-draft, height, inner}, {0.0, 0.0, outer}, {room, 0.0}};
}

void Profile::add_line(double d0, double z0, double d1, double z1) {
  if (!(d1 > d0)) return; // a vertical wall is the jump between its neighbours
  Piece line;
  line.end = d1;
  line.d = d0;
  line.z = z0;
  line.slope = (z1 - z0) / (d1 - d0);
  pieces_.push_back(line);
}

double Profile::slope(double d) const noexcept {
  if (d < start_) return 0.0;
  for (const Piece& piece : pieces_) {
    if (d >= piece.end) continue;
    if (piece.square == 0.0) return piece.slope;
    const double offset = d - piece.d;
    return -piece.side * offset / std::sqrt(std::max(1e-12, piece.square - offset * offset));
  }
  return 0.0;
}

double Profile::height(double d) const noexcept {
  if (d < start_) return first_;
  for (const Piece& piece : pieces_) {
    if (d >= piece.end) continue;
    if (piece.square == 0.0) return piece.z + piece.slope * (d - piece.d);
    const double offset = d - piece.d;
    return piece.z + piece.side * std::sqrt(std::max(0.0, piece.square - offset * offset));
  }
  return last_;
}

} // namespace scansion
