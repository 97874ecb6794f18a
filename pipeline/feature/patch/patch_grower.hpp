// Grows patches line by line between the cuts of feature lines (docs/FEATURES.md, "Patches").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/patch/cuts.hpp"
#include "pipeline/feature/patch/holes.hpp"
#include "pipeline/feature/patch/jumps.hpp"
#include "pipeline/feature/patch/patch_closer.hpp"
#include "pipeline/feature/patch/patch_graph.hpp"
#include "pipeline/feature/patch/patch_row.hpp"

#include <vector>

namespace scansion {

/// Lines wait here until the cuts around them are known; patches that are done wait until what lies around them is.
/// Thread-bound.
class PatchGrower {
public:
  PatchGrower(const Frame& frame, const Vector3& origin) : closer_(frame, origin) {}

  /// Takes the samples of the profile, which is nobody's afterwards. It must stand to columns, all of them to the same.
  void hold(Profile& profile);
  /// Assigns the samples of all lines up to c = `complete`.
  void advance(double complete, Cuts& cuts, const Sampling& sampling, FeatureReport& report);
  /// All lines are assigned: closes every patch.
  void finish(const Sampling& sampling, FeatureReport& report);

  /// What was found since they were taken last.
  [[nodiscard]] std::vector<FoundHole>& holes() noexcept { return found_holes_; }

  /// After finish(): the scan goes on somewhere else.
  void restart();

private:
  /// A stretch of the row between cuts.
  struct Stretch {
    std::uint32_t first = 0, last = 0; // samples, both included
    std::uint32_t patch = 0;
    PatchNode* node = nullptr; // of the patch, while the borders of a row are measured
    double s_low = 0.0, s_high = 0.0;
    bool cut_before = false; // by a feature line or a wall, else by the end of the data
    bool held = false;       // the cut was not seen, but known from the row before
    double drift = 0.0;      // of the cut, mm a row
    Cut cut;
    [[nodiscard]] PatchAtHand at_hand() const noexcept { return {patch, node}; }
  };
  struct Contact {
    std::size_t stretch = 0, above = 0;
    std::uint32_t patch = 0;
    double open = 0.0, cut = 0.0;
  };

  void assign(const PatchRow& row, const PatchRow* next, Cuts& cuts, const Sampling& sampling, FeatureReport& report);
  void split(const PatchRow& row);
  void find_contacts();
  [[nodiscard]] bool goes_on(const Contact& contact) const;
  bool hold_borders(const PatchRow& row, const Sampling& sampling);
  [[nodiscard]] bool is_leak(std::uint32_t a, std::uint32_t b, const Sampling& sampling);
  void follow_cuts();
  [[nodiscard]] bool touches_askew(const Contact& contact) const;
  [[nodiscard]] bool begins_anew(const Contact& best) const;
  void link(const Sampling& sampling, FeatureReport& report);
  void measure(const PatchRow& row, const Sampling& sampling);
  void measure_across(const PatchRow& row);
  void measure_ends(const PatchRow& row);
  void find_holes(const PatchRow& row, const Sampling& sampling);
  void end_rows();
  void queue_runs(const PatchRow& row);
  void close(bool is_complete, const Sampling& sampling, FeatureReport& report);

  PatchGraph graph_;
  PatchCloser closer_;
  Edge edge_;
  Jumps jumps_;
  HoleFinder holes_;
  std::vector<FoundHole> found_holes_;
  std::vector<PatchSpan> spans_above_, spans_now_;
  std::vector<PatchRow> rows_; ///< that wait
  std::vector<PatchRow> spare_;
  std::vector<Stretch> above_, now_, held_;
  std::vector<Contact> contacts_;
  std::vector<Cut> in_line_, across_;
  PatchRow last_row_;
  double last_c_ = -1e300;
  double pitch_ = 0.0; // of columns
  std::int64_t row_number_ = 0;
};

} // namespace scansion
