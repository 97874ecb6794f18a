// Where the tip goes.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/grbl-probe/raster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace scansion::grbl {
namespace {

constexpr double kUmPerMm = 1000.0;
constexpr std::int32_t kUnknown = std::numeric_limits<std::int32_t>::min();

Um um(double mm) noexcept {
  return std::llround(mm * kUmPerMm);
}

/// Places from `from` to `to`, both taken in; a last pitch that is short by rounding still counts.
double places(double from, double to, double pitch) noexcept {
  constexpr double kRounding = 1e-6;
  return std::floor((to - from) / pitch + kRounding) + 1.0;
}

} // namespace

Result<Raster> Raster::create(const RasterArea& area) {
  if (!(area.x_to >= area.x_from)) return fail(Errc::config, "x_to lies before x_from");
  if (!(area.y_to >= area.y_from)) return fail(Errc::config, "y_to lies before y_from");
  if (um(area.top) <= um(area.bottom)) return fail(Errc::config, "top is not above bottom");
  const double columns = places(area.x_from, area.x_to, area.pitch);
  const double rows = places(area.y_from, area.y_to, area.spacing);
  if (rows * columns > static_cast<double>(kMostPoints)) {
    return fail(Errc::config, "the raster has more than ", std::to_string(kMostPoints),
                " points; take a larger pitch or spacing, or a smaller area");
  }
  Raster out;
  out.x_from_ = area.x_from * kUmPerMm;
  out.y_from_ = area.y_from * kUmPerMm;
  out.pitch_ = area.pitch * kUmPerMm;
  out.spacing_ = area.spacing * kUmPerMm;
  out.top_ = um(area.top);
  out.bottom_ = um(area.bottom);
  out.clearance_ = um(area.clearance);
  out.rows_ = static_cast<std::uint32_t>(rows);
  out.columns_ = static_cast<std::uint32_t>(columns);
  out.serpentine_ = area.serpentine;
  return out;
}

Um Raster::x(std::uint32_t column) const noexcept {
  return std::llround(x_from_ + pitch_ * column);
}

Um Raster::y(std::uint32_t row) const noexcept {
  return std::llround(y_from_ + spacing_ * row);
}

HeightMap::HeightMap(const Raster& raster)
    : raster_(&raster), heights_(std::size_t{raster.rows()} * raster.columns(), kUnknown) {}

void HeightMap::put(std::uint32_t row, std::uint32_t column, Um z) noexcept {
  heights_[std::size_t{row} * raster_->columns() + column] = static_cast<std::int32_t>(z);
}

Um HeightMap::safe_height(std::uint32_t row, std::uint32_t column, std::uint32_t target) const noexcept {
  const auto [left, right] = std::minmax(column, target);
  const std::uint32_t first_row = row - std::min(row, kNear);
  const std::uint32_t last_row = std::min(row + kNear, raster_->rows() - 1);
  const std::uint32_t first = left - std::min(left, kNear);
  const std::uint32_t last = std::min(right + kNear, raster_->columns() - 1);
  std::int32_t highest = kUnknown;
  bool is_target_known = false;
  for (std::uint32_t r = first_row; r <= last_row; ++r) {
    const auto* heights = heights_.data() + std::size_t{r} * raster_->columns();
    for (std::uint32_t c = first; c <= last; ++c) {
      highest = std::max(highest, heights[c]);
      const std::uint32_t away = c > target ? c - target : target - c;
      is_target_known |= heights[c] != kUnknown && away <= kNear;
    }
  }
  return is_target_known ? std::min(highest + raster_->clearance(), raster_->top()) : raster_->top();
}

} // namespace scansion::grbl
