// Where a feature line that goes out meets others: junctions, the other edge of a step, the border of the scan.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/line/curve.hpp"
#include "pipeline/feature/link/nearby.hpp"
#include "pipeline/feature/profile/profile.hpp"
#include "pipeline/feature/profile/sampling.hpp"

#include <deque>
#include <vector>

namespace scansion {

/// Of two lines that meet, the one that goes out later says so; how far back others are remembered is bounded. Thread-bound.
class Junctions {
public:
  static constexpr std::size_t kRows = 2048;       ///< scan lines: what lies before them is forgotten
  static constexpr std::size_t kSegments = 65'536; ///< and above so many pieces the oldest
  static constexpr std::size_t kLoose = 16'384;    ///< and of so many ends that met nothing

  void add_row(const Profile& profile);
  /// Says of a curve that goes out why it ends where it does, and what it meets. In the order in which curves go out.
  void meet(Curve& curve, const Sampling& sampling);
  /// The scan goes on somewhere else.
  void restart();

private:
  struct Row {
    double c = 0.0, low = 0.0, high = 0.0; ///< s of its ends
  };
  /// A straight piece of a line that has gone out.
  struct Segment {
    std::array<double, 3> from{}, to{}; // s, w, c
    Box box;
    std::uint64_t line = 0;
    bool convex = true, step = false;
  };
  struct Loose {
    Tip tip;
    Box box;
    LineEnd end;
    bool convex = true;
  };
  void make_segments(const Curve& curve, const Sampling& sampling);
  void gather(const Curve& curve, const Sampling& sampling);
  void meet_end(Curve& curve, bool back, const Sampling& sampling);
  void find_partner(Curve& curve, const Sampling& sampling) const;
  [[nodiscard]] bool is_at_border(const Tip& tip, const Sampling& sampling) const;
  void forget();

  std::deque<Row> rows_;
  double first_c_ = 0.0;
  Nearby<Segment> segments_;
  Nearby<Loose> loose_;
  std::vector<Segment> own_; // of the curve at hand
  // Of what went out before, the pieces of its polarity near it, and those of the other edges of steps:
  std::vector<Segment> near_, beside_;
  Box around_;           // the curve at hand
  std::size_t room_ = 0; // segments and ends that are held before anything is forgotten
};

} // namespace scansion
