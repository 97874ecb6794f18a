// The heights of a scan on the pixels of a top view, interpolated between samples and between lines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/export/export.hpp"
#include "pipeline/picture/scan_outline.hpp"
#include "pipeline/record/findings.hpp"

namespace scansion {

/// Millimetres to pixels: x to the right, y up in the scan and down in the picture.
struct TopMap {
  int width = 0, height = 0;
  std::array<double, 2> left_top{}; ///< mm
  std::array<double, 2> per_mm{};   ///< pixels; equal unless the scan is far longer than wide
  [[nodiscard]] std::array<double, 2> pixel(double x, double y) const noexcept {
    return {(x - left_top[0]) * per_mm[0], (left_top[1] - y) * per_mm[1]};
  }
};

/// Cells in rows from top to bottom.
class HeightRaster {
public:
  HeightRaster(const TopMap& map, const ScanOutline& outline, bool patches);

  /// A line starts: the next point has no neighbour before it.
  void begin_run() noexcept { inside_ = false; }
  /// The next point of the run; patch -1 is none.
  void add(const std::array<double, 3>& mm, std::int64_t patch, bool join_far);
  void mark(const std::array<double, 3>& mm); ///< a kept point
  /// Closes pinholes; heights can be read from here on.
  void finish();

  [[nodiscard]] const TopMap& map() const noexcept { return map_; }
  [[nodiscard]] bool covered(std::size_t cell) const noexcept { return (flags_[cell] & kCovered) != 0; }
  [[nodiscard]] bool marked(std::size_t cell) const noexcept { return (flags_[cell] & kMarked) != 0; }
  [[nodiscard]] float height(std::size_t cell) const noexcept { return height_[cell]; } ///< mm above the lowest point
  [[nodiscard]] std::int64_t patch(std::size_t cell) const noexcept { return patches_.empty() ? -1 : patches_[cell]; }

private:
  static constexpr std::uint8_t kCovered = 1, kMarked = 2;
  [[nodiscard]] std::optional<std::size_t> cell_at(double column, double row) const noexcept;
  void paint(const std::array<double, 2>& at, double height, std::int64_t patch);

  TopMap map_;
  double lowest_;
  std::array<double, 2> advance_{}; ///< pixels from a line to the next
  int reach_ = 0;                   ///< cells painted to each side of a sample
  double far_mm_;                   ///< samples farther apart than this are not joined
  std::vector<float> height_, weight_;
  std::vector<std::uint8_t> flags_;
  std::vector<std::int32_t> patches_;
  std::array<double, 3> last_{};
  bool inside_ = false;
};

/// Paints all stored points, and marks those of S_level when there is one. `runs` empty: no patches.
[[nodiscard]] Result<void> paint_scan(RecordingReader& reader, std::optional<std::uint32_t> level,
                                      const std::vector<PatchRun>& runs, HeightRaster& raster, const Progress& progress);

} // namespace scansion
