// A top view of a recording.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/top_view.hpp"

#include "pipeline/export/feature_writer.hpp"
#include "pipeline/picture/form_names.hpp"
#include "pipeline/picture/legend.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {
namespace {

constexpr double kSlimmest = 8.0; // the longer side against the shorter one, up to which the map is true to scale

TopMap map_for(const ScanOutline& outline, const Margins& margins, int size) {
  // A scan of one line, or of one point, still has an area.
  std::array<double, 2> extent{};
  for (std::size_t axis = 0; axis < 2; ++axis)
    extent[axis] = outline.high[axis] - outline.low[axis] + std::fabs(outline.advance[axis]);
  const double longer = std::max({extent[0], extent[1], 1e-6});
  const std::array<double, 2> room{size - margins.left - margins.right, size - margins.top - margins.bottom};
  TopMap map;
  std::array<double, 2> drawn{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    extent[axis] = std::max(extent[axis], longer * 1e-9);
    drawn[axis] = std::max(extent[axis], longer / kSlimmest);
  }
  const double scale = std::min(room[0] / drawn[0], room[1] / drawn[1]);
  std::array<int, 2> pixels{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    pixels[axis] = std::max(8, static_cast<int>(std::lround(drawn[axis] * scale)));
    const bool stretched = drawn[axis] > extent[axis];
    map.per_mm[axis] = stretched ? pixels[axis] / extent[axis] : scale;
  }
  map.width = pixels[0];
  map.height = pixels[1];
  const double middle_x = (outline.low[0] + outline.high[0]) / 2.0;
  const double middle_y = (outline.low[1] + outline.high[1]) / 2.0;
  map.left_top = {middle_x - map.width / map.per_mm[0] / 2.0, middle_y + map.height / map.per_mm[1] / 2.0};
  return map;
}

std::vector<Layer> layers_of(const std::vector<FeatureLine>& lines, const TopMap& map, const Margins& margins) {
  std::vector<Layer> layers(kFeatureTypes);
  for (std::size_t k = 0; k < kFeatureTypes; ++k) {
    const auto type = static_cast<FeatureType>(k);
    layers[k] = {std::string(name(type)), colour(type), margins.text / 7.0, {}};
  }
  for (const FeatureLine& line : lines) {
    Stroke stroke{{}, line.closed_loop, std::string(name(line.type)) + ' ' + std::to_string(line.id)};
    stroke.points.reserve(line.vertices.size());
    for (const FeatureVertex& vertex : line.vertices) {
      const auto at = map.pixel(vertex.position[0], vertex.position[1]);
      stroke.points.push_back({margins.left + at[0], margins.top + at[1]});
    }
    layers[static_cast<std::size_t>(line.type)].strokes.push_back(std::move(stroke));
  }
  return layers;
}

} // namespace

Result<Drawing> draw_top_view(RecordingReader& reader, const ViewContent& content, int size, const Progress& progress) {
  SCANSION_TRY(outline, outline_of(reader));
  const Margins margins = margins_for(size);
  const TopMap map = map_for(outline, margins, size);
  Drawing drawing;
  drawing.text_size = margins.text;
  drawing.image_x = static_cast<int>(margins.left);
  drawing.image_y = static_cast<int>(margins.top);
  HeightRange range;
  {
    const bool patches = content.shade == Shade::patch;
    HeightRaster raster(map, outline, patches);
    static const std::vector<PatchRun> kNone;
    SCANSION_TRY(paint_scan(reader, content.level, patches ? content.findings->runs : kNone, raster, progress));
    range = height_range(raster, outline.high[2] - outline.low[2]);
    drawing.image = relief(raster, range, content.shade);
    if (patches) add_form_names(drawing, raster, *content.findings);
  }
  Margins placed = margins;
  placed.left = drawing.image_x;
  placed.top = drawing.image_y;
  drawing.width = static_cast<int>(std::ceil(placed.left + map.width + placed.right));
  drawing.height = static_cast<int>(std::ceil(placed.top + std::max<double>(map.height, placed.least_height) + placed.bottom));
  if (content.findings) drawing.layers = layers_of(content.findings->lines, map, placed);
  add_caption(drawing, placed,
              content.caption + ": " + std::to_string(outline.lines) + " lines, " + std::to_string(outline.points) + " points");
  add_scale_bar(drawing, placed, map);
  add_key(drawing, placed, range, outline.low[2], content);
  return drawing;
}

} // namespace scansion
