// Writes small recordings of every kind into a folder, as seeds for fuzzing and samples for other readers.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/writer.hpp"
#include "tests/unit/record/real_groups.hpp"

#include <cstdio>
#include <filesystem>

using namespace scansion;

namespace {

RecordingFacts facts_of(std::uint32_t levels) {
  RecordingFacts facts;
  facts.device = "seed";
  facts.stream = 7;
  facts.levels.count = levels;
  facts.level_count = levels;
  facts.stored_levels = levels + 1;
  facts.lattice.resolution = {1, 200};
  return facts;
}

/// What might have been found on the lines of one group.
FeatureReport report_of(std::uint32_t group) {
  FeatureReport report;
  report.group = group;
  report.backlash = Backlash{0.05, 0.002, 0.0, 40};
  const std::uint64_t first = std::uint64_t{5} * group;
  for (std::uint64_t k = 0; k < 2; ++k) {
    FeatureLine line;
    line.id = 1 + k;
    line.piece = static_cast<std::int32_t>(group);
    line.type = static_cast<FeatureType>(k + 2);
    line.per_mm = 1000;
    line.begins = line.ends = k == 0 ? FeatureEnd::open : FeatureEnd::junction;
    line.elements[15 + k] = 2;
    if (k == 1) {
      line.partner = 1;
      line.junctions = {1};
      line.met_by = {{1, true}};
      line.ends_at = LineEnd{1, false};
    }
    for (std::uint64_t v = 0; v < 3; ++v)
      line.vertices.push_back({{0.05 * static_cast<double>(v), 0.125, -1.0}, first + v, static_cast<std::uint32_t>(3 + k)});
    report.lines.push_back(line);
  }
  for (std::uint64_t line = first; line < first + 3; ++line) {
    report.runs.push_back({line, 0, 4, group});
    report.runs.push_back({line, 4, static_cast<std::uint32_t>(line - first + 1), 2 + group});
  }
  report.merges.push_back({group + 1, group});
  Patch patch;
  patch.id = group;
  patch.samples = 12;
  patch.neighbours = {2 + group};
  report.patches.push_back(patch);
  report.forms.push_back({FormKind::slot, {group, 2 + group}, 0.5});
  return report;
}

bool write_found(const std::string& path, ChunkRule rule) {
  RecordingFacts facts = facts_of(1);
  facts.features = true;
  auto writer = RecordingWriter::create(path, facts, rule);
  if (!writer) return false;
  for (const synthetic::RealGroup& group : synthetic::real_groups(facts, 2, 5, 12)) {
    if (!writer.value().append(group.encoded, group.lines.points(), group.runs, group.invalid)) return false;
    FeatureReport report = report_of(static_cast<std::uint32_t>(group.encoded.number));
    if (!writer.value().append(report, 1000)) return false;
  }
  return writer.value().finish(std::nullopt, 0.0).has_value();
}

} // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: recording_seeds FOLDER\n");
    return 2;
  }
  std::error_code error;
  std::filesystem::create_directories(argv[1], error);
  int written = 0;
  for (const std::uint32_t levels : {1U, 3U})
    for (const std::uint32_t groups : {0U, 1U, 3U})
      for (const bool finish : {false, true}) {
        RecordingFacts facts = facts_of(levels);
        if (groups == 3 && levels == 3 && !finish) facts.stored_levels = 2;
        const std::string path = std::string(argv[1]) + "/seed" + std::to_string(written++) + ".mcap";
        std::filesystem::remove(path, error);
        if (!synthetic::write_real(path, facts, synthetic::real_groups(facts, groups, 5, 12), finish)) {
          std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
          return 1;
        }
      }
  for (const ChunkRule rule : {ChunkRule::each_group, ChunkRule::many_groups}) {
    const std::string path = std::string(argv[1]) + (rule == ChunkRule::each_group ? "/found.mcap" : "/found-together.mcap");
    std::filesystem::remove(path, error);
    if (!write_found(path, rule)) {
      std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
      return 1;
    }
  }
  return 0;
}
