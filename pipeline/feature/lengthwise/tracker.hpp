// Links the points of each scan line with the tracks of the lines before: birth, growth, gaps, merging and end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/fit/local_fit.hpp"
#include "pipeline/feature/link/linking.hpp"
#include "pipeline/feature/profile/profile.hpp"

#include <memory>
#include <vector>

namespace scansion {

/// Thread-bound.
class Tracker {
public:
  explicit Tracker(const FeatureSettings& settings)
      : linking_(settings.linking), least_turning_(settings.limits.least_turning) {}

  /// `step` counts scan lines, missing ones too. Tracks that end go to `ended`.
  void add(const Profile& profile, std::int64_t step, const std::vector<FeaturePoint>& points, const Sampling& sampling,
           std::vector<Track>& ended);
  /// Ends all tracks.
  void finish(FeatureEnd reason, std::vector<Track>& ended);

  [[nodiscard]] std::vector<Track>& live() noexcept { return live_; }

private:
  struct Link {
    double cost = 0.0;
    std::uint32_t track = 0, point = 0;
  };
  void find_links(const Profile& profile, const std::vector<FeaturePoint>& points, const Sampling& sampling);
  void take_links(const Profile& profile, std::int64_t step, const std::vector<FeaturePoint>& points);
  [[nodiscard]] bool guide(Track& track, const Expectation& expected, const Profile& profile, std::int64_t step,
                           const Sampling& sampling) const;
  void miss(const Profile& profile, std::int64_t step, const Sampling& sampling, std::vector<Track>& ended);
  void bear(const Profile& profile, std::int64_t step, const std::vector<FeaturePoint>& points, const Sampling& sampling);
  void merge(std::int64_t step, const Sampling& sampling, std::vector<Track>& ended);
  void end(Track& track, FeatureEnd reason, std::vector<Track>& ended);

  Linking linking_;
  double least_turning_;    // degrees
  std::vector<Track> live_; // ascending id
  std::uint64_t next_id_ = 1;
  std::vector<Expectation> expected_;
  std::vector<Link> links_;
  std::vector<std::int32_t> point_of_; // a track's new point, or -1
  std::vector<bool> taken_;            // points
  std::vector<std::uint32_t> order_;   // scratch: live tracks by place
};

} // namespace scansion
