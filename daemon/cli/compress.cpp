// scansion compress: recorded scans in, a ranked and compressed recording out.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/command.hpp"
#include "daemon/cli/group_workers.hpp"
#include "daemon/cli/streams.hpp"
#include "pipeline/codec/crc32c.hpp"
#include "pipeline/feature/feature_stage.hpp"
#include "pipeline/import/import.hpp"
#include "pipeline/record/writer.hpp"

#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace scansion::cli {
namespace {

struct Options {
  std::vector<std::string> inputs;
  std::string output, format = "auto", unit = "mm", resolution = "auto", levels = "geometric:3", columns, grid = "cols",
                      floor = "off", features = "on";
  std::string device = "file";
  std::string linking = "soft", backlash = "report";
  double gap = 0.0, spacing = 1.0, noise = 0.0, noise_correlation = 1.0;
  FeatureLimits limits;
  unsigned threads = 0;
  bool has_gap = false, has_noise = false, json = false, force = false;
};

struct Totals {
  std::uint64_t lines = 0, points = 0, bytes = 0;
  StageTimes times;
  double wall_s = 0.0;
  double rounding_mm = 0.0;
  std::uint64_t invalid = 0, missing = 0;
};

Result<ImportOptions> import_options(const Options& o) {
  ImportOptions import;
  if (o.format == "xyz")
    import.format = ImportFormat::xyz;
  else if (o.format == "ply")
    import.format = ImportFormat::ply;
  else if (o.format == "csv")
    import.format = ImportFormat::csv;
  SCANSION_TRY(unit, parse_unit(o.unit));
  import.unit = unit;
  if (o.resolution == "exact") {
    import.resolution = ResolutionExact{};
  } else if (o.resolution != "auto") {
    const auto given = parse_rational(o.resolution);
    if (!given)
      return fail(Errc::usage, "resolution '", o.resolution, "' is none of auto, exact or a decimal above 0 in input units");
    import.resolution = ResolutionGiven{given.value()};
  }
  if (o.has_gap) import.gap_mm = o.gap;
  import.grid_rows = o.grid == "rows";
  import.spacing = o.spacing;
  import.columns = o.columns;
  return import;
}

/// The id depends on what is recorded, not on when, so that equal input gives equal bytes.
std::uint32_t stream_id(const RecordingFacts& facts) {
  const Lattice& l = facts.lattice;
  std::string text = facts.device + '/' + to_string(facts.levels) + '/' + std::string(name(l.unit));
  for (const std::int64_t v : {l.resolution.num, l.resolution.den, l.origin[0], l.origin[1], l.origin[2]})
    text += '/' + std::to_string(v);
  if (facts.levels.floor.on()) text += '/' + to_string(facts.levels.floor);
  return crc32c(0, std::as_bytes(std::span(text)));
}

FeatureSettings feature_settings(const Options& o) {
  FeatureSettings settings;
  settings.linking = o.linking == "paper" ? Linking::paper : Linking::soft;
  settings.backlash = o.backlash == "correct" ? BacklashUse::correct : BacklashUse::report;
  if (o.has_noise) settings.noise_mm = o.noise;
  settings.noise_correlation = o.noise_correlation;
  settings.limits = o.limits;
  return settings;
}

/// Feature lines beside the groups, in their order.
class FeatureRecorder {
public:
  FeatureRecorder(const Options& o, const Lattice& lattice) {
    if (o.features == "on") stage_.emplace(lattice, feature_settings(o));
  }
  Result<void> add(const LineGroup& group, const GroupRanks& ranks, std::uint64_t log_time_ns, RecordingWriter& writer) {
    if (!stage_) return success();
    const std::int64_t start = thread_time_ns();
    report_.group = group.number;
    log_time_ns_ = log_time_ns;
    stage_->add(group, ranks.distance, report_);
    auto written = report_.empty() ? Result<void>(success()) : writer.append(report_, log_time_ns);
    ns_ += thread_time_ns() - start;
    return written;
  }
  Result<void> finish(RecordingWriter& writer) {
    if (!stage_) return success();
    const std::int64_t start = thread_time_ns();
    stage_->finish(report_);
    auto written = writer.append(report_, log_time_ns_);
    ns_ += thread_time_ns() - start;
    return written;
  }
  [[nodiscard]] std::int64_t ns() const noexcept { return ns_; }

private:
  std::optional<FeatureStage> stage_;
  FeatureReport report_;
  std::uint64_t log_time_ns_ = 0;
  std::int64_t ns_ = 0;
};

class Compression {
public:
  Compression(const Options& options, LevelSpec levels) : options_(options), levels_(std::move(levels)) {}

  /// One attempt at writing `path`; fails with finer when the lattice turns out too coarse.
  Result<Totals> write(Importer& importer, const std::string& path);

private:
  Result<void> pump(Importer& importer, GroupWorkers& workers, Totals& totals);
  [[nodiscard]] RecordingFacts facts(const Importer& importer) const;

  const Options& options_;
  LevelSpec levels_;
};

RecordingFacts Compression::facts(const Importer& importer) const {
  RecordingFacts facts;
  facts.device = options_.device;
  facts.lattice = importer.lattice();
  facts.levels = levels_;
  facts.level_count = levels_.count;
  facts.stored_levels = levels_.count + 1;
  if (options_.has_gap) facts.gap_mm = options_.gap;
  facts.features = options_.features == "on";
  facts.stream = stream_id(facts);
  return facts;
}

Result<void> Compression::pump(Importer& importer, GroupWorkers& workers, Totals& totals) {
  ProgressLine progress("compress");
  GroupBuilder builder;
  LineBuffer line;
  LineGroup group;
  while (true) {
    const std::int64_t start = thread_time_ns();
    SCANSION_TRY(more, importer.next(line));
    const bool close = !builder.empty() && (!more || builder.must_close_before(line));
    if (close) builder.take(group);
    if (more) builder.add(line);
    totals.times.read += thread_time_ns() - start;
    if (close) {
      progress.show(importer.counts().bytes_read, importer.counts().bytes_total);
      SCANSION_TRY(workers.push(group));
    }
    if (!more) return workers.drain();
  }
}

Result<Totals> Compression::write(Importer& importer, const std::string& path) {
  Totals totals;
  const RecordingFacts facts = this->facts(importer);
  SCANSION_TRY(resolution, resolution_mm(facts.lattice));
  SCANSION_TRY(writer, RecordingWriter::create(path, facts, ChunkRule::many_groups));
  FeatureRecorder features(options_, facts.lattice);
  GroupWorkers workers(options_.threads, levels_, resolution, facts.stream,
                       [&](const LineGroup& group, const GroupRanks& ranks, const EncodedGroup& encoded) -> Result<void> {
                         std::uint64_t invalid = 0;
                         for (const ScanLine& line : group.lines) invalid += line.invalid_after;
                         for (const scansion::Run& run : group.runs) invalid += run.invalid_before;
                         SCANSION_TRY(writer.append(encoded, group.points(), group.runs.size(), invalid));
                         return features.add(group, ranks, encoded.last_time_ns, writer);
                       });
  SCANSION_TRY(pump(importer, workers, totals));
  const std::int64_t in_commits = features.ns();
  SCANSION_TRY(features.finish(writer));
  const std::int64_t start = thread_time_ns();
  SCANSION_TRY(writer.finish(std::nullopt, importer.counts().rounding_mm));
  const std::int64_t read = totals.times.read;
  totals.times = workers.times();
  totals.times.read = read;
  totals.times.write += thread_time_ns() - start - in_commits;
  totals.times.features = features.ns();
  totals.lines = writer.totals().lines;
  totals.points = writer.totals().points;
  totals.invalid = writer.totals().invalid;
  totals.bytes = writer.bytes();
  totals.missing = importer.counts().missing;
  totals.rounding_mm = importer.counts().rounding_mm;
  return totals;
}

void report(const Options& o, const Totals& t) {
  const double points = t.points == 0 ? 1.0 : static_cast<double>(t.points);
  const double bits = static_cast<double>(t.bytes) * 8.0 / points;
  if (o.json) {
    const auto per_point = [&](std::int64_t ns) { return static_cast<double>(ns) / points; };
    const nlohmann::ordered_json out = {{"lines", t.lines},
                                        {"points", t.points},
                                        {"invalid", t.invalid},
                                        {"bytes", t.bytes},
                                        {"bits_per_point", bits},
                                        {"wall_s", t.wall_s},
                                        {"rounding_mm", t.rounding_mm},
                                        {"cpu_ns_per_point",
                                         {{"read", per_point(t.times.read)},
                                          {"rank", per_point(t.times.rank)},
                                          {"encode", per_point(t.times.encode)},
                                          {"features", per_point(t.times.features)},
                                          {"write", per_point(t.times.write)}}}};
    std::printf("%s\n", out.dump().c_str());
    return;
  }
  std::string text = o.output + ": " + std::to_string(t.lines) + " lines, " + std::to_string(t.points) + " points, " +
                     std::to_string(t.bytes) + " bytes, " + number(std::round(bits * 1000) / 1000) + " bit/point";
  if (t.invalid > 0) text += ", " + std::to_string(t.invalid) + " invalid samples";
  if (t.missing > 0) text += ", " + std::to_string(t.missing) + " empty grid cells";
  if (t.rounding_mm > 0) text += ", rounded by up to " + number(t.rounding_mm) + " mm";
  say(text);
}

Result<int> compress(Options o) {
  const auto started = std::chrono::steady_clock::now();
  SCANSION_TRY(levels, parse_level_spec(o.levels));
  SCANSION_TRY(floor, parse_floor(o.floor));
  levels.floor = floor;
  SCANSION_TRY(import, import_options(o));
  if (o.threads == 0) o.threads = std::max(1U, std::thread::hardware_concurrency());
  o.threads = std::min(o.threads, kMostThreads);
  SCANSION_TRY(json_has_room(o.json, o.output));
  SCANSION_TRY(spares_inputs(o.output, o.inputs));
  SCANSION_TRY(pending, RecordingOutput::create(o.output, o.force));
  SCANSION_TRY(importer, Importer::open(o.inputs, import, [](const std::string& note) { say(note); }));

  Compression compression(o, levels);
  Result<Totals> totals = compression.write(importer, pending.name());
  if (!totals && totals.error().code == Errc::finer) {
    ::unlink(pending.name().c_str());
    SCANSION_TRY(importer.survey_all());
    totals = compression.write(importer, pending.name());
  }
  if (!totals) return boost::outcome_v2::failure(totals.error());
  SCANSION_TRY(pending.commit());
  totals.value().wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  report(o, totals.value());
  return kDone;
}

} // namespace

Verb add_compress(CLI::App& root) {
  auto* app = root.add_subcommand("compress", "Rank and compress recorded scans into one recording");
  auto o = std::make_shared<Options>();
  app->add_option("input", o->inputs, "Files, folders, archives, packed files; - is standard input")->required();
  app->add_option("-o,--output", o->output, "The recording (.mcap); - is standard output")->required();
  app->add_option("--format", o->format, "Form of the input")
      ->check(CLI::IsMember({"auto", "xyz", "ply", "csv"}))
      ->capture_default_str();
  app->add_option("--unit", o->unit, "Unit of the input: m, mm, um, in, ft")->capture_default_str();
  app->add_option("--resolution", o->resolution, "Input units per count, or auto (from the decimals), or exact (every bit)")
      ->capture_default_str();
  auto* gap = app->add_option("--gap", o->gap, "A step longer than this many mm starts a new run")->check(positive_number());
  app->add_option("--levels", o->levels, "geometric:N[:RATIO], uniform:N[:DMAX] or explicit:T1,T2,... in mm")
      ->capture_default_str();
  app->add_option("--floor", o->floor, "Rank no finer than this: off, half (a count) or mm; stated in the recording")
      ->capture_default_str();
  app->add_option("--features", o->features, "Find feature lines and patches")
      ->check(CLI::IsMember({"on", "off"}))
      ->capture_default_str();
  app->add_option("--linking", o->linking, "How points are linked to feature lines: soft, or paper (equality of all classes)")
      ->check(CLI::IsMember({"soft", "paper"}))
      ->capture_default_str();
  auto* noise =
      app->add_option("--noise", o->noise, "Sigma of the heights in mm, measured on a flat target (default: estimated)")
          ->check(positive_number());
  app->add_option("--noise-correlation", o->noise_correlation,
                  "The estimate of the noise is multiplied by this; 3 for laser triangulation")
      ->check(positive_number())
      ->capture_default_str();
  app->add_option("--least-turning", o->limits.least_turning, "Degrees: an edge that turns less is none")
      ->check(CLI::Range(2.0, 90.0))
      ->capture_default_str();
  app->add_option("--least-step", o->limits.least_step,
                  "A step lower than this many mm is none (at least 8 sigma of the noise)")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--largest-arc", o->limits.largest_arc,
                  "An arc with a radius of more mm is a smooth surface and no rounded edge (at least 6 pitches or spacings)")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app->add_option("--shortest-line", o->limits.shortest_line,
                  "Feature lines shorter than this many mm part patches, but are not recorded")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app->add_option("--backlash", o->backlash,
                  "Of lines to and fro: report it, or correct it where features are looked for (points stay as they are)")
      ->check(CLI::IsMember({"report", "correct"}))
      ->capture_default_str();
  app->add_option("--threads", o->threads,
                  "Threads for ranking and coding, up to 16; 0: one per processor. Never changes the output")
      ->check(CLI::Range(0, 256))
      ->capture_default_str();
  app->add_option("--grid", o->grid, "What a scan line is in a PLY range grid")
      ->check(CLI::IsMember({"cols", "rows"}))
      ->capture_default_str();
  app->add_option("--spacing", o->spacing, "Input units between profiles that have no y")
      ->check(positive_number())
      ->capture_default_str();
  app->add_option("--columns", o->columns, "What text columns mean, e.g. x,z,- or x,y,z,line");
  app->add_option("--device", o->device, "Name of the device in the recording")->capture_default_str();
  app->add_flag("--force", o->force, "Replace an existing output");
  app->add_flag("--json", o->json, "Print the figures as JSON");
  return {app, [o, gap, noise] {
            o->has_gap = gap->count() > 0;
            o->has_noise = noise->count() > 0;
            return compress(*o);
          }};
}

} // namespace scansion::cli
