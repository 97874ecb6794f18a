// scansion export: any level of detail of a recording, as points or as the rearrangement.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/command.hpp"
#include "daemon/cli/streams.hpp"
#include "pipeline/export/crossed_scans.hpp"
#include "pipeline/export/feature_writer.hpp"
#include "pipeline/export/patch_writer.hpp"
#include "pipeline/record/repair.hpp"

#include <algorithm>
#include <charconv>
#include <memory>

namespace scansion::cli {
namespace {

struct Options {
  std::string recording, crossed, output, what = "points", scope = "line", lines, format, unit, tolerance, reduction;
  std::uint32_t level = 0;
  bool has_level = false, single = false, force = false, strict = false;
};

Result<double> parse_tolerance(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value >= 0) || value > 1e12)
    return fail(Errc::usage, "tolerance '", text, "' is no number of millimetres of at least 0");
  return value;
}

Result<Selection> selection_of(const Options& o) {
  Selection s;
  if (!o.tolerance.empty()) {
    SCANSION_TRY(tolerance, parse_tolerance(o.tolerance));
    s.kind = Selection::Kind::tolerance;
    s.tolerance = tolerance;
  } else if (!o.reduction.empty()) {
    SCANSION_TRY(share, parse_reduction(o.reduction));
    s.kind = Selection::Kind::reduction;
    s.kept_share = share;
  } else if (o.has_level) {
    s.kind = Selection::Kind::level;
    s.level = o.level;
  }
  s.scan_scope = o.scope == "scan";
  if (s.scan_scope && s.kind != Selection::Kind::reduction)
    return fail(Errc::usage, "--scope scan goes with --reduction: a tolerance or level is the same in both scopes");
  if (!o.lines.empty()) {
    SCANSION_TRY(range, parse_lines(o.lines));
    s.first_line = range.first;
    s.end_line = range.second;
  }
  return s;
}

std::string ending_of(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  const std::size_t slash = path.rfind('/');
  if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) return {};
  return path.substr(dot + 1);
}

/// What was asked, for the header of the file and for the message.
std::string describe(const Options& o, const Selection& s) {
  switch (s.kind) {
    case Selection::Kind::tolerance: return "tolerance " + o.tolerance + " mm";
    case Selection::Kind::reduction: return "reduction " + o.reduction + " %, scope " + o.scope;
    case Selection::Kind::level: return "level " + std::to_string(s.level);
    case Selection::Kind::all: break;
  }
  return "every point";
}

void report(const Options& o, const Selection& s, const ExportReport& r) {
  std::string text = (o.output == "-" ? std::string("standard output") : o.output) + ": " + describe(o, s) + ": kept " +
                     std::to_string(r.kept) + " of " + std::to_string(r.points) + " points in " + std::to_string(r.lines) +
                     " lines";
  if (r.error_mm && s.kind != Selection::Kind::all) text += ", largest distance left out " + number(*r.error_mm) + " mm";
  say(text);
}

Result<void> cut_mcap(const Options& o, const std::string& recording, const RecordingReader& reader, const Selection& s) {
  if (s.kind != Selection::Kind::level && s.kind != Selection::Kind::all)
    return fail(Errc::usage, "an mcap output is a recording cut to a level: give --level K (0 to ",
                std::to_string(reader.facts().stored_levels - 1), ") or nothing");
  if (!o.lines.empty()) return fail(Errc::usage, "--lines does not go with an mcap output");
  if (!o.unit.empty() || o.single)
    return fail(Errc::usage, "--unit and --float32 do not go with an mcap output: it keeps the recording's own values");
  const std::uint32_t level = s.kind == Selection::Kind::level ? s.level : reader.facts().stored_levels - 1;
  if (level >= reader.facts().stored_levels)
    return fail(Errc::usage, "level ", std::to_string(level), " is not stored; the recording has levels 0 to ",
                std::to_string(reader.facts().stored_levels - 1));
  SCANSION_TRY(pending, RecordingOutput::create(o.output, o.force));
  SCANSION_TRY(cut_to_level(recording, level, pending.name()));
  return pending.commit();
}

Result<void> write_points(const Options& o, RecordingReader& reader, const Selection& s, const std::string& format_name,
                          const Progress& progress) {
  SCANSION_TRY(format, parse_point_format(format_name));
  Unit unit = reader.facts().lattice.unit;
  if (!o.unit.empty()) {
    SCANSION_TRY(asked, parse_unit(o.unit));
    unit = asked;
  }
  SCANSION_TRY(values, ValueFormat::make(reader.facts().lattice, unit, o.single));
  const auto writer = make_point_writer(format, values, {unit, o.single, describe(o, s)});
  SCANSION_TRY(file, OutputFile::create(o.output, o.force, needs_patching(format)));
  SCANSION_TRY(written, export_points(reader, s, *writer, file, progress));
  SCANSION_TRY(file.commit());
  report(o, s, written);
  return success();
}

/// A rearrangement is text. Endings that promise another form are refused, those that promise nothing are not.
bool is_no_text(const Options& o, const std::string& format) {
  if (format == "txt" || format == "xyz") return false;
  return !o.format.empty() || format == "mcap" || parse_feature_format(format) || parse_point_format(format);
}

Result<void> write_rearrangement(const Options& o, RecordingReader& reader, const Selection& s, const std::string& format,
                                 const Progress& progress) {
  if (is_no_text(o, format))
    return fail(Errc::usage, "a rearrangement is not written as '", format, "'; it is text: give --format txt");
  if (s.kind != Selection::Kind::all)
    return fail(Errc::usage, "a rearrangement holds every point in rank order: take its first rows instead of a selection");
  SCANSION_TRY(file, OutputFile::create(o.output, o.force, false));
  SCANSION_TRY(written, export_rearrangement(reader, s, file, progress));
  SCANSION_TRY(file.commit());
  report(o, s, written);
  return success();
}

Result<Unit> unit_of(const Options& o, const RecordingReader& reader) {
  return o.unit.empty() ? Result<Unit>(reader.facts().lattice.unit) : parse_unit(o.unit);
}

Result<void> has_features(const Options& o, const RecordingReader& reader) {
  if (reader.facts().features) return success();
  return fail(Errc::usage, o.recording,
              ": was made without feature lines and patches; compress the scan again with --features on");
}

// Whether a line has a place on one of the scan lines asked for: between two vertices it need not have any of its own.
bool crosses(const FeatureLine& line, const Selection& s) {
  for (std::size_t k = 0; k < line.vertices.size(); ++k) {
    const auto [low, high] = std::minmax(line.vertices[k].line, line.vertices[k == 0 ? 0 : k - 1].line);
    if (low < s.end_line && high >= s.first_line) return true;
  }
  return false;
}

Result<std::vector<FeatureLine>> crossed_lines(const Options& o, RecordingReader& reader) {
  SCANSION_TRY(path, readable_recording(o.crossed));
  SCANSION_TRY(other, RecordingReader::open(path));
  if (!other.facts().features)
    return fail(Errc::usage, o.crossed,
                ": was made without feature lines and patches; compress the scan again with --features on");
  SCANSION_TRY(merged, merge_recordings(reader, other));
  constexpr double kLeast = 0.1; // of the shorter findings
  const double possible = std::min(merged.first_mm, merged.second_mm);
  const double share = possible > 0.0 ? std::min(1.0, merged.common_mm / possible) : 0.0;
  say(o.crossed + ": has " + number(std::round(1000 * share) / 10) + " % of the feature lines in common with " + o.recording +
      (share < kLeast ? "; are both of one part, in one frame?" : ""));
  if (!other.complete())
    say(o.crossed + " is unfinished: what follows its last whole group is not in the output; see scansion verify");
  return std::move(merged.lines);
}

Result<void> write_features(const Options& o, RecordingReader& reader, const Selection& s, const std::string& format_name) {
  if (s.kind != Selection::Kind::all)
    return fail(Errc::usage, "feature lines do not depend on a selection of points; leave it out");
  SCANSION_TRY(has_features(o, reader));
  SCANSION_TRY(format, parse_feature_format(format_name));
  SCANSION_TRY(unit, unit_of(o, reader));
  Findings found;
  if (o.crossed.empty()) {
    SCANSION_TRY(alone, read_findings(reader, FindingsPart::lines));
    found = std::move(alone);
    std::erase_if(found.lines, [&](const FeatureLine& line) { return !crosses(line, s); });
  } else {
    if (!o.lines.empty()) return fail(Errc::usage, "--lines does not go with --crossed: each scan has its own");
    SCANSION_TRY(merged, crossed_lines(o, reader));
    found.lines = std::move(merged);
  }
  SCANSION_TRY(file, OutputFile::create(o.output, o.force, false));
  SCANSION_TRY(write_feature_lines(found.lines, format, unit, file));
  SCANSION_TRY(file.commit());
  say((o.output == "-" ? std::string("standard output") : o.output) + ": " + std::to_string(found.lines.size()) +
      " feature lines");
  return success();
}

Result<void> write_patches(const Options& o, RecordingReader& reader, const Selection& s, const std::string& format_name,
                           const Progress& progress) {
  SCANSION_TRY(has_features(o, reader));
  SCANSION_TRY(format, parse_patch_format(format_name));
  SCANSION_TRY(unit, unit_of(o, reader));
  SCANSION_TRY(values, ValueFormat::make(reader.facts().lattice, unit, o.single));
  SCANSION_TRY(found, read_findings(reader, FindingsPart::patches));
  const auto writer = make_patch_writer(format, values, {unit, o.single, describe(o, s)}, found);
  SCANSION_TRY(file, OutputFile::create(o.output, o.force, needs_patching(format)));
  SCANSION_TRY(written, export_points(reader, s, *writer, file, progress));
  SCANSION_TRY(file.commit());
  report(o, s, written);
  return success();
}

Result<int> run_export(const Options& o) {
  if (!o.crossed.empty() && o.what != "features")
    return fail(Errc::usage, "--crossed goes with --what features: points and patches stay those of one scan");
  SCANSION_TRY(selection, selection_of(o));
  SCANSION_TRY(spares_inputs(o.output, {o.recording, o.crossed}));
  SCANSION_TRY(recording, readable_recording(o.recording));
  SCANSION_TRY(reader, RecordingReader::open(recording));
  const bool points = o.what == "points" || o.what == "rearrangement";
  const std::string format =
      o.format.empty() ? (o.output == "-" ? std::string(points ? "xyz" : "txt") : ending_of(o.output)) : o.format;
  ProgressLine line("export");
  const Progress progress = [&](std::uint64_t done, std::uint64_t total) { line.show(done, total); };
  if (o.what == "features") {
    SCANSION_TRY(write_features(o, reader, selection, format));
  } else if (o.what == "patches") {
    SCANSION_TRY(write_patches(o, reader, selection, format, progress));
  } else if (o.what == "rearrangement") {
    SCANSION_TRY(write_rearrangement(o, reader, selection, format, progress));
  } else if (format == "mcap") {
    SCANSION_TRY(cut_mcap(o, recording, reader, selection));
  } else {
    SCANSION_TRY(write_points(o, reader, selection, format, progress));
  }
  if (reader.complete() && reader.gaps().empty()) return kDone;
  if (!reader.complete())
    say(o.recording + " is unfinished: what follows its last whole group is not in the output; see scansion verify");
  if (!reader.gaps().empty()) say(o.recording + " has " + std::to_string(reader.gaps().size()) + " gap(s); see scansion info");
  return o.strict ? kBadAnswer : kDone;
}

} // namespace

Verb add_export(CLI::App& root) {
  auto* app = root.add_subcommand("export", "Write points of a recording at any level of detail");
  auto o = std::make_shared<Options>();
  app->add_option("recording", o->recording, "The recording")->required();
  app->add_option("-o,--output", o->output, "The output; - is standard output")->required();
  app->add_option("--what", o->what, "What to write")
      ->check(CLI::IsMember({"points", "rearrangement", "features", "patches"}))
      ->capture_default_str();
  app->add_option("--crossed", o->crossed,
                  "With feature lines: another recording of the part, whose scan lines run across these");
  auto* tolerance =
      app->add_option("--tolerance", o->tolerance, "Keep the points farther than this many mm: error at most this");
  auto* reduction = app->add_option("--reduction", o->reduction, "Leave out this many percent of the points");
  auto* level = app->add_option("--level", o->level, "Keep the points of this stored level; 0 is the coarsest");
  tolerance->excludes(reduction)->excludes(level);
  reduction->excludes(level);
  app->add_option("--scope", o->scope, "Reduce each run alone, or the scan by one common order")
      ->check(CLI::IsMember({"line", "scan"}))
      ->capture_default_str();
  app->add_option("--lines", o->lines, "Lines A to B-1 only, as A:B");
  app->add_option("--format", o->format,
                  "xyz, txt, csv, ply, pcd, obj, json or mcap; features: txt, csv, json, obj, dxf, ply, vtp; patches: txt, "
                  "csv, ply, json; default: "
                  "by the ending of the output");
  app->add_option("--unit", o->unit, "Unit of the output; default: that of the input");
  app->add_flag("--float32", o->single, "Write single precision");
  app->add_flag("--force", o->force, "Replace an existing output");
  app->add_flag("--strict", o->strict, "Exit 1 when the recording is unfinished or has gaps");
  return {app, [o, level] {
            o->has_level = level->count() > 0;
            return run_export(*o);
          }};
}

} // namespace scansion::cli
