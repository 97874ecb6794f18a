// What the lines so far say about the sampling: noise, pitch, spacing, as running medians.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/profile/profile.hpp"
#include "pipeline/feature/settings.hpp"

#include <algorithm>
#include <optional>

namespace scansion {

/// The median of the last 31 values.
class RunningMedian {
public:
  void add(double value);
  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
  [[nodiscard]] bool full() const noexcept { return count_ == kLast; }
  [[nodiscard]] double value() const noexcept { return sorted_[count_ / 2]; }

private:
  static constexpr std::size_t kLast = 31;
  std::array<double, kLast> ring_{}, sorted_{};
  std::size_t count_ = 0, next_ = 0;
};

/// Lengths in mm. What is looked for at all goes along with what the scan allows to be found.
struct Sampling {
  double noise = 0.0;   ///< sigma of a height
  double pitch = 0.0;   ///< p: from sample to sample
  double spacing = 0.0; ///< D: from line to line
  FeatureLimits limits{};
  [[nodiscard]] double coarse() const noexcept { return std::max(pitch, spacing); } ///< u
};

/// The least D of the working set (d_n of the octaves upwards from the noise), mm.
[[nodiscard]] double least_distance(double noise) noexcept;

class SamplingEstimator {
public:
  /// `resolution_mm`: below a third of a count there is no noise to see.
  SamplingEstimator(const FeatureSettings& settings, double resolution_mm) : settings_(settings), resolution_(resolution_mm) {}
  void add(const Profile& profile);
  [[nodiscard]] Sampling value() const noexcept;

private:
  const FeatureSettings settings_;
  double resolution_;
  RunningMedian noise_, pitch_, spacing_;
  std::optional<double> last_c_;
  std::uint64_t passed_ = 0; // lines since the medians were full
  std::vector<double> scratch_;
};

} // namespace scansion
