// Feature lines as cuts between samples: what bounds patches (docs/FEATURES.md, "Patches").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/link/track.hpp"
#include "pipeline/feature/profile/sampling.hpp"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

namespace scansion {

/// What a border between two patches is.
enum class BorderKind : std::uint8_t { convex, concave, step, none };

/// A straight piece of a cut in plan, mm.
struct CutSegment {
  double s0 = 0.0, c0 = 0.0, s1 = 0.0, c1 = 0.0; ///< c0 <= c1
  BorderKind kind = BorderKind::convex;
  bool backed = true; ///< by points of a feature line; false: an end made longer
};

/// A cut of one scan line, or of the way from one line to the next in one column.
struct Cut {
  double s = 0.0;
  std::int64_t column = 0;
  BorderKind kind = BorderKind::convex;
  bool backed = true;
};

/// Thread-bound.
class Cuts {
public:
  /// Takes the kept stretches of tracks up to c = `settled`, each piece once; ends are made longer when what is near them is
  /// known too. Call with the same tracks as Union::decide, after it.
  void take(std::span<Track* const> tracks, double settled, const Sampling& sampling);
  /// The scan line at c has come, from s = `low` to `high`.
  void see(double c, double low, double high) {
    first_c_ = std::min(first_c_, c);
    lines_.push_back({c, low, high});
  }
  /// Cuts are complete up to here.
  [[nodiscard]] double complete(double settled, const Sampling& sampling) const noexcept;
  /// The cuts of the line at c, and of the columns (at multiples of `pitch`) between `last_c` and c, in order of place. Lines
  /// must be asked for in ascending c.
  void at(double last_c, double c, double pitch, std::vector<Cut>& in_line, std::vector<Cut>& across);

  /// The scan goes on somewhere else.
  void restart() noexcept {
    taken_ = -1e300;
    first_c_ = 1e300;
    lines_.clear();
    coming_.clear();
    next_ = 0;
    passing_.clear();
    ends_.clear();
  }

private:
  /// Of length 1, or 0: unknown.
  struct PlanDirection {
    double ds = 0.0, dc = 0.0;
  };
  struct End {
    double s = 0.0, c = 0.0;
    PlanDirection on, course; // outwards: over the last points; over more of them
    BorderKind kind = BorderKind::convex;
    std::uint64_t track = 0;
  };
  struct Owned {
    CutSegment segment;
    std::uint64_t track = 0;
  };
  /// A segment that ends may run into.
  struct Target {
    double low_s = 0.0; ///< mm
    const Owned* owned = nullptr;
  };
  void take_track(const Track& track, double settled);
  void find_targets(std::span<const End> ends, double reach);
  [[nodiscard]] std::span<const Target> targets_near(double s, double reach) const;
  void extend(const End& end, const Sampling& sampling);
  [[nodiscard]] double ahead_of(const End& end, double u) const;
  [[nodiscard]] double way_out(const End& end, const Sampling& sampling) const noexcept;
  void add(double s0, double c0, double s1, double c1, BorderKind kind, bool backed, std::uint64_t track);

  void keep();

  double taken_ = -1e300;
  double first_c_ = 1e300; ///< of the first scan line
  struct LineExtent {
    double c = 0.0, low = 0.0, high = 0.0;
  };
  std::deque<LineExtent> lines_; ///< those at which ends may still wait, and the newest
  std::vector<Owned> coming_;    ///< ahead of the lines asked for, ascending c0 ...
  std::size_t next_ = 0;         ///< ... from here on
  std::vector<Owned> passing_;   ///< begun and not yet behind them
  std::vector<End> ends_;        ///< waiting for what is near them
  // While ends are made longer:
  std::vector<Target> targets_; ///< by low_s
  double widest_ = 0.0;         ///< mm along the lines, of the targets
  std::vector<Owned> made_, merged_;
  std::vector<std::int64_t> keys_; ///< of cut columns
};

} // namespace scansion
