// Curves joined end to end, held back until nothing more can join them; the middle of a very long one goes out before.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/line/curve.hpp"
#include "pipeline/feature/line/near_places.hpp"
#include "pipeline/feature/profile/sampling.hpp"

#include <span>
#include <vector>

namespace scansion {

/// A place in the frame of the scan where something may still grow.
struct LiveEnd {
  double s = 0.0, c = 0.0;
  bool convex = true;
};

/// Thread-bound. Gives published curves their ids and numbers of pieces.
class Joiner {
public:
  static constexpr std::size_t kPiece = 1024;                     ///< points: a curve that is longer goes out in pieces
  static constexpr std::size_t kMostHeld = std::size_t{1} << 18U; ///< points: above this the oldest curves no longer wait

  void take(Curve curve);
  /// Joins what is settled up to c = `settled` and moves finished curves to `out`. `live`: ends of tracks that still grow.
  void advance(double settled, std::span<const LiveEnd> live, const Sampling& sampling, std::vector<Curve>& out);
  /// Points that wait.
  [[nodiscard]] std::size_t held_points() const noexcept;

  /// For a line that is found some other way.
  [[nodiscard]] std::uint64_t new_id() noexcept { return next_id_++; }

private:
  struct End {
    std::size_t curve = 0;
    bool back = false;
  };
  struct Pair {
    double cost = 0.0;
    End a, b;
  };
  [[nodiscard]] bool is_live_near(std::span<const LiveEnd> live, const CurvePoint& p, bool convex, double reach) const;
  void find_pairs(double settled, std::span<const LiveEnd> live, const Sampling& sampling);
  void join(const End& a, const End& b);
  void release_finished(const Sampling& sampling, std::vector<Curve>& out);
  void release_pieces(std::vector<Curve>& out);
  void release_oldest(std::vector<Curve>& out);
  void release_middle(std::size_t curve, bool front_stays, bool back_stays, std::vector<Curve>& out);
  [[nodiscard]] bool release(Curve curve, std::vector<Curve>& out);

  std::vector<Curve> held_;
  std::uint64_t next_order_ = 0, next_id_ = 1;
  std::vector<End> ends_;  ///< that nothing new can reach
  std::vector<Tip> tips_;  ///< of these
  NearPlaces tip_places_;  ///< the same, by place
  NearPlaces live_places_; ///< of the live ends
  std::vector<Pair> pairs_;
};

} // namespace scansion
