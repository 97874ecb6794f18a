// Noise from third differences, which curvature leaves alone; pitch and spacing from steps.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/profile/sampling.hpp"

#include <cmath>

namespace scansion {

namespace {

// Samples looked at on each line: the running median over 31 lines makes up for it.
constexpr std::size_t kLooks = 96;

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

} // namespace

double least_distance(double noise) noexcept {
  return std::max(4.0 * noise, 0.012);
}

void RunningMedian::add(double value) {
  if (count_ == kLast) {
    const auto old = std::lower_bound(sorted_.begin(), sorted_.begin() + kLast, ring_[next_]);
    std::move(old + 1, sorted_.begin() + kLast, old);
    --count_;
  }
  const auto end = sorted_.begin() + static_cast<std::ptrdiff_t>(count_);
  const auto place = std::upper_bound(sorted_.begin(), end, value);
  std::move_backward(place, end, end + 1);
  *place = value;
  ++count_;
  ring_[next_] = value;
  next_ = (next_ + 1) % kLast;
}

void SamplingEstimator::add(const Profile& profile) {
  // Medians over so many lines hardly change from one to the next.
  constexpr std::uint64_t kEvery = 8;
  const std::size_t n = profile.size();
  if (n >= 8 && (!noise_.full() || ++passed_ % kEvery == 0)) {
    const std::size_t stride = std::max<std::size_t>(1, n / kLooks);
    scratch_.clear();
    for (std::size_t k = 0; k + 3 < n; k += stride)
      scratch_.push_back(std::abs(profile.w[k + 3] - 3.0 * profile.w[k + 2] + 3.0 * profile.w[k + 1] - profile.w[k]));
    noise_.add(1.4826 * median(scratch_) / std::sqrt(20.0));
    scratch_.clear();
    for (std::size_t k = 0; k + 1 < n; k += stride) scratch_.push_back(profile.s[k + 1] - profile.s[k]);
    pitch_.add(median(scratch_));
  }
  if (n > 0) {
    if (last_c_ && profile.c != *last_c_) spacing_.add(std::abs(profile.c - *last_c_));
    last_c_ = profile.c;
  }
}

Sampling SamplingEstimator::value() const noexcept {
  constexpr double kFloor = 0.001; // mm
  constexpr double kCount = 0.3;   // of a count: sigma of rounding
  // A pitch: lines of a table that creeps or shakes at rest add nothing, and whoever looks back some steps would hold them all.
  constexpr double kMostLines = 32.0;
  const double estimate = noise_.empty() ? 0.0 : noise_.value() * settings_.noise_correlation;
  Sampling out;
  out.limits = settings_.limits;
  out.noise = std::max({settings_.noise_mm.value_or(estimate), kFloor, kCount * resolution_});
  out.pitch = pitch_.empty() ? 1.0 : pitch_.value();
  out.spacing = spacing_.empty() ? out.pitch : std::max(spacing_.value(), out.pitch / kMostLines);
  return out;
}

} // namespace scansion
