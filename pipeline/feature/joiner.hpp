// Curves joined end to end, held back until nothing more can join them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/curve.hpp"
#include "pipeline/feature/sampling.hpp"

#include <span>
#include <vector>

namespace scansion {

/// A place in the frame of the scan where something may still grow.
struct LiveEnd {
  double s = 0.0, c = 0.0;
  bool convex = true;
};

/// Thread-bound.
class Joiner {
public:
  void take(Curve curve);
  /// Joins what is settled up to c = `settled` and moves finished curves to `out`. `live`: ends of tracks that still grow.
  void advance(double settled, std::span<const LiveEnd> live, const Sampling& sampling, std::vector<Curve>& out);
  [[nodiscard]] const std::vector<Curve>& held() const noexcept { return held_; }

private:
  struct End {
    std::size_t curve = 0;
    bool back = false;
  };
  struct Pair {
    double cost = 0.0;
    End a, b;
  };
  void find_pairs(double settled, std::span<const LiveEnd> live, const Sampling& sampling);
  void join(const End& a, const End& b);

  std::vector<Curve> held_;
  std::uint64_t next_ = 0;
  std::vector<End> ends_;
  std::vector<Pair> pairs_;
};

} // namespace scansion
