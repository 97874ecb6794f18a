// The ground truth of one scan, collected beside it line by line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"
#include "sim/scene/scanner.hpp"
#include "sim/truth/cells.hpp"
#include "sim/truth/truth.hpp"

#include <memory>
#include <vector>

namespace scansion {

/// Scans the scene a second time without noise and faults: each sample's true place says which patch it belongs to, and lines
/// and samples that were lost still join the patches beside them. Memory grows with the patches' borders, not with the points.
/// Thread-bound.
class ScanTruth {
public:
  /// `plan` is that of the scan to be judged.
  [[nodiscard]] static Result<ScanTruth> create(Scene scene, const ScanPlan& plan);

  /// To be called with every line of the scan, in order.
  void add(const SceneLine& line);
  /// After the last one.
  [[nodiscard]] Truth finish();

private:
  struct Stretch {
    std::uint32_t first = 0, count = 0; // samples
    std::uint32_t cell = 0;
    std::uint32_t node = 0;
  };
  ScanTruth(const ScanPlan& plan, std::unique_ptr<SceneScanner> scanner);
  [[nodiscard]] std::uint32_t root(std::uint32_t node) noexcept;
  void split_line(const SceneLine& clean);
  void join_lines();
  void touch(const Stretch& a, const Stretch& b);
  void write_runs(const SceneLine& line);
  void note_rim(const ScenePoint& inside, std::uint32_t node);
  void number_patches(Truth& truth);
  void add_hole(std::size_t k, const std::vector<std::uint32_t>& number, Truth& truth);

  ScanPlan plan_;
  std::unique_ptr<SceneScanner> clean_; // its address stays: cells_ refers to its scene
  Cells cells_;
  SceneLine line_;
  std::vector<Stretch> now_, before_;
  double first_now_ = 0.0, first_before_ = 0.0;   // um along the line, where samples begin
  std::vector<std::uint32_t> parent_, node_cell_; // of the stretches of all lines
  std::vector<std::vector<std::uint32_t>> steps_; // nodes beside the edge of each step
  std::vector<std::vector<std::uint32_t>> rims_;  // nodes beside each hole
  std::vector<std::vector<TrueRun>> runs_;        // TrueRun::patch is a node until the end
};

} // namespace scansion
