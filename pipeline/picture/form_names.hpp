// Names of form features on a top view by patches.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/picture/drawing.hpp"
#include "pipeline/picture/height_raster.hpp"

namespace scansion {

/// Writes each form's name where its floor, top or larger flank is widest, a step's on the border or wall between its levels.
/// The map's upper left corner stands at the drawing's image. Of names that would cover one another the one with more room
/// stays.
void add_form_names(Drawing& drawing, const HeightRaster& raster, const Findings& findings);

} // namespace scansion
