// The rows of a raster that are done, kept small, and their way into scan lines and back.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/grbl-probe/session.hpp"
#include "pipeline/model/lattice.hpp"
#include "pipeline/model/scan_line.hpp"

namespace scansion::grbl {

/// The unit the controller reports in: counts are 0.001 mm, or 0.0001 inch.
[[nodiscard]] Lattice report_lattice(bool inches) noexcept;

/// Rows 0, 1, ... as far as they are done. Bounded by Raster::kMostPoints. Thread-bound.
class DoneRows {
public:
  explicit DoneRows(const Raster& raster) : raster_(&raster) {}

  [[nodiscard]] std::uint32_t count() const noexcept { return static_cast<std::uint32_t>(stamps_.size()); }
  [[nodiscard]] bool is_empty() const noexcept { return stamps_.empty(); }
  void clear() noexcept;

  /// The next row, probed on a controller that reports in inches or not. Fails with attention when the unit is another than
  /// that of the rows before, with out_of_range when a coordinate is finer than what Grbl prints or too large.
  [[nodiscard]] Result<void> put(const Row& row, bool inches, const Stamps& stamps);
  /// Rows of a recording. Fails with config, and says why, when they are not of this raster; then nothing was taken.
  [[nodiscard]] Result<void> take_over(const Lattice& lattice, const std::vector<LineBuffer>& lines);
  /// As a scan line: x rises, a run for each stretch without holes.
  void fill(std::uint32_t row, LineBuffer& line) const;
  /// Known heights, for the lift between points.
  void put_heights(HeightMap& heights) const;

  [[nodiscard]] bool is_in_inches() const noexcept { return inches_; }

private:
  struct Contact {
    std::array<std::int32_t, 3> at{};
    bool is_hole = true;
  };
  [[nodiscard]] Result<void> take_line(const LineBuffer& line, const std::array<std::int64_t, 3>& origin);
  [[nodiscard]] double um(std::int32_t count) const noexcept;

  const Raster* raster_;
  bool inches_ = false;
  std::vector<Contact> contacts_; ///< row after row
  std::vector<Stamps> stamps_;
};

} // namespace scansion::grbl
