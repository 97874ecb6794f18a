// A drawing as values: one image, then boxes, strokes and labels on it; written as a PNG or SVG picture.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/export/output_file.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace scansion {

using Rgb = std::array<std::uint8_t, 3>;

/// Rows from top to bottom, each pixel 0xffRRGGBB.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;
};

/// Lengths of all shapes in pixels from the upper left corner, y down.
struct Box {
  double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
  Rgb colour{};
};

struct Stroke {
  std::vector<std::array<double, 2>> points;
  bool closed = false;
  std::string title; ///< shown by SVG viewers under the pointer
};

/// Strokes of one kind.
struct Layer {
  std::string name;
  Rgb colour{};
  double width = 1.0;
  std::vector<Stroke> strokes;
};

struct Label {
  enum class Anchor : std::uint8_t { start, middle, end };
  double x = 0.0, y = 0.0; ///< of the anchor on the base line
  Anchor anchor = Anchor::start;
  std::string text; ///< ASCII
};

struct Drawing {
  int width = 0, height = 0;
  double text_size = 12.0;
  Image image;
  int image_x = 0, image_y = 0;
  std::vector<Layer> layers;
  std::vector<Box> boxes;
  std::vector<Label> labels;
};

enum class PictureFormat : std::uint8_t { png, svg };

/// The format of a name; fails with usage.
[[nodiscard]] Result<PictureFormat> parse_picture_format(std::string_view name);

[[nodiscard]] Result<void> write_png(const Drawing& drawing, OutputFile& file);
/// Strokes and labels stay strokes and text: one group a layer, named by its id.
[[nodiscard]] Result<void> write_svg(const Drawing& drawing, OutputFile& file);

} // namespace scansion
