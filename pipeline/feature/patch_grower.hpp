// Grows patches line by line between the cuts of feature lines (docs/FEATURES.md, "Patches").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/cuts.hpp"
#include "pipeline/feature/jumps.hpp"
#include "pipeline/feature/patch_graph.hpp"
#include "pipeline/feature/patch_role.hpp"
#include "pipeline/feature/patch_row.hpp"
#include "pipeline/feature/patch_runs.hpp"

#include <deque>
#include <vector>

namespace scansion {

/// Lines wait here until the cuts around them are known; patches that are done wait until what lies around them is.
/// Thread-bound.
class PatchGrower {
public:
  PatchGrower(const Frame& frame, const Vector3& origin) : frame_(frame), origin_(origin) {}

  void hold(const Profile& profile, const Sampling& sampling);
  /// Assigns the samples of all lines up to c = `complete`.
  void advance(double complete, Cuts& cuts, const Sampling& sampling, FeatureReport& report);
  /// All lines are assigned: closes every patch.
  void finish(const Sampling& sampling, FeatureReport& report);

  /// After finish(): the scan goes on somewhere else.
  void restart();

private:
  /// A stretch of the row between cuts.
  struct Stretch {
    std::uint32_t first = 0, last = 0; // samples, both included
    std::uint32_t patch = 0;
    double s_low = 0.0, s_high = 0.0;
    bool cut_before = false; // by a feature line or a wall, else by the end of the data
    bool held = false;       // the cut was not seen, but known from the row before
    double drift = 0.0;      // of the cut, mm a row
    Cut cut;
  };
  struct Contact {
    std::size_t stretch = 0, above = 0;
    std::uint32_t patch = 0;
    double open = 0.0, cut = 0.0;
  };

  void assign(const PatchRow& row, const PatchRow* next, Cuts& cuts, const Sampling& sampling, FeatureReport& report);
  void split(const PatchRow& row);
  void find_contacts();
  bool hold_borders(const PatchRow& row, const Sampling& sampling);
  [[nodiscard]] bool is_leak(std::uint32_t a, std::uint32_t b, const Sampling& sampling);
  void follow_cuts();
  [[nodiscard]] bool touches_askew(const Contact& contact) const;
  void link(const Sampling& sampling, FeatureReport& report);
  void measure(const PatchRow& row, const Sampling& sampling);
  void measure_across(const PatchRow& row);
  void measure_ends(const PatchRow& row);
  void end_rows();
  void queue_runs(const PatchRow& row);
  void tell_runs(std::int64_t row, FeatureReport& report);
  /// Is the patch large enough to be told of? Then it stays so.
  [[nodiscard]] bool is_real(std::uint32_t id);

  void close(const Sampling& sampling, bool all, FeatureReport& report);
  void dissolve(std::uint32_t id, FeatureReport& report);
  [[nodiscard]] bool is_ready(const PatchNode& node) const;
  void settle(std::uint32_t id, PatchLooks& looks, const Sampling& sampling, FeatureReport& report);

  Frame frame_;
  Vector3 origin_;
  PatchGraph graph_;
  Edge edge_;
  PatchRuns runs_;
  double torn_ = 0.0; // share of samples that stayed in small patches, over the last rows
  Jumps jumps_;
  std::deque<PatchRow> rows_;
  std::vector<PatchRow> spare_;
  std::vector<Stretch> above_, now_, held_;
  std::vector<Contact> contacts_;
  std::vector<Cut> in_line_, across_;
  PatchRow last_row_;
  double last_c_ = -1e300;
  double pitch_ = 0.0, base_ = 0.0; // of columns, and their heights; fixed by the first row
  std::int64_t row_number_ = 0;
  std::vector<std::uint32_t> ids_; // scratch
  std::vector<Form> forms_;
};

} // namespace scansion
