// The scenes that scansim knows, by name.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/catalog.hpp"

#include "sim/scene/scenes.hpp"

#include <array>
#include <string>

namespace scansion {
namespace {

constexpr std::array kCatalog{
    CatalogEntry{"plane", make_plane},       CatalogEntry{"steps", make_steps},       CatalogEntry{"slots", make_slots},
    CatalogEntry{"pocket", make_pocket},     CatalogEntry{"boss", make_boss},         CatalogEntry{"ribs", make_ribs},
    CatalogEntry{"fillets", make_fillets},   CatalogEntry{"freeform", make_freeform}, CatalogEntry{"part", make_part},
    CatalogEntry{"paper", make_paper},       CatalogEntry{"flat", make_flat},         CatalogEntry{"zigzag", make_zigzag},
    CatalogEntry{"two-step", make_two_step}, CatalogEntry{"terraces", make_terraces}, CatalogEntry{"channels", make_channels},
    CatalogEntry{"cavity", make_cavity},     CatalogEntry{"posts", make_posts},       CatalogEntry{"rails", make_rails},
    CatalogEntry{"grooves", make_grooves},   CatalogEntry{"edges", make_edges},       CatalogEntry{"dome", make_dome},
    CatalogEntry{"bracket", make_bracket},   CatalogEntry{"star", make_star},         CatalogEntry{"smooth", make_smooth},
    CatalogEntry{"holes", make_holes},
};

} // namespace

std::span<const CatalogEntry> scene_catalog() noexcept {
  return kCatalog;
}

Result<Scene> make_scene(std::string_view name) {
  std::string names;
  for (const CatalogEntry& entry : kCatalog) {
    if (entry.name == name) return entry.make();
    names.append(names.empty() ? "" : ", ").append(entry.name);
  }
  return fail(Errc::usage, "there is no scene '", name, "'; take one of ", names);
}

} // namespace scansion
