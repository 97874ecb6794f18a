// scansim scene: writes a synthetic recorded scan.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/cli/verb.hpp"
#include "sim/scene/scan_plan.hpp"

#include <string>
#include <string_view>

namespace scansion {

struct SceneRequest {
  std::string scene;
  ScanPlan plan;
  std::string output;
  bool truth = false; ///< the ground truth, too, into truth_path(output)
  bool list = false;
  bool json = false;
  bool force = false;
};

/// FILE.truth.json for FILE.xyz.
[[nodiscard]] std::string truth_path(const std::string& output);

/// Adds the verb to `app`.
[[nodiscard]] Verb add_scene_verb(CLI::App& app);

/// Reads a whole command line, such as the one in a scan's header. Fails with usage.
[[nodiscard]] Result<SceneRequest> parse_scene_command(std::string_view command);

/// Does what was asked: results to standard output, progress to a terminal on standard error.
[[nodiscard]] Result<void> run_scene(const SceneRequest& request);

} // namespace scansion
