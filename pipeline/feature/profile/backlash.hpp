// How far zigzag scans say that what lies on the way back lies beside what lies on the way there (docs/FEATURES.md, "Frame").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_point.hpp"
#include "pipeline/feature/profile/sampling.hpp"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace scansion {

/// Places of the same feature on three successive lines: those of the middle one, scanned the other way, against the mean of
/// its neighbours, so that a slanted edge says nothing. Thread-bound; allocates nothing in the steady state.
class BacklashEstimator {
public:
  /// The next line, its points in ascending s as the machine told them less `taken_off`.
  void add(const Profile& profile, double taken_off, std::span<const FeaturePoint> points, const Sampling& sampling);
  /// Lines do not go on from those before: the scan begins anew.
  void restart() noexcept { rows_known_ = 0; }

  /// Whether lines of this direction are scanned against the first line.
  [[nodiscard]] bool is_against(bool turned) const noexcept { return first_turned_ && *first_turned_ != turned; }
  /// What the last lines say; empty: too little, or more than one answer. Fails for scans in one direction.
  [[nodiscard]] std::optional<Backlash> value(const Sampling& sampling);

private:
  struct Row {
    double c = 0.0;
    bool against = false;
    std::vector<FeaturePoint> points;
  };
  struct Vote {
    double b = 0.0, s = 0.0; ///< mm
    double weight = 0.0;     ///< 1 / variance
    bool step = false;
    std::uint64_t point = 0; ///< number of points looked at till then
  };
  struct Mode {
    double middle = 0.0, weight = 0.0; ///< mm; sum of the votes beside it
  };
  static constexpr std::size_t kMostVotes = 1024;

  void compare(const Row& before, const Row& middle, const Row& after, const Sampling& sampling);
  void vote(Vote vote);
  [[nodiscard]] std::optional<double> find_mode(double reach) const;
  [[nodiscard]] double uncertainty(double mean, double reach, const Sampling& sampling);

  std::optional<bool> first_turned_;
  std::array<Row, 3> rows_; // the newest last
  std::size_t rows_known_ = 0;
  std::vector<Vote> votes_; // a ring
  std::size_t next_ = 0;
  std::uint64_t looked_at_ = 0;     ///< points of middle lines
  std::vector<Vote> sorted_, near_; // scratch
};

} // namespace scansion
