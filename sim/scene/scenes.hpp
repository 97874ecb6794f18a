// Makers of the scenes; see the catalog for finding one by name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/scene/scene.hpp"

namespace scansion {

// One kind of feature each (scenes_basic.cpp).
[[nodiscard]] Scene make_plane();
[[nodiscard]] Scene make_steps();
[[nodiscard]] Scene make_slots();
[[nodiscard]] Scene make_pocket();
[[nodiscard]] Scene make_boss();
[[nodiscard]] Scene make_ribs();
[[nodiscard]] Scene make_fillets();
[[nodiscard]] Scene make_freeform();

// Many features (scenes_part.cpp).
[[nodiscard]] Scene make_part();
/// 1,214 lines that follow the part's silhouette, 1,328,531 points in all.
[[nodiscard]] Scene make_paper();

// Small parts for judging feature lines (scenes_small.cpp).
[[nodiscard]] Scene make_terraces();
[[nodiscard]] Scene make_channels();
[[nodiscard]] Scene make_cavity();
[[nodiscard]] Scene make_posts();
[[nodiscard]] Scene make_rails();
[[nodiscard]] Scene make_grooves();
[[nodiscard]] Scene make_edges();
[[nodiscard]] Scene make_dome();
[[nodiscard]] Scene make_bracket();
[[nodiscard]] Scene make_star();
[[nodiscard]] Scene make_holes();
[[nodiscard]] Scene make_smooth();

/// Forms of random kind, size and place, the same for the same number (scenes_random.cpp). Named random:PART.
[[nodiscard]] Scene make_random(std::uint64_t part);
/// A smooth surface without a form. Named smooth:PART.
[[nodiscard]] Scene make_random_smooth(std::uint64_t part);

// Lines that are hard on ranking (scenes_adversarial.cpp).
[[nodiscard]] Scene make_flat();
[[nodiscard]] Scene make_zigzag();
[[nodiscard]] Scene make_two_step();

} // namespace scansion
