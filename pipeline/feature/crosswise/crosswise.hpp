// Links points of columns into tracks along the scan lines: they come in row by row and tracks grow at both ends.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/crosswise/column_ends.hpp"
#include "pipeline/feature/crosswise/column_gaps.hpp"
#include "pipeline/feature/crosswise/columns.hpp"
#include "pipeline/feature/link/linking.hpp"

#include <array>
#include <span>
#include <vector>

namespace scansion {

/// Thread-bound.
class CrosswiseLinker {
public:
  explicit CrosswiseLinker(const FeatureSettings& settings)
      : linking_(settings.linking), least_turning_(settings.limits.least_turning) {}

  /// Points in the order in which Columns finds them. `pitch`: of the columns, always the same; `settled`: no point with a
  /// smaller c will come.
  void add(const std::vector<ColumnPoint>& points, double pitch, double settled, const Sampling& sampling,
           std::vector<Track>& ended);
  void finish(std::vector<Track>& ended);

  /// Those without points are vacant.
  [[nodiscard]] std::vector<Track>& live() noexcept { return live_; }

private:
  struct Choice {
    std::uint32_t track = 0;
    double cost = 0.0;
    bool found = false;
  };
  /// What is known of a track's ends until it grows there.
  struct Ends {
    std::array<Axis, 2> axes; ///< by TrackEnd
    std::array<bool, 2> known{};
  };
  [[nodiscard]] Choice best_end(const ColumnPoint& point, TrackEnd end, const Sampling& sampling);
  /// The track that has passed over this point.
  [[nodiscard]] Choice best_gap(const ColumnPoint& point, const Sampling& sampling);
  void insert(std::uint32_t track, const ColumnPoint& point);
  void place(const ColumnPoint& point, const Sampling& sampling);
  void bear(const ColumnPoint& point);
  void extend(std::uint32_t track, TrackEnd end, const ColumnPoint& point);
  void join(std::uint32_t into, std::uint32_t from);
  void note_growth(std::uint32_t track, TrackEnd end);
  [[nodiscard]] const Axis& axis(std::uint32_t track, TrackEnd end);
  [[nodiscard]] double latest_of(std::uint32_t track, double pitch);
  void retire(double settled, double pitch, const Sampling& sampling, std::vector<Track>& ended);
  void end(std::span<std::uint32_t> tracks, std::vector<Track>& ended);
  void vacate(std::uint32_t track);

  Linking linking_;
  double least_turning_; // degrees
  std::vector<Track> live_;
  std::vector<Ends> ends_;     ///< of these tracks
  std::vector<double> latest_; ///< c up to which a point may continue them at least, less what depends on the spacing; mm
  std::vector<std::uint32_t> vacant_; ///< of these tracks
  std::vector<std::uint32_t> ending_; ///< scratch
  ColumnEnds fronts_, backs_;
  ColumnGaps gaps_;
  std::uint64_t next_id_ = 1;
};

} // namespace scansion
