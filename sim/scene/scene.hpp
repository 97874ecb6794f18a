// A synthetic part: a smooth base surface and features with exact outlines and cross-sections, and how it is scanned by
// default.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/scene/base_surface.hpp"
#include "sim/scene/footprint.hpp"
#include "sim/scene/profile.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace scansion {

/// Height added to the surface: a function of the distance from an outline alone.
class Feature {
public:
  Feature(const Footprint& footprint, Profile profile)
      : footprint_(footprint), profile_(std::move(profile)), box_(footprint.box(profile_.reach())) {}

  /// mm; 0 away from a bounded feature.
  [[nodiscard]] double height(double x, double y) const noexcept {
    return box_.holds(x, y) ? profile_.height(footprint_.distance(x, y)) : 0.0;
  }

  [[nodiscard]] const Footprint& footprint() const noexcept { return footprint_; }
  [[nodiscard]] const Profile& profile() const noexcept { return profile_; }
  [[nodiscard]] const Box& box() const noexcept { return box_; }

private:
  Footprint footprint_;
  Profile profile_;
  Box box_;
};

/// A hole through the part: nothing inside its outline is there to be measured, nor is its wall.
struct Hole {
  Footprint outline;  ///< a box
  double depth = 5.0; ///< mm, of its wall
};

/// What a sample's number in its line adds to its height: adversarial lines that no surface would give.
enum class Texture : std::uint8_t {
  none,
  zigzag,  ///< up and down by `texture_um` from sample to sample
  two_step ///< 0 or `texture_um`, by a seeded coin
};

/// What part of the scan window's width a line takes, for t = 0 (first line) to 1 (last line): the part's silhouette.
struct LineSpan {
  double centre = 0.0; ///< offset from the window's middle, share of its length
  double length = 1.0; ///< share of the window's length
};

/// Immutable once made; reentrant.
struct Scene {
  std::string name;
  std::string summary; ///< one line for a person

  double length_x = 100.0, length_y = 80.0; ///< the part lies in [0, length_x] x [0, length_y], mm; its base goes on beyond
  std::uint32_t lines = 400;
  std::uint32_t points = 1000;               ///< of a line that spans the whole window
  std::optional<std::uint64_t> total_points; ///< of the whole scan, when lines follow the part's silhouette
  double noise_um = 5.0;                     ///< default sigma

  BaseSurface base;
  std::vector<Feature> features;
  std::vector<Hole> holes;
  double relief_low = 0.0, relief_high = 0.0; ///< bounds of the height above the base's incline, mm
  Texture texture = Texture::none;
  double texture_um = 0.0;
  LineSpan (*span)(double t) noexcept = nullptr; ///< empty: every line spans the window

  /// The hole at a place in plan, if there is one.
  [[nodiscard]] const Hole* hole_at(double x, double y) const noexcept {
    for (const Hole& hole : holes)
      if (hole.outline.distance(x, y) < 0.0) return &hole;
    return nullptr;
  }

  /// Height above the base's incline at a place in plan, mm; finite everywhere.
  [[nodiscard]] double relief(double x, double y) const noexcept {
    double z = base.relief(x, y);
    for (const Feature& feature : features) z += feature.height(x, y);
    return z;
  }
  [[nodiscard]] double height(double x, double y) const noexcept { return base.incline(x, y) + relief(x, y); }
};

} // namespace scansion
