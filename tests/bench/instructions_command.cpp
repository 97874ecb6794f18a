// scansion_bench instructions: instructions a point of the ranking, counted by valgrind: the work itself, whatever the load.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/commands.hpp"
#include "tests/bench/our_ranking.hpp"
#include "tests/bench/process.hpp"
#include "tests/bench/scratch.hpp"

#include <cstdio>
#include <fstream>
#include <string_view>

namespace scansion::bench {

// What valgrind counts: names without mangling, and never inlined.
extern "C" {
[[gnu::noinline]] void scansion_bench_rank_and_order(OurRanking* ranking, const RunView* run);
[[gnu::noinline]] void scansion_bench_rank_alone(OurRanking* ranking, const RunView* run);

void scansion_bench_rank_and_order(OurRanking* ranking, const RunView* run) {
  ranking->full(*run);
}

void scansion_bench_rank_alone(OurRanking* ranking, const RunView* run) {
  ranking->distances(*run);
}
}

namespace {

constexpr std::uint32_t kShort = 1094;
constexpr std::uint32_t kLong = 17504;

struct Kind {
  const char* scene;
  Bar bar;
};
constexpr Kind kKinds[] = {{"part", {1.7, 1.3}}, {"zigzag", {1.7, 1.6}}, {"two-step", {1.7, 1.2}}};

/// Inside valgrind: SCENE:POINTS. Once for the memory, then what is counted.
Result<void> rank_once(const std::string& what) {
  const std::size_t colon = what.find(':');
  if (colon == std::string::npos) return fail(Errc::usage, "--child takes SCENE:POINTS");
  const auto points = static_cast<std::uint32_t>(std::strtoul(what.c_str() + colon + 1, nullptr, 10));
  SCANSION_TRY(set, scene_set(what.substr(0, colon), 1, points));
  OurRanking ranking(set.resolution_mm);
  const auto runs = set.runs();
  ranking.full(runs.front());
  scansion_bench_rank_and_order(&ranking, &runs.front());
  scansion_bench_rank_alone(&ranking, &runs.front());
  return success();
}

/// Instructions between entry and exit of `function`; 0 when valgrind says nothing.
double count(const Options& o, const char* scene, std::uint32_t points, const char* function) {
  const ScratchFolder folder;
  const std::string file = folder.file("callgrind");
  const Ended ended =
      run_program({"valgrind", "--tool=callgrind", std::string("--toggle-collect=") + function, "--callgrind-out-file=" + file,
                   o.bin + "/scansion_bench", "instructions", "--child", std::string(scene) + ":" + std::to_string(points)},
                  true);
  if (ended.status != 0) return 0.0;
  std::ifstream in(file);
  constexpr std::string_view kTotals = "totals: ";
  for (std::string line; std::getline(in, line);)
    if (line.starts_with(kTotals)) return std::strtod(line.c_str() + kTotals.size(), nullptr) / points;
  return 0.0;
}

} // namespace

Result<void> run_instructions(const Options& options, Report& report) {
  if (!options.child.empty()) return rank_once(options.child);
  Table table("Instructions a point of the ranking, one line of 17,504 against one of 1,094 points",
              {"line", "distances 1,094", "distances 17,504", "ratio", "with order 1,094", "with order 17,504",
               "ratio with order", "must", "good", "mark"},
              "Counted by valgrind's callgrind, which offers the program no AVX-512. The bar is on the ratio with order.");
  for (const Kind& kind : kKinds) {
    std::vector<Cell> cells{kind.scene};
    double ratio = 0.0;
    for (const char* function : {"scansion_bench_rank_alone", "scansion_bench_rank_and_order"}) {
      const double small = count(options, kind.scene, kShort, function);
      const double large = count(options, kind.scene, kLong, function);
      if (small == 0.0 || large == 0.0) {
        std::fputs("scansion_bench: instructions need the Debian package valgrind\n", stderr);
        cells.emplace_back("not counted: valgrind");
        break;
      }
      ratio = large / small;
      cells.insert(cells.end(), {Figure{small, 1}, Figure{large, 1}, Figure{ratio, 3}});
    }
    if (cells.size() == 7) report.judge(cells, ratio, kind.bar);
    table.add(std::move(cells));
  }
  report.print(table);
  return success();
}

} // namespace scansion::bench
