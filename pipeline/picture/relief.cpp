// A height raster as a shaded relief.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/relief.hpp"

#include "pipeline/export/feature_writer.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {
namespace {

constexpr std::uint32_t kNothing = 0xfff2f2f2;
constexpr std::uint32_t kMark = 0xff101010;
constexpr std::size_t kBins = 1U << 16U;
constexpr double kOutermost = 0.01;
constexpr double kFlatShare = 0.2; // heights against the diagonal from which on nothing is exaggerated
constexpr double kMaxExaggeration = 6.0;

// Pale, so that lines of any colour stand out.
constexpr std::array<Rgb, 4> kRamp{{{118, 146, 158}, {168, 190, 184}, {214, 211, 184}, {246, 238, 220}}};

std::uint32_t lit(const Rgb& colour, double light) {
  std::uint32_t out = 0xff;
  for (const std::uint8_t part : colour) out = out << 8U | static_cast<std::uint32_t>(std::clamp(part * light, 0.0, 255.0));
  return out;
}

/// Halfway to white.
Rgb pale(const Rgb& colour) {
  Rgb out{};
  for (std::size_t k = 0; k < 3; ++k) out[k] = static_cast<std::uint8_t>((colour[k] + 255) / 2);
  return out;
}

/// How bright a cell is; 1 on flat ground.
class Light {
public:
  Light(const HeightRaster& raster, double exaggeration)
      : raster_(raster), width_(static_cast<std::size_t>(raster.map().width)),
        rows_(static_cast<std::size_t>(raster.map().height)) {
    for (std::size_t axis = 0; axis < 2; ++axis) per_cell_[axis] = exaggeration * raster.map().per_mm[axis];
  }
  [[nodiscard]] double at(std::size_t row, std::size_t column) const {
    const std::size_t cell = row * width_ + column;
    const double right = per_cell_[0] * slope(cell, 1, column > 0, column + 1 < width_);
    const double down = per_cell_[1] * slope(cell, width_, row > 0, row + 1 < rows_);
    // The light comes from the upper left at 45 degrees: (-1, -1, sqrt 2) / 2 in right, down, up.
    const double facing = (right + down) / 2.0 + std::sqrt(0.5);
    return 0.3 + 0.7 * std::max(0.0, facing) / std::sqrt(0.5 * (1.0 + right * right + down * down));
  }

private:
  [[nodiscard]] double slope(std::size_t cell, std::size_t step, bool before, bool after) const {
    const bool has_before = before && raster_.covered(cell - step);
    const bool has_after = after && raster_.covered(cell + step);
    const double from = raster_.height(has_before ? cell - step : cell);
    const double to = raster_.height(has_after ? cell + step : cell);
    return has_before && has_after ? (to - from) / 2.0 : to - from;
  }
  const HeightRaster& raster_;
  std::size_t width_, rows_;
  std::array<double, 2> per_cell_{};
};

} // namespace

HeightRange height_range(const HeightRaster& raster, double highest) {
  const std::size_t cells = static_cast<std::size_t>(raster.map().width) * static_cast<std::size_t>(raster.map().height);
  std::vector<std::size_t> bins(kBins, 0);
  std::size_t covered = 0;
  const double per_mm = highest > 0.0 ? (kBins - 1) / highest : 0.0;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    if (!raster.covered(cell)) continue;
    ++covered;
    const double bin = std::clamp(static_cast<double>(raster.height(cell)) * per_mm, 0.0, static_cast<double>(kBins - 1));
    ++bins[static_cast<std::size_t>(bin)];
  }
  const auto outer = static_cast<std::size_t>(kOutermost * static_cast<double>(covered));
  std::size_t low = 0;
  for (std::size_t sum = bins[0]; low + 1 < kBins && sum <= outer; sum += bins[++low]) {
  }
  std::size_t high = kBins - 1;
  for (std::size_t sum = bins[high]; high > low && sum <= outer; sum += bins[--high]) {
  }
  if (per_mm == 0.0) return {};
  return {static_cast<double>(low) / per_mm, static_cast<double>(high + 1) / per_mm};
}

Rgb height_colour(double share) noexcept {
  const double at = std::clamp(share, 0.0, 1.0) * (kRamp.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(at), kRamp.size() - 2);
  const double t = at - static_cast<double>(k);
  Rgb out{};
  for (std::size_t part = 0; part < 3; ++part)
    out[part] = static_cast<std::uint8_t>(std::lround((1.0 - t) * kRamp[k][part] + t * kRamp[k + 1][part]));
  return out;
}

Image relief(const HeightRaster& raster, const HeightRange& range, Shade shade) {
  const TopMap& map = raster.map();
  const double span = range.high - range.low;
  const double diagonal = std::hypot(map.width / map.per_mm[0], map.height / map.per_mm[1]);
  const double exaggeration = span > 0.0 ? std::clamp(kFlatShare * diagonal / span, 1.0, kMaxExaggeration) : 1.0;
  const Light light(raster, exaggeration);
  Image image{map.width, map.height, {}};
  image.pixels.reserve(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height));
  for (std::size_t row = 0; row < static_cast<std::size_t>(map.height); ++row) {
    for (std::size_t column = 0; column < static_cast<std::size_t>(map.width); ++column) {
      const std::size_t cell = row * static_cast<std::size_t>(map.width) + column;
      if (raster.marked(cell)) {
        image.pixels.push_back(kMark);
      } else if (!raster.covered(cell)) {
        image.pixels.push_back(kNothing);
      } else {
        const double share = span > 0.0 ? (static_cast<double>(raster.height(cell)) - range.low) / span : 0.5;
        const Rgb colour = shade == Shade::patch ? pale(patch_colour(raster.patch(cell))) : height_colour(share);
        image.pixels.push_back(lit(colour, light.at(row, column)));
      }
    }
  }
  return image;
}

} // namespace scansion
