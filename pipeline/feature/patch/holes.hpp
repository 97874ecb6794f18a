// Regions without samples that a rim closes around: holes through a part (docs/FEATURES.md, "Holes").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/patch/hole_outline.hpp"
#include "pipeline/feature/patch/patch_graph.hpp"
#include "pipeline/feature/patch/patch_row.hpp"
#include "pipeline/feature/profile/sampling.hpp"

#include <limits>
#include <span>
#include <vector>

namespace scansion {

/// The samples of a row up to `last`, behind those of the span before, lie on one patch.
struct PatchSpan {
  std::uint32_t last = 0, patch = 0;
};
struct PatchedRow {
  const PatchRow* row = nullptr; ///< null: there is none
  std::span<const PatchSpan> spans;
};

struct FoundHole {
  HoleOutline outline;
  std::uint32_t patch = 0; ///< in which it lies
  double confidence = 0.0; ///< share of the outline beside which that patch is
  std::uint64_t lines = 0; ///< scan lines that it crosses
};

/// Holds at most kMostSlabs stretches without samples; a region that would need more is none. Thread-bound.
class HoleFinder {
public:
  static constexpr std::size_t kMostSlabs = 65'536;

  /// Is there anything to look at in a row?
  [[nodiscard]] bool wants(const PatchRow& row) const noexcept { return !row.holes.empty() || !open_.empty(); }
  /// A row that it wants; `above` is the one before it.
  void add(const PatchedRow& above, const PatchedRow& now, std::int64_t number, double pitch, const Sampling& sampling);
  /// To be called while the graph knows which patches were united.
  void follow(const PatchGraph& graph);
  /// Nothing follows the last row: what is open stays so.
  void end_rows();
  /// Judges the regions that ended so long before row `number` that their patch is known to be one, or all that ended. Patches
  /// wait longer, so they know their holes when they are told of.
  void tell(PatchGraph& graph, std::int64_t number, bool is_complete, const Sampling& sampling, std::vector<FoundHole>& out);

private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  /// Between two samples of a row.
  struct Gap {
    HoleSlab slab;
    std::uint32_t left = 0; // sample
    bool wide = false;
    std::size_t region = kNone; // in open_
  };
  /// How much of an outline lies beside a patch, mm.
  struct RimPart {
    std::uint32_t patch = 0;
    double length = 0.0;
  };
  struct Region {
    std::vector<HoleSlab> slabs;
    std::vector<RimPart> rim; // each patch once
    double outline = 0.0;     // mm, all of it
    std::int64_t last_row = 0;
    std::size_t into = kNone; // the region that it was united with
    double lost = 0.0;        // share of samples that were lost by chance around its end
    bool is_open = false;     // to the border of the scan, or too large
  };

  static void add_rim(std::vector<RimPart>& rim, std::uint32_t patch, double length);
  [[nodiscard]] std::size_t root(std::size_t region) const noexcept;
  void unite(std::size_t& a, std::size_t b);
  void link(const PatchedRow& above, double pitch, const Sampling& sampling);
  void begin(Gap& gap, const PatchedRow& above, double pitch, const Sampling& sampling);
  void keep(Region& region, const HoleSlab& slab);
  void measure(const PatchedRow& above, const PatchedRow& now, double pitch, const Sampling& sampling);
  static void cap(Region& region, const PatchedRow& row, double from, double to, double pitch);
  void end_regions(std::int64_t number, double length);
  [[nodiscard]] bool is_hole(const Region& region, const HoleOutline& outline, double pitch, const Sampling& sampling);

  std::vector<Region> open_, ended_;
  std::vector<Gap> gaps_, before_; // of this row, and those of the row before that belong to a region; by place
  std::vector<Gap> scratch_;
  std::vector<RimPart> rim_;
  std::vector<double> offs_;
  std::size_t slabs_ = 0; // in all regions
  double stray_ = 0.0;    // mm of the row in gaps that belong to no region
  double lost_ = 0.0;     // share of samples that are lost by chance, over the last rows
};

} // namespace scansion
