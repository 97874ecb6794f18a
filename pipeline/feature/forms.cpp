// Rules over shares of a patch's border, first that fits.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/forms.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace scansion {

namespace {

struct Outline {
  double convex = 0.0, concave = 0.0; ///< length by polarity as seen from the patch
  double open = 0.0, backed = 0.0, cut = 0.0;
  double level = 0.0;             ///< mean height above the neighbours, by border length; 0 where only creases border
  double longest_two = 0.0;       ///< share of the two longest borders
  double larger_neighbours = 0.0; ///< length of border with patches that are larger
  [[nodiscard]] double all() const noexcept { return cut + open; }
};

Outline outline_of(PatchGraph& graph, std::uint32_t id) {
  Outline o;
  const double own = graph.node(id).sums.count();
  std::vector<double> lengths;
  for (const auto& [other, border] : graph.borders_of(id)) {
    const double length = border.total();
    const double height = length > 0.0 ? border.height / length : 0.0;
    // Across a step the higher patch sees a convex edge, the lower one a concave edge.
    o.convex += border.length[0] + (height > 0.0 ? border.length[2] : 0.0);
    o.concave += border.length[1] + (height > 0.0 ? 0.0 : border.length[2]);
    o.backed += border.backed;
    o.cut += length;
    o.level += border.height;
    lengths.push_back(length);
    if (graph.knows(other) && graph.node(other).sums.count() > own) o.larger_neighbours += length;
  }
  o.open = graph.node(id).open;
  if (o.cut > 0.0) o.level /= o.cut;
  std::sort(lengths.rbegin(), lengths.rend());
  for (std::size_t i = 0; i < std::min<std::size_t>(2, lengths.size()); ++i) o.longest_two += lengths[i];
  if (o.all() > 0.0) o.longest_two /= o.all();
  return o;
}

} // namespace

Labelled label_patch(PatchGraph& graph, std::uint32_t id, const Patch& patch, const Sampling& sampling) {
  const Outline o = outline_of(graph, id);
  Labelled out;
  out.confidence = o.cut > 0.0 ? std::min(1.0, o.backed / o.cut) : 0.0;
  if (o.all() <= 0.0 || o.cut <= 0.0) return out;
  const double convex = o.convex / o.all(), concave = o.concave / o.all(), open = o.open / o.all();
  // Length and width of a strip of that area and outline.
  const double half = 0.5 * o.all();
  const double root = std::sqrt(std::max(0.0, half * half / 4.0 - patch.area_mm2));
  const double length = half / 2.0 + root, width = std::max(1e-9, half / 2.0 - root);
  const double slope = std::acos(std::clamp(std::abs(patch.normal[2]), 0.0, 1.0)) * 180.0 / std::numbers::pi;
  constexpr double kMost = 0.8, kSteep = 45.0, kLong = 4.0, kEnds = 0.35, kShut = 0.05;
  const double narrow = std::max(2.0, 3.0 * sampling.coarse());
  const bool between = o.longest_two > 0.6 && o.larger_neighbours > 0.6 * o.cut;
  if (width < narrow && length / width >= 3.0 && between && std::max(convex, concave) >= 0.7)
    out.kind = patch.shape == PatchShape::plane ? FormKind::chamfer : FormKind::fillet;
  else if (slope >= kSteep && convex >= 0.2 && concave >= 0.2)
    out.kind = FormKind::wall;
  else if (convex >= kMost * (1.0 - open) && o.level >= 0.0 && open <= kEnds && length / width >= kLong)
    out.kind = FormKind::rib;
  else if (convex >= kMost && open <= kShut)
    out.kind = FormKind::boss;
  else if (concave >= kMost * (1.0 - open) && o.level <= 0.0 && open <= kEnds && length / width >= kLong)
    out.kind = FormKind::slot;
  else if (concave >= kMost && open <= kShut)
    out.kind = FormKind::pocket;
  return out;
}

} // namespace scansion
