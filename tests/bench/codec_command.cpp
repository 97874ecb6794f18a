// scansion_bench codec: encoding, decoding, the whole pipeline and the feature stage, as shares of the plain ranking of the
// same lines. SPDX-License-Identifier: Apache-2.0
#include "tests/bench/commands.hpp"
#include "tests/bench/our_codec.hpp"
#include "tests/bench/our_features.hpp"
#include "tests/bench/plane_lines.hpp"

namespace scansion::bench {
namespace {

constexpr Bar kEncode{0.35, 0.20};
constexpr Bar kDecode{0.25, 0.12};
constexpr Bar kWhole{0.50, 0.32};
constexpr Bar kFeatures{0.10, 0.04};

/// Which lines of a set are taken: groups evenly over it, or all as they follow each other.
enum class Taken : std::uint8_t { groups, whole };

Result<std::vector<LineSet>> sets_of(const Options& o, Taken taken) {
  struct Scene {
    const char* name;
    std::uint32_t points;
  };
  const Scene scenes[] = {{"part", 1094}, {"plane", 1000}, {"freeform", 1000}, {"steps", 1000}};
  std::vector<LineSet> sets;
  for (const Scene& scene : scenes) {
    // The scene's own spacing: neighbouring lines are what the codec lives on.
    SCANSION_TRY(set, scene_set(scene.name, 0, scene.points));
    if (taken == Taken::groups) thin_out(set, o.lines == 0 ? 2 * kGroupLines : o.lines, 0, kGroupLines);
    if (taken == Taken::whole) thin_out(set, o.lines, 0, set.lines.size());
    sets.push_back(std::move(set));
  }
  SCANSION_TRY(files, file_sets(o));
  for (LineSet& set : files) {
    if (taken == Taken::groups) thin_out(set, o.lines, o.points, kGroupLines);
    if (taken == Taken::whole) thin_out(set, o.lines, 0, set.lines.size());
    sets.push_back(std::move(set));
  }
  return sets;
}

void add_row(Report& report, Table& table, const LineSet& set, const PairResult& r, const Bar& bar) {
  const auto n = static_cast<double>(set.points);
  const double megapoints = 1e3 * n / r.ours_ns;
  std::vector<Cell> cells{set.name,
                          Figure{r.ours_ns / n, 1},
                          Figure{r.peer_ns / n, 1},
                          Figure{megapoints, 1},
                          Figure{r.ratio.median, 3},
                          Figure{r.ratio.low, 3},
                          Figure{r.ratio.high, 3}};
  report.judge(cells, r.ratio.median, bar);
  table.add(std::move(cells));
}

// What is found hangs together from line to line, so scans are taken whole.
Result<void> time_features(const Options& options, const std::vector<std::string>& columns, const LevelSpec& levels,
                           Report& report) {
  SCANSION_TRY(sets, sets_of(options, Taken::whole));
  Table features("Feature lines and patches / plain ranking", columns,
                 "One thread; the feature stage on ranked groups, whole scans from the first line to the last finding.");
  for (const LineSet& set : sets) {
    const PlaneLines lines = plane_lines(set.runs(), set.resolution_mm);
    Plain plain;
    const auto rank_plain = [&] {
      for (const auto& line : lines) plain.rank(line);
    };
    OurFeatures stage(set, levels);
    add_row(report, features, set, run_pairs([&] { stage.run(); }, rank_plain, options.pairs), kFeatures);
  }
  report.print(features);
  return success();
}

} // namespace

Result<void> run_codec(const Options& options, Report& report) {
  SCANSION_TRY(sets, sets_of(options, Taken::groups));
  const std::vector<std::string> columns{"lines", "ours ns/pt", "plain ns/pt", "Mpt/s", "ratio",
                                         "q1",    "q3",         "must",        "good",  "mark"};
  Table encode("Encoding groups without ranking / plain ranking", columns);
  Table decode("Decoding groups, lossless / plain ranking", columns);
  Table whole(
      "Whole pipeline, line in -> checksummed group ready to write / plain ranking", columns,
      "One thread; grouping, ranking, calibration, encoding and the chunk around the payloads, without features. Median of " +
          std::to_string(options.pairs.pairs) + " pairs in alternation, thread processor time.");
  const LevelSpec levels;
  for (const LineSet& set : sets) {
    const PlaneLines lines = plane_lines(set.runs(), set.resolution_mm);
    Plain plain;
    const auto rank_plain = [&] {
      for (const auto& line : lines) plain.rank(line);
    };
    SCANSION_TRY(codec, OurCodec::make(set, levels));
    OurPipeline pipeline(set, levels);
    add_row(report, encode, set, run_pairs([&] { codec.encode(); }, rank_plain, options.pairs), kEncode);
    add_row(report, decode, set, run_pairs([&] { codec.decode(); }, rank_plain, options.pairs), kDecode);
    add_row(report, whole, set, run_pairs([&] { pipeline.run(); }, rank_plain, options.pairs), kWhole);
  }
  report.print(encode);
  report.print(decode);
  report.print(whole);
  return time_features(options, columns, levels, report);
}

} // namespace scansion::bench
