// All significant points of one profile.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/fit/steps.hpp"
#include "pipeline/feature/lengthwise/vertices.hpp"

namespace scansion {

/// Thread-bound: holds scratch and allocates nothing in the steady state.
class Detector {
public:
  /// Fills `out` in ascending s.
  void detect(const Profile& profile, const Sampling& sampling, std::vector<FeaturePoint>& out);

private:
  void add_vertex(const Profile& profile, const Vertex& vertex, std::uint32_t first, std::uint32_t last,
                  const Sampling& sampling, const FitScale& scale, double least);
  void drop_parts(const Sampling& sampling);
  void sort(std::vector<FeaturePoint>& out);

  std::vector<WallRun> walls_;
  std::vector<Vertex> vertices_;
  std::vector<std::uint32_t> stack_, order_, place_;
  std::vector<FeaturePoint> found_;
  std::vector<bool> dropped_;
  std::uint32_t rounding_end_ = 0; // sample behind the last rounding that was found
  bool rounds_clockwise_ = false;
};

} // namespace scansion
