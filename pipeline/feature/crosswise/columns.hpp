// The last scan lines resampled to columns, and what stands out across the lines (docs/FEATURES.md, "Crosswise pass").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/crosswise/column_rows.hpp"
#include "pipeline/feature/profile/sampling.hpp"

#include <cstdint>
#include <vector>

namespace scansion {

/// A significant point of one column: FeaturePoint::s is its place across the lines (c).
struct ColumnPoint {
  std::int64_t column = 0;
  double s = 0.0; ///< mm, place of the column along the lines
  FeaturePoint feature;
};

/// Rows are scan lines, columns stand at whole multiples of the pitch along them. Holds as many rows as the widest fit needs;
/// findings come that many rows late. Thread-bound; allocates only while lines grow longer.
class Columns {
public:
  /// More columns than this are not looked at: a scan of that extent against its pitch is no surface.
  static constexpr std::int64_t kMostColumns = 1 << 16;

  /// All profiles must stand to columns like these; `sampling` of the first lines fixes the windows.
  Columns(const Sampling& sampling, const ColumnScale& scale);

  /// Takes the next row; adds what is found `lag()` rows before it.
  void add(const Profile& profile, const Sampling& sampling, std::vector<ColumnPoint>& out);
  /// Adds what the last rows still hold.
  void finish(const Sampling& sampling, std::vector<ColumnPoint>& out);
  /// Rows are missing: windows do not reach over them.
  [[nodiscard]] std::size_t lag() const noexcept { return flank_reach_ + 2; }
  [[nodiscard]] double pitch() const noexcept { return pitch_; }

private:
  static constexpr std::size_t kReach = 2;       // widest window in units of the least one
  static constexpr std::size_t kNarrowest = 2;   // rows
  static constexpr std::size_t kLeastReach = 10; // rows

  /// Slope after minus slope before, of each column.
  struct Bends {
    std::vector<float> of;
    std::vector<float> peaks; // of blocks of columns
    bool known = false;
  };
  struct Row {
    double c = 0.0;
    double marked_above = 0.0; // noise: walls were marked as with this
    std::uint64_t line = 0;
    std::vector<std::uint32_t> source; // sample of the scan line
    std::vector<float> height;         // NaN where there is none; relative to base_
    Bends narrow, wide;                // over the least window, and over as many rows as a slope within 1.5 degrees takes
  };
  /// What stands out over one window.
  struct Screen {
    const float* ColumnRow::*bend = nullptr;
    std::int64_t window = 2; // rows a side
    std::int64_t near = 1;   // rows within which the greatest one counts
    float least = 0.0F;
  };
  /// The last edge that was looked for in a column.
  struct Edge {
    std::int64_t row = 0;
    Precedent precedent;
  };
  /// The last rounding that was found in a column.
  struct Rounding {
    std::int64_t end = -1; // row
    bool convex = false;
  };
  [[nodiscard]] Row& row(std::int64_t r) noexcept { return ring_[static_cast<std::size_t>(r) % ring_.size()]; }
  [[nodiscard]] const Row& row(std::int64_t r) const noexcept { return ring_[static_cast<std::size_t>(r) % ring_.size()]; }
  [[nodiscard]] bool has(std::int64_t r) const noexcept { return r >= first_ && r < next_; }

  /// The least bend that counts over a window of so many rows a side.
  [[nodiscard]] static float least_bend(std::size_t window, const Sampling& sampling) noexcept;
  /// Whether noise hides bends from the least window.
  [[nodiscard]] bool looks_wide(const Sampling& sampling) const noexcept;
  [[nodiscard]] bool make_room(double low, double high);
  void mark_walls(std::int64_t r, const Sampling& sampling);
  [[nodiscard]] bool has_walls(std::size_t column, std::int64_t from) const noexcept;
  void screen(std::int64_t r, std::size_t window, const Sampling& sampling, Bends& out);
  [[nodiscard]] const float* shown(const Bends& bends) const noexcept {
    return bends.known ? bends.of.data() : unknown_.data();
  }
  [[nodiscard]] ColumnRow view(const Row& row) const noexcept {
    return {row.c, row.height.data(), shown(row.narrow), shown(row.wide)};
  }
  void view_rows();
  void harvest(std::int64_t r, const Sampling& sampling, std::vector<ColumnPoint>& out);
  [[nodiscard]] std::size_t find_bends(std::int64_t row, const Bends& bends, const Screen& screen,
                                       std::vector<std::uint32_t>& columns);
  [[nodiscard]] bool bends_nearby(std::int64_t row, std::size_t column) const;
  void measure_bend(std::int64_t r, std::size_t column, const Screen& screen, const Sampling& sampling, const FitScale& scale,
                    std::vector<ColumnPoint>& out);
  [[nodiscard]] Precedent beside(std::int64_t r, std::size_t column, bool convex) const noexcept;
  [[nodiscard]] std::optional<Bend> fit(std::int64_t row, std::size_t column, Reach reach, bool walls, const Precedent* before,
                                        const FitScale& scale);
  [[nodiscard]] Reach rows_of_bend(std::int64_t row, std::size_t column, const Screen& screen, bool walls) const;
  void bound_by_steps(std::uint32_t k, const FitScale& scale, Reach& reach);
  [[nodiscard]] bool is_part_of_step(const Bend& bend, const FitScale& scale);
  void measure_step(std::int64_t r, std::size_t column, const FitScale& scale, std::vector<ColumnPoint>& out);
  [[nodiscard]] ColumnPoint column_point(std::int64_t r, std::size_t column, const FeaturePoint& feature) const;

  double pitch_ = 1.0, base_ = 0.0;
  bool sees_arcs_ = false;       // whether wide ones are looked for
  std::size_t wanted_ = 5;       // N: rows a side of a fit
  std::size_t window_ = 2;       // rows a side of the screening
  std::size_t reach_ = 10;       // rows a side that a fit may use
  std::size_t flank_reach_ = 10; // rows a side that hold the flanks of a rounded edge
  std::int64_t left_ = 0;        // number of the first column
  std::size_t width_ = 0;        // columns
  std::vector<Row> ring_;
  std::vector<Edge> edges_;           // the last of each column
  std::vector<Rounding> roundings_;   // of each column
  std::vector<float> unknown_;        // NaN in each column
  std::vector<std::uint32_t> marks_;  // of each column: number of the row before which a wall may have started last
  std::int64_t last_marked_ = -1;     // the greatest of these
  double marked_above_ = 0.0;         // the most of all rows held, or more
  bool trusted_ = false;              // marks hold for the noise as it is
  std::int64_t first_ = 0, next_ = 0; // rows held
  std::vector<const float*> weighed_; // rows in slopes
  std::vector<float> weights_;        // of these
  ColumnRows rows_;                   // those held
  Screen narrow_, wide_;              // of the row that is looked at
  std::vector<std::uint32_t> bent_, widely_bent_, stepped_; // columns that show something in a row
  Column column_;                                           // the one that is looked at
  std::vector<FeaturePoint> found_;
  std::vector<WallRun> walls_;
};

} // namespace scansion
