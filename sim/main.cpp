// scansim: stands in for parts and devices. One verb a file in cli/; this only picks the verb.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/model/result.hpp"
#include "sim/cli/device_verb.hpp"
#include "sim/cli/progress.hpp"
#include "sim/cli/scene_verb.hpp"
#include "sim/device/gocator/gocator_entry.hpp"
#include "sim/device/grbl/grbl_entry.hpp"
#include "sim/device/scip/scip_entry.hpp"
#include "sim/device/stream/stream_entry.hpp"

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>

int main(int argc, char** argv) {
  using namespace scansion;
  constexpr int kUsage = 2;
  CLI::App app("Synthetic scans and simulated devices, for tests and newcomers", "scansim");
  app.set_version_flag("--version", "scansim " SCANSION_VERSION);
  app.require_subcommand(1);
  const std::array verbs{add_scene_verb(app), add_device_verb(app, scip_entry()), add_device_verb(app, gocator_entry()),
                         add_device_verb(app, grbl_entry()), add_device_verb(app, stream_entry())};
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kUsage;
  }
  catch_stop_signals();
  for (const Verb& verb : verbs) {
    if (!verb.command->parsed()) continue;
    const auto done = verb.run();
    if (done) return 0;
    std::fprintf(stderr, "scansim: %s\n", done.error().context.c_str());
    return exit_code(done.error().code);
  }
  return kUsage;
}
