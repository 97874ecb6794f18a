// Steps: walls that fall between samples, or over a few of them, with their upper and lower edge.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_point.hpp"
#include "pipeline/feature/local_fit.hpp"

#include <vector>

namespace scansion {

/// The samples of one wall: first..last, with what rounds its edges low..high.
struct WallRun {
  std::uint32_t first = 0, last = 0, low = 0, high = 0;
  bool step = false; ///< short enough to be a step: its edges were found
};

/// Thread-bound: holds scratch.
class StepFinder {
public:
  /// Adds both edges of each step of the run of samples [begin, end), in order of s and tied to each other, and lists all wall
  /// runs. Samples are counted from the start of the profile.
  void find(const Heights& heights, std::uint32_t begin, std::uint32_t end, const FitScale& scale,
            std::vector<FeaturePoint>& out, std::vector<WallRun>& walls);

private:
  void find_walls(const Heights& h, std::uint32_t begin, std::uint32_t end, const FitScale& scale,
                  std::vector<WallRun>& walls) const;
  void measure(const Heights& h, WallRun& wall, std::uint32_t low, std::uint32_t high, const FitScale& scale,
               std::vector<FeaturePoint>& out) const;
};

} // namespace scansion
