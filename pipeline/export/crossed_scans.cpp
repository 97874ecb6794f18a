// What merging wants to know of a recording: its lines, their direction, their sampling.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/export/crossed_scans.hpp"

#include "pipeline/feature/profile/frame.hpp"
#include "pipeline/record/findings.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {
namespace {

using Places = std::array<std::vector<std::int32_t>, 3>; // counts

/// Calls `look` with the coarsest points of each run, till it says that it is enough; the ends of a run are among them.
template <class Look>
Result<void> visit_runs(RecordingReader& reader, Look look) {
  DecodedGroup decoded;
  Places xyz;
  for (std::size_t g = 0; g < reader.groups().size(); ++g) {
    SCANSION_TRY(reader.read_group(g, 0, decoded));
    for (const scansion::Run& run : decoded.group.runs) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        xyz[axis].clear();
        for (std::uint32_t p = run.first; p < run.first + run.count; ++p)
          if (decoded.width[p] != DecodedGroup::kUnknown) xyz[axis].push_back(decoded.group.xyz[axis][p]);
      }
      if (xyz[0].size() > 1 && !look(xyz)) return success();
    }
  }
  return success();
}

/// The way of the scan lines in plan.
Result<std::array<double, 2>> way_of(RecordingReader& reader, double resolution) {
  FrameFinder finder;
  SCANSION_TRY(visit_runs(reader, [&](const Places& xyz) {
    finder.add({xyz[0], xyz[1], xyz[2]}, resolution);
    return finder.lines() < FrameFinder::kLines;
  }));
  const Vector3 along = finder.frame().along;
  return std::array<double, 2>{along[0], along[1]};
}

/// Where it looked.
Result<std::vector<ScannedRun>> scanned_by(RecordingReader& reader, double resolution, const std::array<double, 2>& along) {
  std::vector<ScannedRun> out;
  const auto& origin = reader.facts().lattice.origin;
  SCANSION_TRY(visit_runs(reader, [&](const Places& xyz) {
    const auto place = [&](std::size_t k) {
      return std::pair((static_cast<double>(xyz[0][k]) + static_cast<double>(origin[0])) * resolution,
                       (static_cast<double>(xyz[1][k]) + static_cast<double>(origin[1])) * resolution);
    };
    const auto [x, y] = place(0);
    const auto [u, v] = place(xyz[0].size() - 1);
    const auto [low, high] = std::minmax({x * along[0] + y * along[1], u * along[0] + v * along[1]});
    out.push_back({0.5 * ((y + v) * along[0] - (x + u) * along[1]), low, high});
    return true;
  }));
  std::ranges::stable_sort(out, {}, &ScannedRun::across);
  return out;
}

/// The sampling step that the lines were found with: each says how long it is in millimetres and in fives of the step.
double step_of(const std::vector<FeatureLine>& lines) noexcept {
  double length = 0.0, fives = 0.0;
  for (const FeatureLine& line : lines) {
    length += line.length_mm;
    fives += line.persistence;
  }
  return fives > 0.0 ? length / (5.0 * fives) : 0.0;
}

Result<FoundByScan> found_by(RecordingReader& reader) {
  FoundByScan out;
  SCANSION_TRY(found, read_findings(reader, FindingsPart::lines));
  out.lines = std::move(found.lines);
  SCANSION_TRY(resolution, resolution_mm(reader.facts().lattice));
  SCANSION_TRY(way, way_of(reader, resolution.value()));
  out.along = way;
  out.step_mm = step_of(out.lines);
  SCANSION_TRY(scanned, scanned_by(reader, resolution.value(), way));
  out.scanned = std::move(scanned);
  return out;
}

/// Scan lines of a recording, missing ones too.
Result<std::uint64_t> end_of_lines(RecordingReader& reader) {
  if (reader.groups().empty()) return std::uint64_t{0};
  DecodedGroup decoded;
  SCANSION_TRY(reader.read_lines(reader.groups().size() - 1, decoded));
  return decoded.group.lines.empty() ? std::uint64_t{0} : decoded.group.lines.back().index + 1;
}

} // namespace

Result<CrossedLines> merge_recordings(RecordingReader& first, RecordingReader& second) {
  SCANSION_TRY(a, found_by(first));
  SCANSION_TRY(b, found_by(second));
  SCANSION_TRY(end, end_of_lines(first));
  for (FeatureLine& line : b.lines)
    for (FeatureVertex& v : line.vertices) v.line += end;
  return merge_crossed(std::move(a), std::move(b));
}

} // namespace scansion
