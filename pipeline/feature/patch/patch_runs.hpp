// Runs of samples wait until it is known which patches they belong to, and whether these are patches at all.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/patch/patch_graph.hpp"

#include <vector>

namespace scansion {

/// In the order of lines. Thread-bound.
class PatchRuns {
public:
  /// Scan lines that runs wait. Longer than most slivers live, and shorter than patches wait to be published.
  static constexpr std::int64_t kWait = 32;

  void add(const PatchRun& run, std::int64_t row) { waiting_.push_back({run, row}); }
  /// Hands out the runs up to `row`, with the ids in force, that `is_told`; samples of the others are in no patch.
  template <typename IsTold>
  void tell(std::int64_t row, const PatchGraph& graph, const IsTold& is_told, std::vector<PatchRun>& out) {
    for (; told_ < waiting_.size() && waiting_[told_].row <= row; ++told_) {
      PatchRun run = waiting_[told_].run;
      run.patch = graph.find_past(run.patch);
      if (is_told(run)) out.push_back(run);
    }
    if (2 * told_ < waiting_.size()) return;
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(told_));
    told_ = 0;
  }

private:
  struct Waiting {
    PatchRun run;
    std::int64_t row = 0;
  };
  std::vector<Waiting> waiting_;
  std::size_t told_ = 0; ///< of these, at the beginning
};

} // namespace scansion
