// The yardstick: textbook Douglas-Peucker carried to the last point. Its source and its flags (CMakeLists.txt) never change,
// because every speed figure is a ratio to it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace scansion::bench {

/// In the plane of the line: what a program for profiles is given.
struct PlanePoint {
  double u, v; ///< mm
};

class Plain {
public:
  /// The distance at which each point splits its chord (0 where a chord has no point off it; ends infinite), then all indices
  /// by distance, descending.
  void rank(const std::vector<PlanePoint>& line);

  [[nodiscard]] const std::vector<double>& distance() const noexcept { return distance_; }
  [[nodiscard]] const std::vector<std::uint32_t>& order() const noexcept { return order_; }

private:
  struct Interval {
    std::size_t a, b;
  };
  std::vector<double> distance_;
  std::vector<std::uint32_t> order_;
  std::vector<Interval> stack_;
};

} // namespace scansion::bench
