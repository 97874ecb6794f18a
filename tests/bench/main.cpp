// scansion_bench: speed and size beside other programs, measured in one run (docs/BENCHMARKS.md).
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/commands.hpp"

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <unistd.h>

namespace scansion::bench {
namespace {

using Command = Result<void> (*)(const Options&, Report&);

std::string folder_of_this_program() {
  std::string path(4096, '\0');
  const ssize_t size = ::readlink("/proc/self/exe", path.data(), path.size());
  path.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
  return path.substr(0, path.rfind('/'));
}

int end_with(const Result<void>& result) {
  if (result) return 0;
  std::fprintf(stderr, "scansion_bench: %s\n", result.error().context.c_str());
  return exit_code(result.error().code);
}

CLI::App* add_features(CLI::App& root, FeatureOptions& f, bool& json, bool& check) {
  CLI::App* app = root.add_subcommand("features", "Feature lines and patches against the ground truth");
  app->add_option("--truth", f.truth, "Ground truth of a scan (scansim scene --truth); needs --found");
  app->add_option("--found", f.lines, "Feature lines to judge (scansion export --what features --format txt)");
  app->add_option("--patches", f.patches, "Patches to judge (scansion export --what patches --format txt)");
  app->add_option("--scene", f.scenes, "Scenes to scan (default: all small parts)")->delimiter(',');
  app->add_option("--pitch", f.pitches, "mm, of points and lines")->delimiter(',');
  app->add_option("--noise", f.noises, "um")->delimiter(',');
  app->add_option("--direction", f.directions, "degrees")->delimiter(',');
  app->add_option("--fault", f.faults,
                  "clean, dirty, tilt, zigzag, correlated, outliers, dropouts, missing, jitter, or all for each of them")
      ->delimiter(',');
  app->add_flag("--paper", f.paper, "Link by the paper's rules");
  app->add_option("--backlash", f.backlash_um, "um, of zigzag scans");
  app->add_flag("--correct", f.correct, "Backlash is taken off");
  app->add_flag("--short", f.shorter, "A few scans only");
  app->add_flag("--rows", f.rows, "A row for every scan");
  app->add_flag("--json", json, "Print JSON");
  app->add_flag("--check", check, "End with 1 when a figure misses its 'must'");
  return app;
}

int run_command_line(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  CLI::App root{"Speed and size of Scansion beside other programs", "scansion_bench"};
  root.require_subcommand(1);
  Options o;
  o.bin = folder_of_this_program();
  bool json = false;
  bool check = false;
  std::string file;
  struct Verb {
    CLI::App* app;
    Command run;
  };
  std::vector<Verb> verbs;
  const auto verb = [&](const char* name, const char* what, Command run) {
    CLI::App* app = root.add_subcommand(name, what);
    app->add_option("FILE", o.files, "Recorded scans, FILE or FILE:UNIT");
    app->add_option("--pairs", o.pairs.pairs, "Measurements in alternation of each row")->check(CLI::Range(1, 100000));
    app->add_option("--least-ms", o.pairs.least_ms, "Repeat the work of a measurement until it lasts so long");
    app->add_option("--lines", o.lines, "At most so many lines of each set");
    app->add_option("--points", o.points, "About so many points of each file where time is measured (0: all)");
    app->add_option("--bin", o.bin, "Folder of scansion and scansim (default: this program's)");
    app->add_flag("--json", json, "Print JSON");
    app->add_flag("--check", check, "End with 1 when a figure misses its 'must'");
    verbs.push_back({app, run});
    return app;
  };
  verb("rank", "The full ranking beside plain Douglas-Peucker, Boost.Geometry and GEOS", run_rank);
  verb("codec", "Encoding, decoding, the whole pipeline and the feature stage beside the plain ranking", run_codec);
  verb("size", "Bits per point beside other packers", run_size);
  CLI::App* instructions = verb("instructions", "Instructions a point of the ranking, by valgrind", run_instructions);
  instructions->add_option("--child", o.child, "What to rank inside valgrind, SCENE:POINTS")->group("");
  verb("stages", "Stages of scansion compress, and export beside it", run_stages);
  const CLI::App* threads = verb("threads", "Wall time of scansion compress with two threads and with one", run_threads);
  FeatureOptions f;
  CLI::App* features = add_features(root, f, json, check);
  CLI::App* coproc = root.add_subcommand("rank-coproc", "Rank lines of FILE on request (standard input)");
  coproc->add_option("FILE", file, "Recorded scan, FILE or FILE:UNIT")->required();
  try {
    root.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return root.exit(error) == 0 ? 0 : 2;
  }
  if (coproc->parsed()) return end_with(run_rank_coproc(file));
  if (threads->parsed() && threads->count("--pairs") == 0) o.pairs.pairs = 5;
  const auto report_of = [&](auto run) {
    Report report(json);
    const auto result = run(report);
    report.finish();
    const int code = end_with(result);
    return code == 0 && check && report.failed() > 0 ? 1 : code;
  };
  if (features->parsed()) return report_of([&](Report& report) { return run_features(f, report); });
  for (const Verb& v : verbs) {
    if (v.app->parsed()) return report_of([&](Report& report) { return v.run(o, report); });
  }
  return 2;
}

} // namespace

Result<std::vector<LineSet>> file_sets(const Options& options) {
  std::vector<LineSet> sets;
  for (const std::string& file : options.files) {
    SCANSION_TRY(set, file_set(file));
    sets.push_back(std::move(set));
  }
  return sets;
}

} // namespace scansion::bench

int main(int argc, char** argv) {
  try {
    return scansion::bench::run_command_line(argc, argv);
  } catch (const std::exception& error) { // of the command line's set-up; nothing below throws
    std::fprintf(stderr, "scansion_bench: %s\n", error.what());
    return 70;
  }
}
