// scansion_bench stages and threads: the programs themselves, from outside.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/commands.hpp"
#include "tests/bench/process.hpp"
#include "tests/bench/scratch.hpp"

#include <nlohmann/json.hpp>

namespace scansion::bench {
namespace {

using Json = nlohmann::json;

/// A recorded scan to run the programs on.
struct Input {
  std::string name, path, unit = "mm";
};

Result<std::vector<Input>> inputs_of(const Options& o, const std::vector<const char*>& scenes, const ScratchFolder& folder) {
  std::vector<Input> inputs;
  for (const std::string& file : o.files) {
    Input input{file, file, "mm"};
    const std::size_t colon = file.rfind(':');
    if (colon != std::string::npos && parse_unit(std::string_view(file).substr(colon + 1)))
      input = {file.substr(0, colon), file.substr(0, colon), file.substr(colon + 1)};
    input.name = input.name.substr(input.name.rfind('/') + 1);
    inputs.push_back(std::move(input));
  }
  if (!inputs.empty()) return inputs;
  for (const char* scene : scenes) {
    const std::string path = folder.file(std::string(scene) + ".xyz");
    std::vector<std::string> command{o.bin + "/scansim", "scene", scene, "-o", path};
    if (o.lines != 0) command.insert(command.end(), {"--lines", std::to_string(o.lines)});
    if (run_program(command, true).status != 0) return fail(Errc::not_found, command[0], ": did not make scene ", scene);
    inputs.push_back({scene, path, "mm"});
  }
  return inputs;
}

std::vector<std::string> compress(const Options& o, const Input& input, const std::string& out, const char* threads) {
  return {o.bin + "/scansion", "compress",  input.path, "-o",     out,          "--unit", input.unit,
          "--force",           "--threads", threads,    "--json", "--features", "off"};
}

std::vector<std::string> without_features(std::vector<std::string> command) {
  command.resize(command.size() - 2);
  return command;
}

/// Runs `command`, which may not know --features yet.
Ended run_compress(const std::vector<std::string>& command) {
  const Ended ended = run_program(command, true);
  return ended.status == 2 ? run_program(without_features(command)) : ended;
}

double figure_of(const Json& figures, const char* name) {
  const auto at = figures.find(name);
  return at != figures.end() && at->is_number() ? at->get<double>() : 0.0;
}

} // namespace

Result<void> run_stages(const Options& options, Report& report) {
  const ScratchFolder folder;
  SCANSION_TRY(inputs, inputs_of(options, {"part", "plane", "freeform", "paper"}, folder));
  Table table("Stages of compress and times of export, processor time in ns per point, one thread",
              {"set", "points", "bit/pt", "read", "rank", "encode", "write", "compress", "export --level 0",
               "level 0 / compress", "export --tolerance 0.05", "tolerance / compress"},
              "One run each: compare columns, not machines. export: xyz text; ns per point of the recording.");
  for (const Input& input : inputs) {
    const std::string recording = folder.file("stages.mcap");
    const Ended made = run_compress(compress(options, input, recording, "1"));
    const Json figures = Json::parse(made.out, nullptr, false);
    if (made.status != 0 || !figures.is_object()) return fail(Errc::undecodable, input.path, ": compress did not work");
    const double points = figure_of(figures, "points");
    const Json times = figures.value("cpu_ns_per_point", Json::object());
    const auto per_point = [&](double seconds) { return Figure{1e9 * seconds / points, 1}; };
    std::vector<Cell> cells{input.name, Count{static_cast<std::uint64_t>(points)},
                            Figure{figure_of(figures, "bits_per_point")}};
    for (const char* stage : {"read", "rank", "encode", "write"}) cells.emplace_back(Figure{figure_of(times, stage), 1});
    cells.emplace_back(per_point(made.cpu_s));
    for (const auto& [option, value] : {std::pair{"--level", "0"}, std::pair{"--tolerance", "0.05"}}) {
      const Ended ended = run_program(
          {options.bin + "/scansion", "export", recording, "-o", folder.file("out.xyz"), "--force", option, value}, true);
      if (ended.status != 0) return fail(Errc::damaged, recording, ": export did not work");
      cells.emplace_back(per_point(ended.cpu_s));
      cells.emplace_back(Figure{ended.cpu_s / made.cpu_s, 3});
    }
    table.add(std::move(cells));
  }
  report.print(table);
  return success();
}

Result<void> run_threads(const Options& options, Report& report) {
  const ScratchFolder folder;
  SCANSION_TRY(inputs, inputs_of(options, {"paper"}, folder));
  Table table("Wall time of compress with 2 threads / with 1", {"set", "2 threads s", "1 thread s", "ratio", "q1", "q3"},
              "Median of " + std::to_string(options.pairs.pairs) + " pairs in alternation.");
  for (const Input& input : inputs) {
    bool works = true;
    const auto time_of = [&](const char* threads) {
      const Ended ended = run_compress(compress(options, input, folder.file("threads.mcap"), threads));
      works = works && ended.status == 0;
      return ended.wall_s;
    };
    const PairResult r = alternate([&] { return time_of("2"); }, [&] { return time_of("1"); }, options.pairs.pairs);
    if (!works) return fail(Errc::undecodable, input.path, ": compress did not work");
    table.add({input.name, Figure{r.ours_ns}, Figure{r.peer_ns}, Figure{r.ratio.median, 3}, Figure{r.ratio.low, 3},
               Figure{r.ratio.high, 3}});
  }
  report.print(table);
  return success();
}

} // namespace scansion::bench
