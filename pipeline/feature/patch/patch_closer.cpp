// When patches are done, and which of them are patches.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch/patch_closer.hpp"

#include "pipeline/feature/patch/forms.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>

namespace scansion {

namespace {

constexpr std::int64_t kCloseAfter = 2;     // rows without a sample
constexpr std::int64_t kSettleAfter = 48;   // rows: by then small neighbours are dissolved
constexpr std::int64_t kSettleAtLast = 256; // rows: neighbours that still grow are taken as they are
constexpr std::int64_t kForgetAtLast = 512; // rows
constexpr double kSmall = 25.0;             // samples: fewer are no patch
constexpr double kFew = 120.0;              // samples: a scan is torn where patches that stay below this ...
constexpr double kTorn = 0.42;              // ... hold so large a share of what was scanned ...
constexpr double kLately = 64.0;            // ... in so many rows; parts reach 0.23
constexpr double kSmallTorn = 400.0;        // samples: fewer are no patch there

// A patch too small to be one goes to what stands nearest, again and again until it is large enough.
void dissolve(PatchGraph& graph, std::uint32_t id, FeatureReport& report) {
  while (graph.node(id).closed && graph.node(id).sums.count() < kSmall) {
    std::optional<std::uint32_t> nearest;
    double gap = std::numeric_limits<double>::infinity();
    for (const auto& [other, border] : graph.node(id).borders) {
      if (other == id || border.gap >= gap || graph.node(other).settled) continue;
      gap = border.gap;
      nearest = other;
    }
    if (!nearest) return;
    id = graph.unite(id, *nearest, report.merges);
  }
}

bool all_beside(const PatchGraph& graph, const PatchNode& node, bool PatchNode::*state) {
  for (const auto& [other, border] : node.borders)
    if (!(graph.node(other).*state)) return false;
  return true;
}

// What a patch is depends on what it borders on.
bool is_ready(const PatchGraph& graph, const PatchNode& node, const PatchProgress& progress) {
  if (node.settled || progress.is_complete) return !node.settled;
  const std::int64_t rows = progress.rows - node.last_row;
  if (!node.closed || rows < kSettleAfter) return false;
  return rows >= kSettleAtLast || all_beside(graph, node, &PatchNode::closed);
}

bool can_go(const PatchGraph& graph, const PatchNode& node, const PatchProgress& progress) {
  if (!node.settled) return false;
  return progress.is_complete || progress.rows - node.last_row >= kForgetAtLast || all_beside(graph, node, &PatchNode::settled);
}

} // namespace

// In the order in which patches began.
template <typename Which>
void PatchCloser::gather_ids(const PatchGraph& graph, const Which& which) {
  ids_.clear();
  for (const auto& [id, node] : graph.nodes())
    if (which(node)) ids_.push_back(id);
  std::sort(ids_.begin(), ids_.end());
}

void PatchCloser::shut(PatchGraph& graph, const PatchProgress& progress, FeatureReport& report) {
  gather_ids(graph, [&](const PatchNode& n) {
    return !n.closed && (progress.is_complete || progress.rows - n.last_row > kCloseAfter);
  });
  for (const std::uint32_t id : ids_) graph.node(id).closed = true;
  for (const std::uint32_t id : ids_)
    if (graph.knows(id)) dissolve(graph, id, report);
}

void PatchCloser::publish(PatchGraph& graph, const PatchProgress& progress, const Sampling& sampling, FeatureReport& report) {
  gather_ids(graph, [&](const PatchNode& n) { return is_ready(graph, n, progress); });
  PatchLooks looks(graph, sampling);
  for (const std::uint32_t id : ids_) settle(graph, id, looks, sampling, report);
  gather_ids(graph, [&](const PatchNode& n) { return can_go(graph, n, progress); });
  for (const std::uint32_t id : ids_) graph.forget(id);
}

void PatchCloser::tell_runs(PatchGraph& graph, const PatchProgress& progress, FeatureReport& report) {
  const std::int64_t row = progress.is_complete ? progress.rows : progress.rows - PatchRuns::kWait;
  const double together = kLately * std::max(1.0, static_cast<double>(progress.samples));
  const auto is_told = [&](const PatchRun& run) {
    PatchNode* const node = graph.known(run.patch);
    const double size = node != nullptr ? node->sums.count() : 0.0;
    torn_ += std::min(1.0, run.count / together) * ((size < kFew ? 1.0 : 0.0) - torn_);
    return size > 0.0 && is_real(*node);
  };
  runs_.tell(row, graph, is_told, report.runs);
  graph.forget_aliases(row);
}

bool PatchCloser::is_real(PatchNode& node) const {
  const double least = torn_ > kTorn ? kSmallTorn : kSmall;
  node.real = node.real || (node.sums.count() >= least && node.c_high > node.c_low);
  return node.real;
}

void PatchCloser::settle(PatchGraph& graph, std::uint32_t id, PatchLooks& looks, const Sampling& sampling,
                         FeatureReport& report) {
  PatchNode& n = graph.node(id);
  n.settled = true;
  if (!is_real(n)) return;
  Patch patch;
  patch.id = id;
  n.sums.describe(frame_, sampling, origin_, patch);
  patch.doubtful = n.doubtful;
  for (const auto& [other, border] : n.borders)
    if (border.total() > 0.0 && other != id && is_real(graph.node(other))) patch.neighbours.push_back(other);
  patch.neighbours.insert(patch.neighbours.end(), n.past.begin(), n.past.end());
  forms_.clear();
  patch.label = name_forms(graph, id, looks, sampling, forms_);
  std::erase_if(forms_, [&](const Form& form) {
    return !std::all_of(form.patches.begin(), form.patches.end(),
                        [&](std::uint32_t part) { return is_real(graph.node(part)); });
  });
  std::move(forms_.begin(), forms_.end(), std::back_inserter(report.forms));
  report.patches.push_back(std::move(patch));
}

} // namespace scansion
