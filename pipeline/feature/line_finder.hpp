// From profiles to finished curves: both passes, their union and their joining, line by line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/crosswise/crosswise.hpp"
#include "pipeline/feature/lengthwise/detector.hpp"
#include "pipeline/feature/lengthwise/tracker.hpp"
#include "pipeline/feature/line/joiner.hpp"
#include "pipeline/feature/link/union.hpp"
#include "pipeline/feature/patch/cuts.hpp"

#include <limits>
#include <optional>

namespace scansion {

/// Thread-bound.
class LineFinder {
public:
  explicit LineFinder(const FeatureSettings& settings) : settings_(settings), tracker_(settings), crosswise_(settings) {}

  /// Horizontal part of the up axis: 0 for a sheet that stands upright.
  void set_lean(double lean) noexcept { lean_ = lean; }

  /// The next profile, c ascending, spikes cleaned, rises noted; it stands to columns. Finished curves are added to `out`.
  void add(const Profile& profile, const Sampling& sampling, std::vector<Curve>& out);
  /// The scan ends, or goes on somewhere else.
  void finish(const Sampling& sampling, FeatureEnd reason, std::vector<Curve>& out);

  /// The points of the last profile, ascending s.
  [[nodiscard]] std::span<const FeaturePoint> points() const noexcept { return points_; }
  /// Curves may have been finished, and cuts completed, by the last add().
  [[nodiscard]] bool has_settled() const noexcept { return since_settled_ == 0; }
  /// The cuts that patches need, complete up to cuts_complete().
  [[nodiscard]] Cuts& cuts() noexcept { return cuts_; }
  /// For a feature line that is found some other way.
  [[nodiscard]] std::uint64_t new_id() noexcept { return joiner_.new_id(); }
  [[nodiscard]] double cuts_complete() const noexcept { return cuts_complete_; }

private:
  void drop_hidden_feet(Track& track, std::size_t first, std::size_t last, const Sampling& sampling) const;
  void smooth_ended(std::size_t first);
  void shed(Track& track, const Sampling& sampling);
  void settle(double settled, const Sampling& sampling, std::vector<Curve>& out);

  FeatureSettings settings_;
  double lean_ = 0.0;
  Detector detector_;
  Tracker tracker_;
  CrosswiseLinker crosswise_;
  std::optional<Columns> columns_;
  Union union_;
  Cuts cuts_;
  double cuts_complete_ = -std::numeric_limits<double>::infinity();
  Joiner joiner_;
  std::vector<Track> ended_; ///< until all their points have a verdict
  std::vector<FeaturePoint> points_;
  std::vector<ColumnPoint> column_points_;
  std::vector<double> rows_; ///< c of the last rows that lie in the columns
  std::vector<Track*> deciding_;
  std::vector<LiveEnd> live_ends_;
  std::vector<Curve> stretches_;
  std::uint32_t since_settled_ = 0;
};

} // namespace scansion
