// The scenes that scansim knows, by name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"
#include "sim/scene/scene.hpp"

#include <span>
#include <string_view>

namespace scansion {

struct CatalogEntry {
  std::string_view name;
  Scene (*make)();
};

/// All scenes but the random ones, in the order they are listed for a person.
[[nodiscard]] std::span<const CatalogEntry> scene_catalog() noexcept;

/// A scene of the catalog, random:PART or smooth:PART, PART a whole number. Fails with usage and the list of names when there
/// is no such scene.
[[nodiscard]] Result<Scene> make_scene(std::string_view name);

} // namespace scansion
