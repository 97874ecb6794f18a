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
/// Answers requests on standard input until its end.
[[nodiscard]] Result<void> run_rank_coproc(const std::string& file);

/// The files asked for, each read whole.
[[nodiscard]] Result<std::vector<LineSet>> file_sets(const Options& options);

} // namespace scansion::bench
