// scansim scene: writes a synthetic recorded scan.
// SPDX-License-Identifier: Apache-2.0
#include "sim/cli/scene_verb.hpp"

#include "sim/cli/output_file.hpp"
#include "sim/cli/progress.hpp"
#include "sim/scene/catalog.hpp"
#include "sim/scene/scan_command.hpp"
#include "sim/scene/scanner.hpp"
#include "sim/scene/xyz_text.hpp"
#include "sim/truth/scan_truth.hpp"
#include "sim/truth/truth_json.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

namespace scansion {
namespace {

// Made of any whole number N.
constexpr std::array<std::array<const char*, 2>, 2> kNumbered{
    {{"random:N", "forms of random kind, size and place, the same for the same whole number N"},
     {"smooth:N", "smooth surface of random bumps and waves, the same for the same whole number N"}}};
constexpr std::size_t kFlush = std::size_t{256} * 1024; // bytes of text a write

CLI::App* add_options(CLI::App& app, SceneRequest& request) {
  CLI::App* command = app.add_subcommand("scene", "write a synthetic recorded scan (xyz text, millimetres)");
  ScanPlan& plan = request.plan;
  command->add_option("NAME", request.scene, "the scene, see --list");
  command->add_option("-o,--output", request.output, "output file, - for standard output");
  command->add_option("--lines", plan.lines, "scan lines");
  command->add_option("--points", plan.points, "points a line (the mean where lines follow the part's silhouette)");
  command->add_option("--pitch", plan.pitch_mm, "mm from point to point");
  command->add_option("--spacing", plan.spacing_mm, "mm from line to line");
  command->add_option("--direction", plan.direction_deg, "degrees, direction of the lines in plan");
  command->add_option("--tilt", plan.tilt_deg, "degrees, lean of the scan plane, -45 to 45");
  command->add_option("--seed", plan.seed, "seed of everything random (default 1)")->check([](const std::string& text) {
    return std::string(text.starts_with('-') ? text + " is negative; take 0 or more" : "");
  });
  command->add_option("--noise", plan.noise_um, "um, sigma of the noise (default: the scene's)");
  command->add_option("--correlated", plan.correlated_mm, "mm along the line over which the noise hangs together");
  command->add_option("--jitter", plan.jitter, "share of the pitch by which points leave their place");
  command->add_option("--outliers", plan.outliers, "share of points with a spike of 0.3 to 5 mm");
  command->add_option("--dropouts", plan.dropouts, "share of points that are missing, singly and in bursts");
  command->add_option("--missing-lines", plan.missing_lines, "share of lines that are missing");
  command->add_flag("--zigzag", plan.zigzag, "odd lines are scanned backwards");
  command->add_option("--backlash", plan.backlash_um, "um by which the points of odd lines are told too far along the line");
  command->add_flag("--truth", request.truth, "also write the ground truth, FILE.truth.json for FILE.xyz");
  command->add_flag("--list", request.list, "list the scenes");
  command->add_flag("--json", request.json, "print a summary on standard output");
  command->add_flag("--force", request.force, "overwrite the output");
  return command;
}

Result<void> print(const std::string& text) {
  SCANSION_TRY(out, OutputFile::create("-", false));
  return out.write(text);
}

Result<void> list_scenes(bool json) {
  nlohmann::ordered_json array = nlohmann::ordered_json::array();
  std::string text;
  for (const CatalogEntry& entry : scene_catalog()) {
    const Scene scene = entry.make();
    array.push_back({{"scene", scene.name}, {"summary", scene.summary}});
    text += scene.name + std::string(scene.name.size() < 10 ? 10 - scene.name.size() : 1, ' ') + scene.summary + "\n";
  }
  for (const auto& [name, summary] : kNumbered) {
    array.push_back({{"scene", name}, {"summary", summary}});
    text.append(name).append("  ").append(summary).append("\n");
  }
  return print(json ? array.dump(2) + "\n" : text);
}

std::string summary(const SceneRequest& request, const SceneScanner& scanner, std::uint64_t bytes) {
  const ScanGeometry& geometry = scanner.geometry();
  const ScanCounts& counts = scanner.counts();
  const nlohmann::ordered_json json{{"scene", scanner.scene().name},
                                    {"command", scan_command(scanner.scene(), request.plan)},
                                    {"output", request.output},
                                    {"truth", request.truth ? truth_path(request.output) : ""},
                                    {"unit", "mm"},
                                    {"resolution", 0.001},
                                    {"lines", counts.lines},
                                    {"points", counts.points},
                                    {"seed", request.plan.seed},
                                    {"noise_um", geometry.noise},
                                    {"pitch_mm", geometry.pitch / 1000.0},
                                    {"spacing_mm", geometry.spacing / 1000.0},
                                    {"direction_deg", request.plan.direction_deg},
                                    {"tilt_deg", request.plan.tilt_deg},
                                    {"outliers", counts.outliers},
                                    {"dropouts", counts.dropouts},
                                    {"missing_lines", counts.missing_lines},
                                    {"bytes", bytes}};
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

/// The truth that is collected beside a scan, when it was asked for.
struct TruthFile {
  ScanTruth truth;
  OutputFile file;
};

Result<std::optional<TruthFile>> open_truth(const SceneRequest& request, const Scene& scene) {
  if (!request.truth) return std::optional<TruthFile>{};
  SCANSION_TRY(truth, ScanTruth::create(scene, request.plan));
  SCANSION_TRY(file, OutputFile::create(truth_path(request.output), request.force));
  return std::optional<TruthFile>(TruthFile{std::move(truth), std::move(file)});
}

Result<void> write_truth(TruthFile& truth) {
  SCANSION_TRY(truth.file.write(truth_json(truth.truth.finish())));
  return truth.file.finish();
}

} // namespace

std::string truth_path(const std::string& output) {
  constexpr std::string_view kEnding = ".xyz";
  const bool plain = output.ends_with(kEnding);
  return output.substr(0, output.size() - (plain ? kEnding.size() : 0)) + ".truth.json";
}

Verb add_scene_verb(CLI::App& app) {
  auto request = std::make_shared<SceneRequest>(); // CLI11 writes into it while parsing
  CLI::App* command = add_options(app, *request);
  return {command, [request] { return run_scene(*request); }};
}

Result<SceneRequest> parse_scene_command(std::string_view command) {
  SceneRequest request;
  CLI::App app;
  add_options(app, request);
  app.require_subcommand(1);
  try {
    app.parse(std::string(command), true);
  } catch (const CLI::ParseError& error) {
    return fail(Errc::usage, "'", command, "': ", error.what());
  }
  return request;
}

Result<void> run_scene(const SceneRequest& request) {
  if (request.list) return list_scenes(request.json);
  if (request.scene.empty()) return fail(Errc::usage, "scene: no NAME is given; `scansim scene --list` shows them");
  if (request.output.empty())
    return fail(Errc::usage, "scene: no output is given; add -o FILE.xyz, or -o - for standard output");
  if (request.json && request.output == "-") {
    return fail(Errc::usage, "scene: --json and -o - both want standard output; write the scan to a file");
  }
  if (request.truth && request.output == "-") {
    return fail(Errc::usage, "scene: --truth wants a name for its file; write the scan to a file");
  }
  SCANSION_TRY(scene, make_scene(request.scene));
  SCANSION_TRY(scanner, SceneScanner::create(std::move(scene), request.plan));
  SCANSION_TRY(output, OutputFile::create(request.output, request.force));
  SCANSION_TRY(truth, open_truth(request, scanner.scene()));

  std::string text = scan_header(scanner.scene(), request.plan, scanner.geometry());
  std::uint64_t bytes = 0;
  const auto flush = [&]() -> Result<void> {
    SCANSION_TRY(output.write(text));
    bytes += text.size();
    text.clear();
    return success();
  };
  Progress progress("scansim scene", scanner.geometry().lines);
  SceneLine line;
  bool first = true;
  while (scanner.next(line)) {
    append_xyz(text, line, first);
    if (truth) truth->truth.add(line);
    if (text.size() >= kFlush) {
      SCANSION_TRY(flush());
    }
    if (stop_requested()) return fail(Errc::io, request.output, ": stopped by a signal; nothing was kept");
    progress.at(line.index + std::uint64_t{1});
  }
  SCANSION_TRY(flush());
  if (truth) {
    SCANSION_TRY(write_truth(*truth));
  }
  SCANSION_TRY(output.finish());
  if (request.json) return print(summary(request, scanner, bytes));
  return success();
}

} // namespace scansion
