// The work guard: farthest points of long planar intervals without looking at every point.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/chord.hpp"
#include "pipeline/rank/vector_job.hpp"

#include <vector>

namespace scansion {

/// Convex hulls of blocks of a run and of pairs of blocks, up to the whole run, each made when it is first asked for.
///
/// The distance to a segment is a convex function, so the farthest point of a block is a vertex of its hull, whatever the order
/// of the points: chains may cross themselves, and no case is made of the ends of the segment (path hulls, Hershberger and
/// Snoeyink 1992, need simple chains and lines). Ties also lie on edges of hulls: the tree finds the tied point that is closest
/// to the middle. All in exact integers.
class HullTree {
public:
  /// Points below spans of kNarrowSpan; they must stay until the next call.
  void reset(const std::int32_t* u, const std::int32_t* v, std::uint32_t n);
  /// The farthest inner point of the interval, by the rules of the Ranker.
  [[nodiscard]] Found find(std::uint32_t a, std::uint32_t b);

private:
  static constexpr std::uint32_t kBlock = 64;

  /// Vertices by u, then v. Hulls that keep most of their points save nothing and are left out: their parts are looked at.
  struct Node {
    std::vector<std::uint32_t> hull;
    bool known = false;
    bool left_out = false;
  };
  /// The largest distances seen: inside the ends of the chord, where the cross product counts, and beyond them.
  struct Best {
    std::uint64_t cross = 0, beyond = 0;
  };
  struct Query {
    Planar kernel;
    Planar::Chord chord;
    Best best;
    std::uint64_t scale = 1;  ///< squared length of the chord, 1 for none
    exact::U128 farthest = 0; ///< squared distance of the farthest point, times scale
  };

  [[nodiscard]] std::uint32_t blocks() const noexcept { return (n_ + kBlock - 1) / kBlock; }
  [[nodiscard]] std::uint32_t end_of(unsigned level, std::uint32_t node) const noexcept;
  [[nodiscard]] const Node& node_at(unsigned level, std::uint32_t node);
  void make_hull(std::vector<std::uint32_t>& points) const;
  template <class Visit>
  bool visit_nodes(std::uint32_t first, std::uint32_t end, Visit&& visit);
  void measure(Query& q, unsigned level, std::uint32_t node);
  static void measure_point(Query& q, std::uint32_t k);
  [[nodiscard]] static bool is_best(const Query& q, std::uint32_t k);
  [[nodiscard]] std::uint32_t first_best(const Query& q, unsigned level, std::uint32_t node, bool from_end);
  [[nodiscard]] std::uint32_t closest_best(const Query& q, std::uint32_t first, std::uint32_t end, bool from_end);

  const std::int32_t* u_ = nullptr;
  const std::int32_t* v_ = nullptr;
  std::uint32_t n_ = 0;
  std::vector<std::vector<Node>> levels_;
};

} // namespace scansion
