// What stands around the map of a top view: caption, scale bar, colours and their meaning.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/picture/drawing.hpp"
#include "pipeline/picture/top_view.hpp"

namespace scansion {

/// Room around the map, in pixels.
struct Margins {
  double text = 0.0; ///< size of the letters
  double left = 0.0, top = 0.0, right = 0.0, bottom = 0.0;
  double least_height = 0.0; ///< of the map, so that the legend beside it fits
};
[[nodiscard]] Margins margins_for(int size);

void add_caption(Drawing& drawing, const Margins& margins, const std::string& caption);
/// 1, 2 or 5 times a power of ten mm, about a quarter of the map long; where y is drawn larger than x, says so.
void add_scale_bar(Drawing& drawing, const Margins& margins, const TopMap& map);
/// The ramp of heights in mm, or the number of patches; then each type of feature line with its colour, number and length.
void add_key(Drawing& drawing, const Margins& margins, const HeightRange& range, double lowest_mm, const ViewContent& content);

} // namespace scansion
