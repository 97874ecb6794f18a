// Brings both passes together: which of two tracks that follow the same edge keeps it (docs/FEATURES.md, "Union").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/link/track.hpp"
#include "pipeline/feature/profile/sampling.hpp"

#include <limits>
#include <span>
#include <vector>

namespace scansion {

/// Decides about points in order of c. Thread-bound: holds scratch.
class Union {
public:
  /// Gives a verdict on all points up to c = `settled` that have none. `tracks`: all that may still have such points.
  void decide(std::span<Track* const> tracks, double settled, const Sampling& sampling);

private:
  struct Near {
    double s = 0.0, c = 0.0;
    const Track* track = nullptr;
    TrackPoint* point = nullptr;
    std::size_t index = 0; ///< in its track
  };
  using Band = std::vector<Near>; // ascending s
  void gather(std::span<Track* const> tracks, Pass pass, double low, double high, Band& out) const;
  /// Asked for places of ascending s.
  class Cover {
  public:
    enum class By : std::uint8_t { any, longer, shallow };
    Cover(const Band& band, double reach_s, double reach_c, By by)
        : band_(band), reach_s_(reach_s), reach_c_(reach_c), by_(by) {}
    /// Whether a kept point of another track of the same polarity stands near.
    [[nodiscard]] bool covers(const Near& place);

  private:
    [[nodiscard]] bool outdoes(const Near& other, const Near& place) const;

    const Band& band_;
    double reach_s_, reach_c_;
    By by_;
    std::size_t first_ = 0; ///< in the band: what stands before is near to nothing more
  };

  double decided_ = -std::numeric_limits<double>::infinity();
  Band lengthwise_, crosswise_;
};

} // namespace scansion
