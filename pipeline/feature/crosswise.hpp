// Links points of columns into tracks along the scan lines: they come in row by row and tracks grow at both ends.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/columns.hpp"
#include "pipeline/feature/linking.hpp"

#include <unordered_map>
#include <vector>

namespace scansion {

/// Thread-bound.
class CrosswiseLinker {
public:
  explicit CrosswiseLinker(Linking linking) : linking_(linking) {}

  /// Points in the order in which Columns finds them. `pitch`: of the columns; `settled`: no point with a smaller c will come.
  void add(const std::vector<ColumnPoint>& points, double pitch, double settled, const Sampling& sampling,
           std::vector<Track>& ended);
  void finish(std::vector<Track>& ended);

  [[nodiscard]] std::vector<Track>& live() noexcept { return live_; }

private:
  struct Choice {
    std::size_t track = 0;
    double cost = 0.0;
    bool found = false;
  };
  [[nodiscard]] Choice best_end(const ColumnPoint& point, TrackEnd end, const Sampling& sampling);
  void place(const ColumnPoint& point, const Sampling& sampling);
  void join(std::size_t into, std::size_t from);
  void retire(double settled, double pitch, const Sampling& sampling, std::vector<Track>& ended);
  void end(Track& track, std::vector<Track>& ended);
  void index(std::size_t track, TrackEnd end);
  void rebuild_index();

  Linking linking_;
  std::vector<Track> live_;
  std::uint64_t next_id_ = 1;
  // Tracks by the column of their first and of their last point; entries may be out of date.
  std::unordered_map<std::int64_t, std::vector<std::size_t>> fronts_, backs_;
};

} // namespace scansion
