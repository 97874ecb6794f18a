// Places in the frame of the scan, asked for what lies near one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

namespace scansion {

/// Filled, closed, then asked; keeps its memory for the next time. In strips of s, each by c, so that a wide scan with many
/// places is no dearer for each of them than a narrow one.
class NearPlaces {
public:
  /// `reach` in mm: how far off may be what is asked for. May take in a little more: who asks decides.
  void restart(double reach) {
    reach_ = 1.001 * reach; // nothing is lost by rounding
    places_.clear();
  }
  void add(double s, double c, bool convex, std::uint32_t which) { places_.push_back({convex, strip_of(s), c, which}); }
  void close() {
    std::sort(places_.begin(), places_.end(), [](const Place& a, const Place& b) { return a.key() < b.key(); });
  }
  /// Whether `look` is true for any of the places near one with its polarity; looks at none after that. Always in the same
  /// order.
  template <typename Look>
  [[nodiscard]] bool any(double s, double c, bool convex, const Look& look) const {
    const std::int64_t middle = strip_of(s);
    for (std::int64_t strip = middle - 1; strip <= middle + 1; ++strip) {
      auto at = std::lower_bound(places_.begin(), places_.end(), Place{convex, strip, c - reach_, 0},
                                 [](const Place& a, const Place& b) { return a.key() < b.key(); });
      for (; at != places_.end() && at->convex == convex && at->strip == strip && at->c <= c + reach_; ++at)
        if (look(at->which)) return true;
    }
    return false;
  }

private:
  struct Place {
    bool convex = true;
    std::int64_t strip = 0;
    double c = 0.0;
    std::uint32_t which = 0;
    [[nodiscard]] std::tuple<bool, std::int64_t, double, std::uint32_t> key() const noexcept {
      return {convex, strip, c, which};
    }
  };
  // Positions are whole counts below 2^50: their strips have numbers.
  [[nodiscard]] std::int64_t strip_of(double s) const noexcept {
    constexpr double kFarthest = 4e18;
    return static_cast<std::int64_t>(std::clamp(std::floor(s / reach_), -kFarthest, kFarthest));
  }

  double reach_ = 1.0;
  std::vector<Place> places_;
};

} // namespace scansion
