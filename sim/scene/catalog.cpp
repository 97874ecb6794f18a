// The scenes that scansim knows, by name.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/catalog.hpp"

#include "sim/scene/scenes.hpp"

#include <array>
#include <charconv>
#include <optional>
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

struct NumberedEntry {
  std::string_view prefix;
  Scene (*make)(std::uint64_t part);
};
constexpr std::array kNumbered{NumberedEntry{"random:", make_random}, NumberedEntry{"smooth:", make_random_smooth}};

std::optional<std::uint64_t> number(std::string_view text) noexcept {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

} // namespace

std::span<const CatalogEntry> scene_catalog() noexcept {
  return kCatalog;
}

Result<Scene> make_scene(std::string_view name) {
  for (const NumberedEntry& entry : kNumbered) {
    if (!name.starts_with(entry.prefix)) continue;
    const auto part = number(name.substr(entry.prefix.size()));
    if (!part) return fail(Errc::usage, "'", name, "': ", entry.prefix, " is followed by a whole number, the part's");
    return entry.make(*part);
  }
  std::string names;
  for (const CatalogEntry& entry : kCatalog) {
    if (entry.name == name) return entry.make();
    names.append(names.empty() ? "" : ", ").append(entry.name);
  }
  return fail(Errc::usage, "there is no scene '", name, "'; take one of ", names, ", random:N, smooth:N");
}

} // namespace scansion
