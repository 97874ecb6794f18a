// Cross-section of a feature: height over the distance from its outline, of lines, arcs and vertical walls.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <vector>

namespace scansion {

/// One corner of a cross-section, mm. `radius` > 0 rounds the corner with an arc tangent to both sides.
struct Corner {
  double d = 0.0; ///< signed distance from the outline, negative inside
  double z = 0.0;
  double radius = 0.0;
};

/// A bend of a cross-section: where its flanks meet, whatever rounds it. Slopes are dz/dd, infinite for a vertical wall.
struct ProfileBend {
  double d = 0.0, z = 0.0, radius = 0.0;
  double slope_inside = 0.0, slope_outside = 0.0;
  double wall = 0.0; ///< height of the wall that ends here, mm; 0 when neither flank is steeper than 70 degrees
};

/// A curve z(d), constant beyond its ends. Two corners with the same d are a vertical wall. Pieces are kept apart, so the
/// borders between them (walls, creases, ends of fillets) are known exactly.
class Profile {
public:
  /// Corners in ascending d. A radius must leave room on both sides, at the ends radii are ignored.
  Profile(std::initializer_list<Corner> corners);

  /// A wall of `height` (negative: down) inside the outline; its foot is `draft` mm nearer to the middle than its top.
  /// `outer` rounds the corner at the outline, `inner` the one inside.
  [[nodiscard]] static Profile wall(double height, double draft = 0.0, double outer = 0.0, double inner = 0.0);

  [[nodiscard]] double height(double d) const noexcept;
  /// Of the curve itself, between its bends; 0 beyond its ends.
  [[nodiscard]] double slope(double d) const noexcept;
  /// In ascending d; corners that bend nothing are left out.
  [[nodiscard]] const std::vector<ProfileBend>& bends() const noexcept { return bends_; }
  /// From here outwards the height is constant.
  [[nodiscard]] double reach() const noexcept { return pieces_.empty() ? 0.0 : pieces_.back().end; }

private:
  struct Piece {
    double end = 0.0; // the piece covers distances below this, down to the piece before
    double d = 0.0;   // line: where z is `z`; arc: centre
    double z = 0.0;
    double slope = 0.0;  // line
    double square = 0.0; // arc: radius squared; 0 for a line
    double side = 0.0;   // arc: +1 upper half (convex), -1 lower half (concave)
  };
  void add_line(double d0, double z0, double d1, double z1);

  void find_bends(std::initializer_list<Corner> corners);

  std::vector<Piece> pieces_;
  std::vector<ProfileBend> bends_;
  double first_ = 0.0, start_ = 0.0, last_ = 0.0; // height before start_ and beyond the last piece
};

} // namespace scansion
