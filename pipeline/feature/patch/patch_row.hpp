// A scan line on its way into patches, by samples and by columns.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/patch/row_samples.hpp"
#include "pipeline/feature/profile/profile.hpp"

#include <cstdint>
#include <vector>

namespace scansion {

/// What patches need of a profile; buffers are used again. Columns stand at multiples of the pitch of all rows.
struct PatchRow {
  static constexpr std::uint32_t kNoSample = 0xffffffffU;
  /// Rows of more columns are no surface: a scan of that extent against its pitch.
  static constexpr double kMostColumns = 65'536.0;
  /// Pitches between samples that still belong together.
  static constexpr double kDropout = 3.5;

  std::uint64_t line = 0;
  double c = 0.0;                          ///< mm
  RowPlaces s;                             ///< mm
  RowHeights w;                            ///< mm
  double least_step = 0.0;                 ///< mm: s advances by so much from sample to sample at least
  bool in_order = false;                   ///< column j is sample j, as far as there are columns, and `standing` holds nothing
  std::vector<std::uint32_t> source, ends; ///< as those of the profile
  std::vector<std::uint32_t> rises;        ///< the same
  double rises_above = 0.0;                ///< mm
  std::vector<std::uint32_t> holes;        ///< samples behind which some are missing
  std::int64_t first_column = 0;           ///< of those below
  std::vector<std::uint32_t> standing;     ///< sample that stands there, or kNoSample

  /// Takes the samples of a profile that stands to columns as these stand; its places and heights stay where they are. False
  /// when the row has no column, or too many: it cannot be part of a patch.
  [[nodiscard]] bool take(Profile& profile);
  /// What samples that stand evenly advance by at least.
  [[nodiscard]] static double least_even_step(double pitch) noexcept { return 0.5 * pitch; }
  [[nodiscard]] std::uint32_t number(std::size_t k) const noexcept {
    return source.empty() ? static_cast<std::uint32_t>(k) : source[k];
  }

  [[nodiscard]] std::uint32_t at(std::int64_t column) const noexcept {
    const auto j = static_cast<std::size_t>(column - first_column); // what lies before wraps to beyond the end
    if (j >= columns_) return kNoSample;
    return in_order ? static_cast<std::uint32_t>(j) : standing[j];
  }
  [[nodiscard]] std::int64_t end_column() const noexcept { return first_column + static_cast<std::int64_t>(columns_); }
  /// Of each column the w of its sample above the base, mm, or NaN.
  [[nodiscard]] const float* heights() const noexcept { return in_order ? w.above() : height_.data(); }

private:
  void stand_anywhere(double pitch);

  std::size_t columns_ = 0;
  std::vector<float> height_; // of columns; empty where these are in order
};

} // namespace scansion
