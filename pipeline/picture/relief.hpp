// A height raster as a shaded relief.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/picture/drawing.hpp"
#include "pipeline/picture/height_raster.hpp"

namespace scansion {

enum class Shade : std::uint8_t { height, patch };

/// The heights that the colours span: all but the outermost hundredth on each side, in mm above the lowest point.
struct HeightRange {
  double low = 0.0, high = 0.0;
};
[[nodiscard]] HeightRange height_range(const HeightRaster& raster, double highest);

/// From 0, the lowest, to 1.
[[nodiscard]] Rgb height_colour(double share) noexcept;

/// Lit from the upper left; flat ground keeps its colour. Heights are exaggerated so that shallow parts show, 6 times at most.
[[nodiscard]] Image relief(const HeightRaster& raster, const HeightRange& range, Shade shade);

} // namespace scansion
