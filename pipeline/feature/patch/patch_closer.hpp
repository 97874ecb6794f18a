// Ends patches: what is too small goes to its neighbours, the rest is told of with its shape and form (docs/FEATURES.md,
// "Patches").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/patch/patch_graph.hpp"
#include "pipeline/feature/patch/patch_role.hpp"
#include "pipeline/feature/patch/patch_runs.hpp"

#include <vector>

namespace scansion {

/// How far the scan has come.
struct PatchProgress {
  std::int64_t rows = 0;    ///< assigned so far
  std::size_t samples = 0;  ///< of the last one
  bool is_complete = false; ///< there are no further rows
};

/// Works on a graph, always the same one: first shut(), then, when nobody holds an id from before any more, tell_runs() and
/// publish().
/// Thread-bound: holds scratch.
class PatchCloser {
public:
  PatchCloser(const Frame& frame, const Vector3& origin) : frame_(frame), origin_(origin) {}

  /// A run of samples; it is told of once it is known that its patch is one.
  void add(const PatchRun& run, std::int64_t row) { runs_.add(run, row); }
  /// Patches that the last rows did not touch are done; small ones are dissolved.
  void shut(PatchGraph& graph, const PatchProgress& progress, FeatureReport& report);
  /// Tells of runs that have waited long enough; their patches are told of, too, sooner or later.
  void tell_runs(PatchGraph& graph, const PatchProgress& progress, FeatureReport& report);
  /// Tells of patches that are done and whose neighbours are; forgets what is told of.
  void publish(PatchGraph& graph, const PatchProgress& progress, const Sampling& sampling, FeatureReport& report);

private:
  template <typename Which>
  void gather_ids(const PatchGraph& graph, const Which& which);
  /// Is the patch large enough to be told of? Then it stays so.
  [[nodiscard]] bool is_real(PatchNode& node) const;
  void settle(PatchGraph& graph, std::uint32_t id, PatchLooks& looks, const Sampling& sampling, FeatureReport& report);

  Frame frame_;
  Vector3 origin_;
  PatchRuns runs_;
  double torn_ = 0.0; ///< share of samples that stayed in small patches, over the last rows
  std::vector<std::uint32_t> ids_;
  std::vector<Form> forms_;
};

} // namespace scansion
