// The part that a patch plays among its neighbours, by the shares of its outline (docs/FEATURES.md, "Forms").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/patch/patch_graph.hpp"
#include "pipeline/feature/profile/sampling.hpp"

#include <unordered_map>
#include <vector>

namespace scansion {

enum class Role : std::uint8_t {
  face,
  top,    ///< falls off all round
  floor,  ///< rises all round
  trough, ///< falls off from its rim, but sags below it: a rounded or pointed bottom without walls
  bulge,  ///< rises from its rim
  flank,  ///< slopes from an edge where it is high to one where it is low
  strip   ///< beside a larger face, which it rounds or bevels
};

/// Lengths in mm. What a patch encloses is no part of its outline, but stated beside it.
struct Outline {
  double high = 0.0; ///< where the other side falls off from here: convex creases, steps down
  double low = 0.0;
  double open = 0.0; ///< the end of the data
  double backed = 0.0;
  double sag = 0.0;                               ///< height of the rim above the patch's plane
  double enclosed_high = 0.0, enclosed_low = 0.0; ///< borders with patches that it encloses
  double drop = 0.0;                              ///< from where it is high to where it is low

  [[nodiscard]] double cut() const noexcept { return high + low; }
  [[nodiscard]] double all() const noexcept { return high + low + open; }
};

/// Where the other side falls off, and where it rises.
[[nodiscard]] double high_of(const Border& border) noexcept;
[[nodiscard]] double low_of(const Border& border) noexcept;

struct PatchLook {
  Outline outline;
  PatchPlane plane;
  double length = 0.0, width = 0.0; ///< mm, in plan
  Role role = Role::face;
  [[nodiscard]] bool is_long() const noexcept;
};

/// Degrees between two planes.
[[nodiscard]] double angle_between(const PatchPlane& a, const PatchPlane& b) noexcept;

/// A patch that another leads to.
struct Level {
  std::uint32_t patch = 0;
  std::vector<std::uint32_t> over; ///< the flanks and strips between, from the other patch on; none when they are neighbours
  double border = 0.0;             ///< mm of the other patch's border that leads there
  double fall = 0.0;               ///< mm from rim to rim beyond what both slope, above 0 when it lies lower
};

/// Looks at each patch once, for as long as the patches and their borders stay as they are.
class PatchLooks {
public:
  PatchLooks(const PatchGraph& graph, const Sampling& sampling) : graph_(graph), sampling_(sampling) {}

  [[nodiscard]] const PatchLook& of(std::uint32_t id);
  /// Neighbours, and what lies beyond those that are flanks or strips, up to two in a row.
  [[nodiscard]] const std::vector<Level>& levels_around(std::uint32_t id);

private:
  const PatchGraph& graph_;
  const Sampling& sampling_;
  std::unordered_map<std::uint32_t, PatchLook> looks_; // references stay good
  std::unordered_map<std::uint32_t, std::vector<Level>> levels_;
};

} // namespace scansion
