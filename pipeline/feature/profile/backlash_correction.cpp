// Backlash that is surely there, and larger than what a correction may get wrong.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/profile/backlash_correction.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

constexpr std::uint32_t kLookEvery = 16, kLookOftenEvery = 4; // lines
constexpr double kLeast = 0.15;                               // pitches: features are found to 0.3 of one
constexpr double kVaguest = 0.32;                             // pitches, one sigma
constexpr double kSure = 3.0;                                 // sigmas

} // namespace

void BacklashCorrection::learn(const Profile& profile, std::span<const FeaturePoint> points, const Sampling& sampling) {
  first_.add(profile, 0.0, points, sampling);
}

void BacklashCorrection::end_of_learning(const Sampling& sampling) {
  if (const auto now = first_.value(sampling)) decide(*now, sampling);
}

void BacklashCorrection::apply(Profile& profile) const {
  if (taken_off_ == 0.0 || !estimator_.is_against(profile.turned)) return;
  for (double& s : profile.s) s -= taken_off_;
}

void BacklashCorrection::add(const Profile& profile, std::span<const FeaturePoint> points, const Sampling& sampling,
                             FeatureReport& report) {
  estimator_.add(profile, estimator_.is_against(profile.turned) ? taken_off_ : 0.0, points, sampling);
  if (++since_looked_ < (taken_off_ == 0.0 && corrects() ? kLookOftenEvery : kLookEvery)) return;
  since_looked_ = 0;
  const auto now = estimator_.value(sampling);
  if (!now) return;
  const double before = taken_off_;
  decide(*now, sampling);
  const double change = std::max(kLeast * sampling.pitch, now->deviation_mm);
  if (!told_ || taken_off_ != before || std::abs(now->mm - told_->mm) > change) tell(*now, report);
}

void BacklashCorrection::finish(const Sampling& sampling, FeatureReport& report) {
  if (const auto now = estimator_.value(sampling)) tell(*now, report);
}

// What is in force stays until something else is surely better: each change tears the lines that are growing.
void BacklashCorrection::decide(const Backlash& now, const Sampling& sampling) noexcept {
  if (!corrects() || now.deviation_mm > kVaguest * sampling.pitch) return;
  const double least = std::max(kLeast * sampling.pitch, kSure * now.deviation_mm);
  if (std::abs(now.mm - taken_off_) <= least) return;
  taken_off_ = std::abs(now.mm) > least ? now.mm : 0.0;
}

void BacklashCorrection::tell(Backlash now, FeatureReport& report) {
  now.taken_off_mm = taken_off_;
  told_ = report.backlash = now;
}

} // namespace scansion
