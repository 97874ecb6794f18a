// The subcommands of scansion_bench.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"
#include "tests/bench/lines.hpp"
#include "tests/bench/pairs.hpp"
#include "tests/bench/report.hpp"

#include <string>
#include <vector>

namespace scansion::bench {

struct Options {
  std::vector<std::string> files; ///< FILE or FILE:UNIT
  PairOptions pairs;
  std::uint32_t lines = 0;        ///< at most so many lines of each set; 0: the row's own
  std::size_t points = 1U << 17U; ///< of each file, about, for timing; taken evenly
  std::string bin;                ///< folder of the programs
  std::string child;              ///< instructions: the line to rank, inside valgrind
};

[[nodiscard]] Result<void> run_rank(const Options& options, Report& report);
[[nodiscard]] Result<void> run_codec(const Options& options, Report& report);
[[nodiscard]] Result<void> run_size(const Options& options, Report& report);
[[nodiscard]] Result<void> run_instructions(const Options& options, Report& report);
[[nodiscard]] Result<void> run_stages(const Options& options, Report& report);
[[nodiscard]] Result<void> run_threads(const Options& options, Report& report);
/// What `features` is asked for.
struct FeatureOptions {
  std::string truth, lines, patches; ///< files to be judged; empty: scenes are scanned
  std::vector<std::string> scenes;   ///< empty: all small parts
  std::vector<double> pitches{0.1, 0.2, 0.5}, noises{5.0, 20.0, 50.0}, directions{0.0, 30.0, 90.0};
  std::vector<std::string> faults{"clean", "dirty"};
  bool paper = false; ///< linking = paper
  double backlash_um = 0.0;
  bool correct = false; ///< backlash = correct
  bool shorter = false;
  bool rows = false; ///< a row for every scan, not only means
};
[[nodiscard]] Result<void> run_features(const FeatureOptions& options, Report& report);

/// Answers requests on standard input until its end.
[[nodiscard]] Result<void> run_rank_coproc(const std::string& file);

/// The files asked for, each read whole.
[[nodiscard]] Result<std::vector<LineSet>> file_sets(const Options& options);

} // namespace scansion::bench
