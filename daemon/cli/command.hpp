// What every verb of `scansion` shares: messages, progress, exit codes, stopping.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/export/export.hpp"
#include "pipeline/model/result.hpp"

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <string>

namespace scansion::cli {

/// Exit codes beside those of exit_code(Errc).
inline constexpr int kDone = 0;
inline constexpr int kBadAnswer = 1; ///< finished, but the answer is bad
inline constexpr int kUsage = 2;
inline constexpr int kInterrupted = 130;

/// A verb adds its options to the command line and says what to run; the value is the exit code.
using Run = std::function<Result<int>()>;
struct Verb {
  CLI::App* app;
  Run run;
};

[[nodiscard]] Verb add_compress(CLI::App& root);
[[nodiscard]] Verb add_export(CLI::App& root);
[[nodiscard]] Verb add_info(CLI::App& root);
[[nodiscard]] Verb add_verify(CLI::App& root);
[[nodiscard]] Verb add_recover(CLI::App& root);
[[nodiscard]] Verb add_compare(CLI::App& root);
[[nodiscard]] Verb add_view(CLI::App& root);
[[nodiscard]] Verb add_status(CLI::App& root);
[[nodiscard]] Verb add_tail(CLI::App& root);
[[nodiscard]] Verb add_devices(CLI::App& root);
[[nodiscard]] Verb add_stop(CLI::App& root);
[[nodiscard]] Verb add_start(CLI::App& root);
[[nodiscard]] Verb add_completion(CLI::App& root);

/// Takes numbers above 0, and says so otherwise.
[[nodiscard]] const CLI::Validator& positive_number();

/// One line on standard error, with the program's name in front.
void say(const std::string& message);

/// SIGINT and SIGTERM from now on end the program with exit code 130 and leave no temporary file behind.
void catch_stop_signals();

/// A line on standard error that is redrawn while work goes on; only on a terminal.
class ProgressLine {
public:
  explicit ProgressLine(std::string what);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  void show(std::uint64_t done, std::uint64_t total);

private:
  std::string what_;
  bool terminal_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point next_;
};

/// Shortest text of a double.
[[nodiscard]] std::string number(double value);
/// Inclusive line ranges as "3-17, 40".
[[nodiscard]] std::string ranges(const std::vector<std::pair<std::uint64_t, std::uint64_t>>& lines);

} // namespace scansion::cli
