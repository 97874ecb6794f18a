// A feature line in even steps, and parts of it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_line.hpp"

#include <array>
#include <utility>
#include <vector>

namespace scansion {

struct WalkPlace {
  std::array<double, 3> at{};  ///< mm
  std::array<double, 2> way{}; ///< in plan, a unit vector
  std::size_t before = 0;      ///< vertex at or before it
};

class Walk {
public:
  /// `step` in mm, in space. A line of no more than `kMostPlaces` steps is walked so, a longer one in longer steps.
  Walk(const FeatureLine& line, double step);

  [[nodiscard]] const std::vector<WalkPlace>& places() const noexcept { return places_; }
  /// First and last place of each run of kept ones; around a closed line the last may come before the first.
  [[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> runs(const std::vector<bool>& kept) const;
  /// Places in a run.
  [[nodiscard]] std::size_t count(const std::pair<std::size_t, std::size_t>& run) const noexcept;
  /// Moves places, and the vertices of the line with them, by the mean of what is given for those around.
  void move(FeatureLine& line, const std::vector<std::array<double, 3>>& shift, std::size_t around);
  /// The line from one place to another, with its attributes; ends that are cut are `death`.
  [[nodiscard]] FeatureLine part(const FeatureLine& line, const std::pair<std::size_t, std::size_t>& run) const;

private:
  static constexpr std::size_t kMostPlaces = 1U << 22U;

  std::vector<WalkPlace> places_;
  bool closed_ = false;
};

/// Sum of the stretches between vertices.
[[nodiscard]] double length_in_space(const std::vector<FeatureVertex>& vertices) noexcept;

} // namespace scansion
