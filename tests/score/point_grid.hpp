// Finds the points near a place.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace scansion::score {

using Place = std::array<double, 3>;

[[nodiscard]] inline double distance(const Place& a, const Place& b) noexcept {
  return std::sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/// Cubes as wide as the search radius.
class PointGrid {
public:
  explicit PointGrid(double radius) : radius_(radius) {}

  void add(const Place& at, std::uint32_t number) { cubes_[key(cube(at))].push_back({at, number}); }

  /// Calls visit(number, distance) for every point within the radius.
  template <class Visit>
  void near(const Place& at, Visit visit) const {
    const Cube middle = cube(at);
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto found = cubes_.find(key({middle[0] + x, middle[1] + y, middle[2] + z}));
          if (found == cubes_.end()) continue;
          for (const Entry& entry : found->second) {
            const double d = distance(at, entry.at);
            if (d <= radius_) visit(entry.number, d);
          }
        }
      }
    }
  }

private:
  using Cube = std::array<std::int64_t, 3>;
  struct Entry {
    Place at;
    std::uint32_t number;
  };
  [[nodiscard]] Cube cube(const Place& at) const noexcept {
    return {static_cast<std::int64_t>(std::floor(at[0] / radius_)), static_cast<std::int64_t>(std::floor(at[1] / radius_)),
            static_cast<std::int64_t>(std::floor(at[2] / radius_))};
  }
  /// 21 bits an axis: enough for scans of a million radii.
  [[nodiscard]] static std::uint64_t key(const Cube& c) noexcept {
    constexpr std::uint64_t kMask = (1ULL << 21U) - 1U;
    return (static_cast<std::uint64_t>(c[0]) & kMask) << 42U | (static_cast<std::uint64_t>(c[1]) & kMask) << 21U |
           (static_cast<std::uint64_t>(c[2]) & kMask);
  }

  double radius_;
  std::unordered_map<std::uint64_t, std::vector<Entry>> cubes_;
};

} // namespace scansion::score
