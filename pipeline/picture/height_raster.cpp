// The heights of a scan on the pixels of a top view.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/height_raster.hpp"

#include "pipeline/export/patch_writer.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {
namespace {

constexpr double kCore = 0.75;    // of the way to the next line is covered by a sample alone
constexpr double kFarSteps = 6.0; // mean steps; farther samples of a run are a jump, not a slope
constexpr int kReach = 96;        // cells: bounds the work of few lines on a large picture

} // namespace

HeightRaster::HeightRaster(const TopMap& map, const ScanOutline& outline, bool patches)
    : map_(map), lowest_(outline.low[2]),
      far_mm_(std::max({kFarSteps * outline.step_mm, 2.0 * std::hypot(outline.advance[0], outline.advance[1]),
                        3.0 / std::min(map.per_mm[0], map.per_mm[1])})) {
  const std::size_t cells = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
  height_.assign(cells, 0.0F);
  weight_.assign(cells, 0.0F);
  flags_.assign(cells, 0);
  if (patches) patches_.assign(cells, -1);
  advance_ = {outline.advance[0] * map.per_mm[0], -outline.advance[1] * map.per_mm[1]};
  const double length = std::hypot(advance_[0], advance_[1]);
  if (length <= kCore) return;
  if (length > kReach) {
    for (double& part : advance_) part *= kReach / length;
  }
  reach_ = static_cast<int>(std::ceil(std::min<double>(length, kReach)));
}

std::optional<std::size_t> HeightRaster::cell_at(double column, double row) const noexcept {
  if (!(column >= 0.0 && row >= 0.0 && column < map_.width && row < map_.height)) return std::nullopt;
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(map_.width) + static_cast<std::size_t>(column);
}

// Weights that fall to 0 at the next line make the mean a linear interpolation between lines.
void HeightRaster::paint(const std::array<double, 2>& at, double height, std::int64_t patch) {
  for (int k = -reach_; k <= reach_; ++k) {
    const double t = reach_ == 0 ? 0.0 : static_cast<double>(k) / reach_;
    const auto cell = cell_at(at[0] + t * advance_[0], at[1] + t * advance_[1]);
    if (!cell) continue;
    const auto weight = static_cast<float>(1.001 - std::fabs(t));
    height_[*cell] += weight * static_cast<float>(height);
    weight_[*cell] += weight;
    if (std::fabs(t) > kCore) continue;
    flags_[*cell] |= kCovered;
    if (!patches_.empty() && (std::fabs(t) <= 0.5 || patches_[*cell] < 0)) patches_[*cell] = static_cast<std::int32_t>(patch);
  }
}

void HeightRaster::add(const std::array<double, 3>& mm, std::int64_t patch, bool join_far) {
  const auto at = map_.pixel(mm[0], mm[1]);
  const double height = mm[2] - lowest_;
  if (inside_ && (join_far || std::hypot(mm[0] - last_[0], mm[1] - last_[1]) <= far_mm_)) {
    const auto from = map_.pixel(last_[0], last_[1]);
    const int pieces = static_cast<int>(std::ceil(std::hypot(at[0] - from[0], at[1] - from[1])));
    for (int k = 1; k < pieces; ++k) {
      const double t = static_cast<double>(k) / pieces;
      paint({from[0] + t * (at[0] - from[0]), from[1] + t * (at[1] - from[1])}, last_[2] - lowest_ + t * (mm[2] - last_[2]),
            patch);
    }
  }
  paint(at, height, patch);
  last_ = mm;
  inside_ = true;
}

void HeightRaster::mark(const std::array<double, 3>& mm) {
  const auto at = map_.pixel(mm[0], mm[1]);
  for (const double right : {-0.5, 0.5}) { // two pixels wide: one is hard to see
    for (const double down : {-0.5, 0.5}) {
      if (const auto cell = cell_at(at[0] + right, at[1] + down)) flags_[*cell] |= kMarked;
    }
  }
}

void HeightRaster::finish() {
  for (std::size_t cell = 0; cell < height_.size(); ++cell) {
    if (covered(cell)) height_[cell] /= weight_[cell];
  }
  const auto width = static_cast<std::size_t>(map_.width);
  for (std::size_t row = 1; row + 1 < static_cast<std::size_t>(map_.height); ++row) {
    for (std::size_t column = 1; column + 1 < width; ++column) {
      const std::size_t cell = row * width + column;
      if (covered(cell)) continue;
      const std::array<std::size_t, 4> around{cell - 1, cell + 1, cell - width, cell + width};
      if (!std::ranges::all_of(around, [&](std::size_t other) { return covered(other); })) continue;
      float sum = 0.0F;
      for (const std::size_t other : around) sum += height_[other];
      height_[cell] = sum / 4.0F;
      flags_[cell] |= kCovered;
      if (!patches_.empty()) patches_[cell] = patches_[cell - 1];
    }
  }
}

Result<void> paint_scan(RecordingReader& reader, std::optional<std::uint32_t> level, const std::vector<PatchRun>& runs,
                        HeightRaster& raster, const Progress& progress) {
  SCANSION_TRY(resolution, resolution_mm(reader.facts().lattice));
  const Millimetre millimetre(reader.facts().lattice, resolution);
  PatchCursor patches(runs);
  DecodedGroup decoded;
  for (std::size_t g = 0; g < reader.groups().size(); ++g) {
    if (progress) progress(g, reader.groups().size());
    SCANSION_TRY(reader.read_group(g, reader.facts().stored_levels - 1, decoded));
    for (const ScanLine& line : decoded.group.lines) {
      const std::span<const Run> line_runs = decoded.group.runs_of(line);
      for (const Run& run : line_runs) {
        raster.begin_run();
        for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
          if (decoded.width[i] == DecodedGroup::kUnknown) continue;
          const auto mm = millimetre.position(decoded.group, i);
          raster.add(mm, runs.empty() ? -1 : patches.patch(line.index, i - line_runs.front().first), !decoded.lossless());
          if (level && decoded.width[i] <= *level) raster.mark(mm);
        }
      }
    }
  }
  raster.finish();
  return success();
}

} // namespace scansion
