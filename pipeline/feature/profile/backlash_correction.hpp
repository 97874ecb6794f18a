// What is done about backlash: when it is sure enough to be taken off, and when to tell of it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/profile/backlash.hpp"

namespace scansion {

/// Moves lines scanned against the first one; those of its direction stay, so that what is found there lies on the points of
/// the recording. Thread-bound.
class BacklashCorrection {
public:
  explicit BacklashCorrection(BacklashUse use) : use_(use) {}

  [[nodiscard]] bool corrects() const noexcept { return use_ == BacklashUse::correct; }
  /// The first lines, before any of them is searched for good.
  void learn(const Profile& profile, std::span<const FeaturePoint> points, const Sampling& sampling);
  void end_of_learning(const Sampling& sampling);

  /// To be moved before anything looks at its places.
  void apply(Profile& profile) const;
  /// A profile that was moved, and what was found on it.
  void add(const Profile& profile, std::span<const FeaturePoint> points, const Sampling& sampling, FeatureReport& report);
  /// Lines do not go on from those before.
  void restart() noexcept { estimator_.restart(); }
  void finish(const Sampling& sampling, FeatureReport& report);

private:
  void decide(const Backlash& now, const Sampling& sampling) noexcept;
  void tell(Backlash now, FeatureReport& report);

  BacklashUse use_;
  BacklashEstimator first_, estimator_;
  std::optional<Backlash> told_;
  double taken_off_ = 0.0; // mm
  std::uint32_t since_looked_ = 0;
};

} // namespace scansion
