// The scan lines that are measured.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/lines.hpp"

#include "pipeline/import/import.hpp"
#include "pipeline/pipeline.hpp"
#include "sim/scene/catalog.hpp"
#include "sim/scene/scanner.hpp"

#include <algorithm>

namespace scansion::bench {
namespace {

void add_line(LineSet& set, const SceneLine& line) {
  LineBuffer buffer;
  for (const ScenePoint& point : line.points) {
    if (!point.is_there()) continue;
    buffer.xyz[0].push_back(point.x);
    buffer.xyz[1].push_back(point.y);
    buffer.xyz[2].push_back(point.z);
  }
  if (buffer.points() == 0) return;
  buffer.runs.push_back({0, static_cast<std::uint32_t>(buffer.points()), 0});
  set.points += buffer.points();
  set.lines.push_back(std::move(buffer));
}

Result<void> read_lines(Importer& importer, LineSet& set) {
  set.lines.clear();
  set.points = 0;
  for (LineBuffer line;;) {
    SCANSION_TRY(more, importer.next(line));
    if (!more) return success();
    set.points += line.points();
    set.lines.push_back(line);
  }
}

} // namespace

std::vector<RunView> runs_of(const LineBuffer& line) {
  std::vector<RunView> runs;
  for (const Run& run : line.runs) {
    const auto axis = [&](std::size_t a) { return std::span(line.xyz[a]).subspan(run.first, run.count); };
    runs.push_back({axis(0), axis(1), axis(2)});
  }
  return runs;
}

std::vector<RunView> LineSet::runs() const {
  std::vector<RunView> all;
  for (const LineBuffer& line : lines) {
    const auto runs = runs_of(line);
    all.insert(all.end(), runs.begin(), runs.end());
  }
  return all;
}

FlatRuns LineSet::flat_runs(std::size_t first, std::size_t count) const {
  FlatRuns flat;
  for (const LineBuffer& line : std::span(lines).subspan(first, count)) {
    for (const Run& run : line.runs)
      flat.runs.push_back({static_cast<std::uint32_t>(flat.xyz[0].size()) + run.first, run.count, 0});
    for (std::size_t axis = 0; axis < 3; ++axis)
      flat.xyz[axis].insert(flat.xyz[axis].end(), line.xyz[axis].begin(), line.xyz[axis].end());
  }
  return flat;
}

Result<LineSet> scene_set(const std::string& scene, std::uint32_t lines, std::uint32_t points, double noise_um) {
  SCANSION_TRY(made, make_scene(scene));
  ScanPlan plan;
  if (lines != 0) plan.lines = lines;
  if (points != 0) plan.points = points;
  if (noise_um >= 0.0) plan.noise_um = noise_um;
  SCANSION_TRY(scanner, SceneScanner::create(std::move(made), plan));
  LineSet set;
  set.name = scene;
  set.lattice.resolution = set.resolution_mm = Rational{1, 1000};
  for (SceneLine line; scanner.next(line);) add_line(set, line);
  return set;
}

Result<LineSet> file_set(const std::string& entry) {
  LineSet set;
  set.path = entry;
  const std::size_t colon = entry.rfind(':');
  if (colon != std::string::npos) {
    if (const auto unit = parse_unit(std::string_view(entry).substr(colon + 1))) {
      set.unit = unit.value();
      set.path.resize(colon);
    }
  }
  const std::size_t slash = set.path.rfind('/');
  set.name = slash == std::string::npos ? set.path : set.path.substr(slash + 1);
  if (const std::size_t dot = set.name.find('.'); dot != std::string::npos && dot > 0) set.name.resize(dot);

  ImportOptions options;
  options.unit = set.unit;
  SCANSION_TRY(importer, Importer::open({set.path}, options, {}));
  Result<void> read = read_lines(importer, set);
  if (!read && read.error().code == Errc::finer) {
    SCANSION_TRY(importer.survey_all());
    read = read_lines(importer, set);
  }
  if (!read) return boost::outcome_v2::failure(read.error());
  set.lattice = importer.lattice();
  SCANSION_TRY(resolution, resolution_mm(set.lattice));
  set.resolution_mm = resolution;
  if (set.points == 0) return fail(Errc::undecodable, set.path, ": no points");
  return set;
}

void thin_out(LineSet& set, std::size_t lines, std::size_t points, std::size_t stretch) {
  const std::size_t have = set.lines.size();
  std::size_t want = lines == 0 ? have : std::min(lines, have);
  if (points != 0 && set.points > points) want = std::min(want, std::max<std::size_t>(1, have * points / set.points));
  if (want == have) return;
  const std::size_t stretches = (have + stretch - 1) / stretch;
  const std::size_t taken = (want + stretch - 1) / stretch;
  std::vector<LineBuffer> kept;
  set.points = 0;
  for (std::size_t k = 0; k < taken; ++k) {
    const std::size_t first = k * stretches / taken * stretch;
    for (std::size_t i = first; i < std::min(first + stretch, have) && kept.size() < want; ++i) {
      kept.push_back(std::move(set.lines[i]));
      set.points += kept.back().points();
    }
  }
  set.lines = std::move(kept);
}

std::vector<LineGroup> groups_of(const LineSet& set) {
  std::vector<LineGroup> groups;
  GroupBuilder builder;
  const auto close = [&] {
    if (!builder.empty()) builder.take(groups.emplace_back());
  };
  for (const LineBuffer& line : set.lines) {
    if (builder.must_close_before(line)) close();
    builder.add(line);
  }
  close();
  return groups;
}

} // namespace scansion::bench
