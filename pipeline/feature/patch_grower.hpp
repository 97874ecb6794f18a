// Grows patches line by line between the cuts of feature lines (docs/FEATURES.md, "Patches").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/cuts.hpp"
#include "pipeline/feature/patch_graph.hpp"
#include "pipeline/feature/profile.hpp"

#include <deque>
#include <vector>

namespace scansion {

/// Lines wait here until the cuts around them are known. Thread-bound.
class PatchGrower {
public:
  PatchGrower(const Frame& frame, const Vector3& origin) : frame_(frame), origin_(origin) {}

  void hold(const Profile& profile);
  /// Assigns the samples of all lines up to c = `complete`.
  void advance(double complete, Cuts& cuts, const Sampling& sampling, FeatureReport& report);
  /// All lines are assigned: closes every patch.
  void finish(const Sampling& sampling, FeatureReport& report);

  /// After finish(): the scan goes on somewhere else.
  void restart();

private:
  struct Row {
    std::uint64_t line = 0;
    double c = 0.0;
    bool turned = false;
    std::vector<double> s, w;
    std::vector<std::uint32_t> source, ends;
  };
  /// A stretch of the row between cuts.
  struct Stretch {
    std::uint32_t first = 0, last = 0; // samples, both included
    std::uint32_t patch = 0;
    double s_low = 0.0, s_high = 0.0;
    bool cut_before = false; // by a feature line, else by the end of the data
    Cut cut;
  };

  void assign(const Row& row, Cuts& cuts, const Sampling& sampling, FeatureReport& report);
  void split(const Row& row, const Sampling& sampling);
  void link(const Sampling& sampling, double pitch, FeatureReport& report);
  void measure(const Row& row, const Sampling& sampling);
  void close(std::int64_t row, const Sampling& sampling, FeatureReport& report);
  void dissolve(std::uint32_t id, FeatureReport& report);
  void publish(std::uint32_t id, const Sampling& sampling, FeatureReport& report);
  void emit(const Row& row, FeatureReport& report) const;

  Frame frame_;
  Vector3 origin_;
  PatchGraph graph_;
  std::deque<Row> rows_;
  std::vector<Row> spare_;
  std::vector<Stretch> above_, now_;
  std::vector<Cut> in_line_, across_;
  Row last_row_;
  double last_c_ = -1e300, pitch_ = 0.0;
  std::int64_t row_number_ = 0;
};

} // namespace scansion
