// scansion_bench rank: the full ranking beside the plain one and beside one answer of other programs.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/commands.hpp"
#include "tests/bench/our_ranking.hpp"
#include "tests/bench/peers.hpp"
#include "tests/bench/plain.hpp"

namespace scansion::bench {
namespace {

constexpr Bar kLongLines{0.25, 0.18};
constexpr Bar kShortLines{0.32, 0.22};
constexpr Bar kZigzag{0.025, 0.016};
constexpr Bar kTwoStep{0.05, 0.035};
constexpr Bar kFlat{0.20, 0.12};
constexpr Bar kOneAnswer{0.90, 0.60};
constexpr double kTolerance = 0.05;
// A file whose runs are shorter than this in the mean is judged as one of short lines.
constexpr std::size_t kShort = 400;

struct Row {
  LineSet set;
  Bar bar;
  bool part = false; ///< a part line of 800 points or more: the bar against one answer holds
};

Result<std::vector<Row>> rows_of(const Options& o) {
  struct Scene {
    const char* name;
    std::uint32_t lines, points;
    Bar bar;
    bool part;
  };
  const Scene scenes[] = {{"part", 16, 800, kLongLines, true},    {"part", 16, 1094, kLongLines, true},
                          {"part", 8, 2048, kLongLines, true},    {"part", 8, 4096, kLongLines, true},
                          {"part", 64, 200, kShortLines, false},  {"zigzag", 1, 4096, kZigzag, false},
                          {"two-step", 2, 4096, kTwoStep, false}, {"flat", 4, 4096, kFlat, false}};
  std::vector<Row> rows;
  for (const Scene& scene : scenes) {
    SCANSION_TRY(set, scene_set(scene.name, scene.lines, scene.points));
    thin_out(set, o.lines, 0);
    set.name += ", lines of " + std::to_string(scene.points);
    rows.push_back({std::move(set), scene.bar, scene.part});
  }
  SCANSION_TRY(files, file_sets(o));
  for (LineSet& set : files) {
    thin_out(set, o.lines, o.points);
    const bool is_short = set.points < kShort * set.runs().size();
    rows.push_back({std::move(set), is_short ? kShortLines : kLongLines, false});
  }
  return rows;
}

std::vector<Cell> row_of(Report& report, const std::string& name, std::size_t points, const PairResult& r,
                         const std::optional<Bar>& bar) {
  const auto n = static_cast<double>(points);
  std::vector<Cell> cells{name,
                          Figure{r.ours_ns / n, 1},
                          Figure{r.peer_ns / n, 1},
                          Figure{r.ratio.median, 3},
                          Figure{r.ratio.low, 3},
                          Figure{r.ratio.high, 3}};
  report.judge(cells, r.ratio.median, bar);
  return cells;
}

std::vector<std::string> columns(const char* peer) {
  return {"lines", "ours ns/pt", std::string(peer) + " ns/pt", "ratio", "q1", "q3", "must", "good", "mark"};
}

void against_plain(const Options& o, const std::vector<Row>& rows, Report& report) {
  Table table("Full ranking with order / plain Douglas-Peucker carried to the last point", columns("plain"),
              "Median of " + std::to_string(o.pairs.pairs) + " pairs in alternation, thread processor time.");
  for (const Row& row : rows) {
    const auto runs = row.set.runs();
    OurRanking ours(row.set.resolution_mm);
    const FlatRuns flat = row.set.flat_runs(0, row.set.lines.size());
    const PlaneLines lines = plane_lines(runs, row.set.resolution_mm);
    Plain plain;
    const auto result = run_pairs([&] { ours.full(flat); },
                                  [&] {
                                    for (const auto& line : lines) plain.rank(line);
                                  },
                                  o.pairs);
    table.add(row_of(report, row.set.name, row.set.points, result, row.bar));
  }
  report.print(table);
}

using MakePeer = std::unique_ptr<Simplifier> (*)(const PlaneLines&);

void against_one_answer(const Options& o, const std::vector<Row>& rows, const char* peer, const char* package, MakePeer make,
                        const std::optional<Bar>& bar, Report& report) {
  std::vector<std::string> names = columns(peer);
  names.insert(names.end(), {"ours keeps", "peer keeps"});
  Table table(std::string("Full ranking with order / ONE answer of ") + peer + " at 0.05 mm", std::move(names),
              "Points kept at 0.05 mm: ties and lines outside a plane may differ.");
  for (const Row& row : rows) {
    const auto runs = row.set.runs();
    const auto simplifier = make(plane_lines(runs, row.set.resolution_mm));
    if (!simplifier) {
      table.add({row.set.name, "not built: " + std::string(package)});
      continue;
    }
    OurRanking ours(row.set.resolution_mm);
    const FlatRuns flat = row.set.flat_runs(0, row.set.lines.size());
    std::size_t kept = 0;
    const auto result = run_pairs([&] { ours.full(flat); }, [&] { kept = simplifier->run(kTolerance); }, o.pairs);
    std::vector<Cell> cells = row_of(report, row.set.name, row.set.points, result, row.part ? bar : std::nullopt);
    cells.insert(cells.end(), {Count{ours.full(flat, kTolerance)}, Count{kept}});
    table.add(std::move(cells));
  }
  report.print(table);
}

} // namespace

Result<void> run_rank(const Options& options, Report& report) {
  SCANSION_TRY(rows, rows_of(options));
  against_plain(options, rows, report);
  against_one_answer(options, rows, "Boost.Geometry", kBoostPackage, boost_simplifier, kOneAnswer, report);
  against_one_answer(options, rows, "GEOS", kGeosPackage, geos_simplifier, {}, report);
  return success();
}

} // namespace scansion::bench
