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
  struct Edge {
    double s = 0.0; // mm
    Precedent precedent;
  };
  void add_vertex(const Profile& profile, const Vertex& vertex, std::uint32_t first, std::uint32_t last, bool clockwise,
                  const Sampling& sampling, const FitScale& scale, double least);
  [[nodiscard]] std::optional<Bend> find_bend_at(const Heights& heights, std::uint32_t k, const Reach& reach, bool clockwise,
                                                 const Sampling& sampling, const FitScale& scale);
  void drop_parts(const Sampling& sampling);
  void sort(std::vector<FeaturePoint>& out);

  std::vector<WallRun> walls_;
  std::vector<Vertex> vertices_;
  std::vector<std::uint32_t> stack_, order_, place_;
  std::vector<FeaturePoint> found_;
  std::vector<bool> dropped_;
  std::vector<Edge> edges_, edges_before_; // of this line and of the one before, about in order
  std::size_t next_ = 0;                   // of those before: the first that may lie near
  std::uint32_t rounding_end_ = 0;         // sample behind the last rounding that was found
  bool rounds_clockwise_ = false;
};

} // namespace scansion
