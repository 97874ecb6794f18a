// Pieces to whole feature lines, merges to patches.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/findings.hpp"

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

/// `later` goes on where `line` ends open; its attributes are those of the whole line so far.
void join(FeatureLine& line, FeatureLine&& later) {
  std::vector<FeatureVertex> vertices = std::move(line.vertices);
  const bool shared =
      !vertices.empty() && !later.vertices.empty() && vertices.back().position == later.vertices.front().position;
  vertices.insert(vertices.end(), later.vertices.begin() + (shared ? 1 : 0), later.vertices.end());
  const double length = line.length_mm + later.length_mm;
  const std::uint64_t scan_lines = line.scan_lines + later.scan_lines - (shared ? 1 : 0);
  const FeatureEnd begins = line.begins;
  for (std::size_t k = 0; k < kShapeElements; ++k) later.elements[k] += line.elements[k];
  for (const std::uint64_t id : line.junctions) {
    if (std::ranges::find(later.junctions, id) == later.junctions.end()) later.junctions.push_back(id);
  }
  if (!later.partner) later.partner = line.partner;
  line = std::move(later);
  line.vertices = std::move(vertices);
  line.length_mm = length;
  line.scan_lines = scan_lines;
  line.begins = begins;
  line.piece = 0;
}

} // namespace

Findings assemble(FeatureReport report) {
  Findings found;
  std::ranges::stable_sort(report.lines, [](const FeatureLine& a, const FeatureLine& b) {
    return std::tuple(a.id, a.piece) < std::tuple(b.id, b.piece);
  });
  for (FeatureLine& line : report.lines) {
    if (!found.lines.empty() && found.lines.back().id == line.id)
      join(found.lines.back(), std::move(line));
    else
      found.lines.push_back(std::move(line));
  }

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
