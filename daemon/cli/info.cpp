// scansion info: what a recording holds.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/command.hpp"
#include "daemon/cli/streams.hpp"
#include "pipeline/record/findings.hpp"

#include <cmath>
#include <cstdio>
#include <ctime>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

namespace scansion::cli {
namespace {

struct Options {
  std::string recording;
  bool json = false;
};

struct Summary {
  std::uint64_t lines = 0, points = 0, runs = 0, invalid = 0;
  std::vector<std::uint64_t> points_per_level;
  std::vector<double> tolerances; ///< of the last epoch
  std::vector<std::vector<double>> epochs;
  double left_out_coarsest = 0.0;
  std::array<std::uint64_t, kFeatureTypes> features{}; ///< lines by type
  std::uint64_t feature_lines = 0, patches = 0;
  double feature_mm = 0.0;
  std::map<std::string_view, std::uint64_t> forms;
  std::optional<Backlash> backlash;
};

Result<void> count_findings(RecordingReader& reader, Summary& s) {
  SCANSION_TRY(found, read_findings(reader));
  for (const FeatureLine& line : found.lines) {
    s.features[static_cast<std::size_t>(line.type)] += 1;
    s.feature_mm += line.length_mm;
  }
  s.feature_lines = found.lines.size();
  s.patches = found.patches.size();
  s.backlash = found.backlash;
  for (const Form& form : found.forms) s.forms[name(form.kind)] += 1;
  return success();
}

// Reads headers and line tables only: the points stay where they are.
Result<Summary> summarize(RecordingReader& reader) {
  Summary s;
  const RecordingFacts& facts = reader.facts();
  s.points_per_level.assign(facts.stored_levels, 0);
  DecodedGroup decoded;
  std::uint32_t epoch = 0;
  for (std::size_t g = 0; g < reader.groups().size(); ++g) {
    SCANSION_TRY(reader.read_lines(g, decoded));
    s.lines += decoded.group.lines.size();
    s.runs += decoded.group.runs.size();
    s.points += decoded.group.points();
    for (const ScanLine& line : decoded.group.lines) s.invalid += line.invalid_after;
    for (const scansion::Run& run : decoded.group.runs) s.invalid += run.invalid_before;
    std::vector<double> tolerances;
    for (std::uint32_t k = 0; k < facts.stored_levels; ++k) {
      SCANSION_TRY(header, reader.read_header(g, k + 1));
      s.points_per_level[k] += header.points;
      if (header.kind == PayloadKind::level) tolerances.push_back(header.tolerance);
      if (k == 0) {
        s.left_out_coarsest = std::max(s.left_out_coarsest, header.left_out);
        epoch = header.epoch;
      }
    }
    if (s.epochs.empty() || decoded.alpha.epoch != epoch || s.epochs.back() != tolerances) s.epochs.push_back(tolerances);
    s.tolerances = std::move(tolerances);
  }
  SCANSION_TRY(count_findings(reader, s));
  return s;
}

std::string time_text(std::int64_t realtime_ns) {
  const auto seconds = static_cast<std::time_t>(realtime_ns / 1'000'000'000);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[40];
  const std::size_t n = std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
  char fraction[16];
  std::snprintf(fraction, sizeof fraction, ".%03dZ", static_cast<int>(realtime_ns / 1'000'000 % 1000));
  return std::string(text, n) + fraction;
}

nlohmann::ordered_json to_json(const RecordingReader& reader, const Summary& s, double resolution) {
  using nlohmann::ordered_json;
  const RecordingFacts& facts = reader.facts();
  const auto optional_time = [](const std::optional<std::int64_t>& t) {
    return t ? ordered_json(time_text(*t)) : ordered_json();
  };
  ordered_json gaps = ordered_json::array();
  for (const Gap& gap : reader.gaps())
    gaps.push_back(
        {{"first", gap.first}, {"count", gap.count ? ordered_json(*gap.count) : ordered_json()}, {"reason", gap.reason}});
  ordered_json by_type = ordered_json::object();
  for (std::size_t k = 0; k < kFeatureTypes; ++k) by_type[std::string(name(static_cast<FeatureType>(k)))] = s.features[k];
  ordered_json forms = ordered_json::object();
  for (const auto& [kind, count] : s.forms) forms[std::string(kind)] = count;
  ordered_json backlash;
  if (s.backlash)
    backlash = {{"mm", s.backlash->mm},
                {"deviation_mm", s.backlash->deviation_mm},
                {"taken_off_mm", s.backlash->taken_off_mm},
                {"places", s.backlash->places}};
  const double points = s.points == 0 ? 1.0 : static_cast<double>(s.points);
  return {{"lines", s.lines},
          {"points", s.points},
          {"runs", s.runs},
          {"gaps", reader.gaps().size()},
          {"invalid", s.invalid},
          {"resolution", resolution},
          {"unit", std::string(name(facts.lattice.unit))},
          {"exact", facts.lattice.exact},
          {"levels", s.tolerances},
          {"level_choice", to_string(facts.levels)},
          {"floor", facts.levels.floor.on() ? ordered_json(to_string(facts.levels.floor)) : ordered_json()},
          {"epochs", s.epochs},
          {"points_per_level", s.points_per_level},
          {"lossless", facts.stored_levels == facts.level_count + 1},
          {"largest_left_out_at_level_0", s.left_out_coarsest},
          {"bytes", reader.bytes()},
          {"bits_per_point", static_cast<double>(reader.bytes()) * 8.0 / points},
          {"groups", reader.groups().size()},
          {"features", s.feature_lines},
          {"features_by_type", by_type},
          {"feature_mm", std::round(s.feature_mm * 1000) / 1000},
          {"patches", s.patches},
          {"forms", forms},
          {"backlash", backlash},
          {"device", facts.device},
          {"started", optional_time(facts.started_ns)},
          {"ended", reader.end() ? optional_time(reader.end()->ended_ns) : ordered_json()},
          {"rounding_mm", reader.end() ? reader.end()->rounding_mm : facts.rounding_mm},
          {"complete", reader.complete()},
          {"gap_list", gaps}};
}

void print_text(const RecordingReader& reader, const Summary& s, double resolution) {
  const RecordingFacts& facts = reader.facts();
  const auto row = [](const char* key, const std::string& value) { std::printf("%-12s %s\n", key, value.c_str()); };
  row("device", facts.device);
  row("state", reader.complete() ? "complete" : "unfinished (killed or still being written)");
  row("lines", std::to_string(s.lines) + " in " + std::to_string(reader.groups().size()) + " groups");
  row("points",
      std::to_string(s.points) + " in " + std::to_string(s.runs) + " runs, " + std::to_string(s.invalid) + " invalid samples");
  row("gaps", std::to_string(reader.gaps().size()));
  row("unit", std::string(name(facts.lattice.unit)));
  row("resolution", number(resolution) + " mm per count" + (facts.lattice.exact ? ", every IEEE bit kept" : ""));
  if (const Floor& floor = facts.levels.floor; floor.on())
    row("floor", floor.counts ? "half a count: ranked no finer" : to_string(floor) + " mm: ranked no finer");
  if (s.epochs.size() > 1) row("epochs", std::to_string(s.epochs.size()) + "; the levels below are the last one's");
  std::uint64_t sum = 0;
  for (std::uint32_t k = 0; k < facts.stored_levels; ++k) {
    sum += s.points_per_level[k];
    const std::string tolerance =
        k < s.tolerances.size() ? "tolerance " + number(s.tolerances[k]) + " mm" : std::string("every point");
    const double share = s.points == 0 ? 0.0 : 100.0 * static_cast<double>(sum) / static_cast<double>(s.points);
    row(("level " + std::to_string(k)).c_str(),
        std::to_string(sum) + " points (" + number(std::round(share * 100) / 100) + " %), " + tolerance);
  }
  const double bits = s.points == 0 ? 0.0 : static_cast<double>(reader.bytes()) * 8.0 / static_cast<double>(s.points);
  row("size", std::to_string(reader.bytes()) + " bytes, " + number(std::round(bits * 1000) / 1000) + " bit/point");
  if (facts.features) {
    std::string text = std::to_string(s.feature_lines) + " lines, " + number(std::round(s.feature_mm * 10) / 10) + " mm";
    for (std::size_t k = 0; k < kFeatureTypes; ++k) {
      if (s.features[k] > 0)
        text += ", " + std::to_string(s.features[k]) + " " + std::string(name(static_cast<FeatureType>(k)));
    }
    row("features", text);
    text = std::to_string(s.patches);
    for (const auto& [kind, count] : s.forms) text += ", " + std::to_string(count) + " " + std::string(kind);
    row("patches", text);
    if (const auto& b = s.backlash)
      row("backlash", number(b->mm) + " mm, +-" + number(b->deviation_mm) + ", from " + std::to_string(b->places) +
                          " places, " + (b->taken_off_mm != 0.0 ? number(b->taken_off_mm) + " mm taken off" : "not taken off"));
  }
  if (facts.started_ns) row("started", time_text(*facts.started_ns));
  if (reader.end() && reader.end()->ended_ns) row("ended", time_text(*reader.end()->ended_ns));
  for (const Gap& gap : reader.gaps())
    row("gap", "line " + std::to_string(gap.first) + ", " + (gap.count ? std::to_string(*gap.count) : "unknown number of") +
                   " lines: " + gap.reason);
}

Result<int> run_info(const Options& o) {
  SCANSION_TRY(recording, readable_recording(o.recording));
  SCANSION_TRY(reader, RecordingReader::open(recording));
  SCANSION_TRY(resolution, resolution_mm(reader.facts().lattice));
  SCANSION_TRY(summary, summarize(reader));
  if (o.json)
    std::printf("%s\n", to_json(reader, summary, resolution.value()).dump(2).c_str());
  else
    print_text(reader, summary, resolution.value());
  return kDone;
}

} // namespace

Verb add_info(CLI::App& root) {
  auto* app = root.add_subcommand("info", "Say what a recording holds");
  auto o = std::make_shared<Options>();
  app->add_option("recording", o->recording, "The recording")->required();
  app->add_flag("--json", o->json, "Print JSON");
  return {app, [o] { return run_info(*o); }};
}

} // namespace scansion::cli
