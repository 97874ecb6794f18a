// scansion: compress recorded scans; read, check, repair and export recordings; talk to the daemon.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/command.hpp"
#include "daemon/cli/record.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <system_error>
#include <vector>

namespace {

using namespace scansion;
using namespace scansion::cli;

int run(int argc, char** argv) {
  CLI::App root{"Multiresolution recordings of digitizing machines and laser line scanners", "scansion"};
  root.set_version_flag("--version", SCANSION_VERSION);
  root.require_subcommand(1);
  root.footer("Exit codes: 0 done, 1 bad answer, 2 usage, 65 input, 69 not available, 73/74 output and I/O, 77 permission, "
              "78 configuration.");
  const std::vector<Verb> verbs{add_compress(root), add_export(root), add_info(root),   add_verify(root),    add_recover(root),
                                add_compare(root),  add_view(root),   add_status(root), add_tail(root),      add_devices(root),
                                add_record(root),   add_stop(root),   add_start(root),  add_completion(root)};
  if (argc > 1 && argv[1][0] != '-' &&
      std::none_of(verbs.begin(), verbs.end(), [&](const Verb& verb) { return verb.app->get_name() == argv[1]; })) {
    say("unknown command '" + std::string(argv[1]) + "'; scansion --help lists those there are");
    return kUsage;
  }
  try {
    root.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return root.exit(error) == 0 ? kDone : kUsage;
  }
  for (const Verb& verb : verbs) {
    if (!verb.app->parsed()) continue;
    const Result<int> code = verb.run();
    if (!code) {
      say(code.error().context);
      return exit_code(code.error().code);
    }
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      say("cannot write standard output: " + std::generic_category().message(errno));
      return exit_code(Errc::io);
    }
    return code.value();
  }
  return kUsage;
}

} // namespace

int main(int argc, char** argv) {
  catch_stop_signals();
  try {
    return run(argc, argv);
  } catch (const std::exception& error) { // memory, or a fault of ours
    std::fprintf(stderr, "scansion: %s\n", error.what());
  }
  return exit_code(Errc::bug);
}
