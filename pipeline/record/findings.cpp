// Reports to feature lines and patches.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/findings.hpp"

#include "pipeline/feature/line/join_pieces.hpp"

#include <algorithm>
#include <tuple>
#include <unordered_map>

namespace scansion {
namespace {

/// Where patches went. Follows chains, and stops where a damaged recording made a ring of them.
class Merges {
public:
  explicit Merges(const std::vector<PatchMerge>& merges) {
    for (const PatchMerge& merge : merges) into_[root(merge.from)] = root(merge.into);
  }
  [[nodiscard]] std::uint32_t root(std::uint32_t patch) {
    std::uint32_t top = patch;
    for (auto next = into_.find(top); next != into_.end() && next->second != top; next = into_.find(top)) top = next->second;
    while (patch != top) {
      const auto at = into_.find(patch);
      patch = std::exchange(at->second, top);
    }
    return top;
  }

private:
  std::unordered_map<std::uint32_t, std::uint32_t> into_;
};

} // namespace

Findings assemble(FeatureReport report) {
  Findings found;
  found.lines = join_pieces(std::move(report.lines));

  Merges merges(report.merges);
  for (PatchRun& run : report.runs) run.patch = merges.root(run.patch);
  std::ranges::stable_sort(report.runs, [](const PatchRun& a, const PatchRun& b) {
    return std::tuple(a.line, a.first) < std::tuple(b.line, b.first);
  });
  found.runs = std::move(report.runs);
  for (Patch& patch : report.patches) {
    if (merges.root(patch.id) != patch.id) continue;
    for (std::uint32_t& id : patch.neighbours) id = merges.root(id);
    std::ranges::sort(patch.neighbours);
    patch.neighbours.erase(std::unique(patch.neighbours.begin(), patch.neighbours.end()), patch.neighbours.end());
    std::erase(patch.neighbours, patch.id);
    found.patches.push_back(std::move(patch));
  }
  std::ranges::stable_sort(found.patches, {}, &Patch::id);
  for (Form& form : report.forms) {
    for (std::uint32_t& id : form.patches) id = merges.root(id);
  }
  found.forms = std::move(report.forms);
  found.backlash = report.backlash;
  return found;
}

Result<Findings> read_findings(RecordingReader& reader, FindingsPart part) {
  FeatureReport report;
  for (std::size_t i = 0; i < reader.notes().size(); ++i) {
    const bool patches = reader.notes()[i].patches;
    if (part != FindingsPart::all && patches != (part == FindingsPart::patches)) continue;
    SCANSION_TRY(reader.read_note(i, report));
  }
  return assemble(std::move(report));
}

} // namespace scansion
