// Cells of a scene.
// SPDX-License-Identifier: Apache-2.0
#include "sim/truth/cells.hpp"

#include "sim/truth/curves.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {
namespace {

constexpr double kOnWall = 0.002;      // mm in plan; places are whole micrometres
constexpr double kBetween = 0.02;      // mm of height; nearer to top or bottom is no place on the wall's face
constexpr double kBeside = 0.05;       // mm in plan: far enough from an edge to tell its sides apart
constexpr double kLongAndNarrow = 4.0; // length / width of ribs and slots
constexpr double kWidestChamfer = 2.0; // mm
constexpr double kWallSlope = 1.0;     // 45 degrees
constexpr double kCrestSlope = 0.0612; // half the least turning on both sides
constexpr double kLevel = 1e-9;        // mm; heights that differ by less are equal

} // namespace

Cells::Cells(const Scene& scene) : scene_(scene), key_(scene.features.size(), '\0') {
  for (const Feature& feature : scene.features) zones_.push_back(zones_of(feature));
}

Cells::Zones Cells::zones_of(const Feature& feature) {
  Zones zones;
  const Profile& profile = feature.profile();
  const Footprint& footprint = feature.footprint();
  for (const ProfileBend& bend : profile.bends()) {
    if (!bends_enough(bend)) continue;
    if (!zones.cuts.empty() && bend.d - zones.cuts.back().d < kLevel) {
      zones.cuts.back().wall = true; // top and bottom of a vertical wall stand over one place
    } else {
      zones.cuts.push_back({bend.d, false, bend.slope_outside > bend.slope_inside});
    }
  }
  auto& cuts = zones.cuts;
  zones.kinds.assign(cuts.size() + 1, FormKind::face);
  if (cuts.empty()) return zones;

  const bool endless = footprint.kind() == Footprint::Kind::half_plane;
  const double inmost = footprint.inmost();
  while (zones.middle < cuts.size() && cuts[zones.middle].d <= inmost + kLevel) ++zones.middle;
  zones.crested = !endless && std::fabs(profile.slope(inmost + kBeside)) > kCrestSlope;
  const double outer = profile.height(cuts.back().d + kBeside);
  const double inner = profile.height(endless ? cuts[0].d - kBeside : inmost + kBeside);
  const bool narrow = footprint.aspect() >= kLongAndNarrow;
  if (endless && std::fabs(inner - outer) > kLevel) zones.form = FormKind::step;
  if (!endless && inner > outer + kLevel) zones.form = narrow ? FormKind::rib : FormKind::boss;
  if (!endless && inner < outer - kLevel) zones.form = narrow ? FormKind::slot : FormKind::pocket;
  if (!endless) zones.kinds[zones.middle] = zones.form;

  for (std::size_t k = zones.middle + 1; k < cuts.size(); ++k) {
    const double place = 0.5 * (cuts[k - 1].d + cuts[k].d);
    const double height = profile.height(place);
    FormKind& kind = zones.kinds[k];
    if (cuts[k - 1].concave == cuts[k].concave && cuts[k].d - cuts[k - 1].d <= kWidestChamfer) {
      kind = FormKind::chamfer;
    } else if (height < std::min(inner, outer) - kLevel) {
      kind = FormKind::slot;
    } else if (height > std::max(inner, outer) + kLevel) {
      kind = FormKind::rib;
    } else if (std::fabs(profile.slope(place)) >= kWallSlope) {
      kind = FormKind::wall;
    }
    if (zones.form == FormKind::face) zones.form = kind; // a ring around a place as high as what is outside
  }
  return zones;
}

std::uint8_t Cells::code_at(std::size_t feature, double x, double y, double z) const noexcept {
  const Zones& zones = zones_[feature];
  const Feature& self = scene_.features[feature];
  const auto coded = [](std::size_t stretch, int sector, bool wall) {
    return static_cast<std::uint8_t>(16 * stretch + 2 * static_cast<std::size_t>(sector) + (wall ? 1 : 0));
  };
  if (!self.box().holds(x, y)) return coded(zones.cuts.size(), 0, false);
  const double d = self.footprint().distance(x, y);
  std::size_t k = 0;
  while (k < zones.cuts.size() && d >= zones.cuts[k].d) ++k;
  for (std::size_t c = 0; c < zones.cuts.size(); ++c) {
    if (!zones.cuts[c].wall || std::fabs(d - zones.cuts[c].d) > kOnWall) continue;
    const double others = scene_.height(x, y) - self.height(x, y);
    const double inner = others + self.profile().height(zones.cuts[c].d - kOnWall);
    const double outer = others + self.profile().height(zones.cuts[c].d + kOnWall);
    if (z > std::min(inner, outer) + kBetween && z < std::max(inner, outer) - kBetween) return coded(c, 0, true);
    k = std::fabs(z - inner) < std::fabs(z - outer) ? c : c + 1;
  }
  const int sector = zones.crested && k == zones.middle ? self.footprint().sector(x, y) : 0;
  return coded(k, sector, false);
}

std::uint32_t Cells::at(double x, double y, double z) {
  for (std::size_t k = 0; k < zones_.size(); ++k) key_[k] = static_cast<char>(code_at(k, x, y, z));
  const auto [found, added] = numbers_.try_emplace(key_, static_cast<std::uint32_t>(numbers_.size()));
  if (added) {
    for (const char code : key_) codes_.push_back(static_cast<std::uint8_t>(code));
  }
  return found->second;
}

bool Cells::inside(std::size_t feature, std::uint32_t cell) const noexcept {
  const std::uint8_t value = code(cell, feature);
  return value % 2U == 1U || zones_[feature].kinds[value / 16U] != FormKind::face;
}

FormKind Cells::kind(std::uint32_t cell) const noexcept {
  for (std::size_t k = zones_.size(); k-- > 0;) {
    if (!inside(k, cell)) continue;
    const std::uint8_t value = code(cell, k);
    return value % 2U == 1U ? FormKind::wall : zones_[k].kinds[value / 16U];
  }
  return FormKind::face;
}

} // namespace scansion
