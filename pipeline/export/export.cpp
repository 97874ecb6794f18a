// Points and rearrangements of a recording to files.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/export/export.hpp"

#include "pipeline/pipeline.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace scansion {
namespace {

/// Whether any line of the group is wanted, from the header alone.
Result<bool> touches(RecordingReader& reader, std::size_t group, const Selection& selection) {
  SCANSION_TRY(header, reader.read_header(group, 0));
  return header.first_line < selection.end_line && header.first_line + header.line_count > selection.first_line;
}

bool is_range(const Selection& selection) noexcept {
  return selection.first_line > 0 || selection.end_line != std::numeric_limits<std::uint64_t>::max();
}

char* put_row(char* to, std::uint32_t j, double distance) noexcept {
  constexpr int kSignificant = 9;
  to = std::to_chars(to, to + 10, j).ptr;
  *to++ = ' ';
  if (std::isinf(distance) || distance == 0.0)
    *to++ = '0';
  else
    to = std::to_chars(to, to + 32, distance, std::chars_format::general, kSignificant).ptr;
  *to++ = '\n';
  return to;
}

Result<void> write_run(OutputFile& file, std::uint64_t line, std::size_t run, std::span<const double> distance,
                       std::span<const std::uint32_t> order) {
  SCANSION_TRY(file.append("# line " + std::to_string(line) + " run " + std::to_string(run) + " n+1 " +
                           std::to_string(order.size()) + "\n"));
  constexpr std::size_t kRow = 64;
  for (const std::uint32_t j : order) {
    SCANSION_TRY(to, file.reserve(kRow));
    file.advance(static_cast<std::size_t>(put_row(to, j, distance[j]) - to));
  }
  return success();
}

} // namespace

Result<ExportReport> export_points(RecordingReader& reader, const Selection& selection, PointWriter& writer, OutputFile& file,
                                   const Progress& progress) {
  SCANSION_TRY(selector, Selector::prepare(reader, selection));
  ExportReport report;
  report.error_mm = 0.0;
  SelectedGroup selected;
  std::vector<std::uint32_t> chosen;
  SCANSION_TRY(writer.begin(file));
  for (std::size_t g = 0; g < reader.groups().size(); ++g) {
    if (progress) progress(g, reader.groups().size());
    SCANSION_TRY(wanted, touches(reader, g, selection));
    if (!wanted) continue;
    SCANSION_TRY(selector.select(g, selected));
    const LineGroup& group = selected.decoded.group;
    for (const ScanLine& line : group.lines) {
      if (!selection.has_line(line.index)) continue;
      chosen.clear();
      for (const Run& run : group.runs_of(line)) {
        report.points += run.count;
        for (std::uint32_t i = run.first; i < run.first + run.count; ++i)
          if (selected.keep[i] != 0) chosen.push_back(i);
      }
      ++report.lines;
      report.kept += chosen.size();
      if (chosen.empty()) continue;
      SCANSION_TRY(writer.line(file, line.index, group, chosen));
    }
    if (report.error_mm) report.error_mm = std::max(*report.error_mm, selected.error);
  }
  SCANSION_TRY(writer.end(file));
  if (is_range(selection) && selection.kind != Selection::Kind::reduction && selection.kind != Selection::Kind::all)
    report.error_mm.reset();
  return report;
}

Result<ExportReport> export_rearrangement(RecordingReader& reader, const Selection& selection, OutputFile& file,
                                          const Progress& progress) {
  const RecordingFacts& facts = reader.facts();
  if (facts.stored_levels != facts.level_count + 1)
    return fail(Errc::usage, "a rearrangement needs every point, and this recording was cut to level ",
                std::to_string(facts.stored_levels - 1));
  SCANSION_TRY(resolution, resolution_mm(facts.lattice));
  Ranker ranker(resolution, RankUnit::automatic, facts.levels.floor.in_counts(resolution));
  GroupRanks ranks;
  DecodedGroup decoded;
  RankSorter sorter;
  std::vector<std::uint32_t> order;
  ExportReport report;
  for (std::size_t g = 0; g < reader.groups().size(); ++g) {
    if (progress) progress(g, reader.groups().size());
    SCANSION_TRY(wanted, touches(reader, g, selection));
    if (!wanted) continue;
    SCANSION_TRY(reader.read_group(g, facts.level_count, decoded));
    rank_group(ranker, decoded.group, ranks);
    for (const ScanLine& line : decoded.group.lines) {
      if (!selection.has_line(line.index)) continue;
      ++report.lines;
      std::size_t number = 0;
      for (const Run& run : decoded.group.runs_of(line)) {
        const auto distance = std::span(ranks.distance).subspan(run.first, run.count);
        sorter.sort(distance, std::span(ranks.depth).subspan(run.first, run.count), order);
        SCANSION_TRY(write_run(file, line.index, number++, distance, order));
        report.points += run.count;
      }
    }
  }
  report.kept = report.points;
  return report;
}

} // namespace scansion
