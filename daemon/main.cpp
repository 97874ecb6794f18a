// scansiond: devices -> pipeline -> recordings.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/config.hpp"
#include "daemon/log.hpp"
#include "daemon/service.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>

namespace {

struct Arguments {
  std::string config{scansion::kDefaultConfigFile};
  std::string log_level = "info";
  bool check = false;
  bool print = false;
};

int report(const scansion::Error& error) {
  std::fprintf(stderr, "scansiond: %s\n", error.context.c_str());
  return scansion::exit_code(error.code);
}

int run(const Arguments& arguments) {
  auto config = scansion::load_config(arguments.config);
  if (!config) return report(config.assume_error());
  if (arguments.print) {
    const std::string text = scansion::print_config(config.assume_value());
    const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
    return written ? 0 : report({scansion::Errc::io, "cannot write to standard output"});
  }
  if (arguments.check) return 0;
  if (auto log = scansion::start_log(arguments.log_level); !log) return report(log.assume_error());
  return scansion::serve(std::move(config).assume_value());
}

} // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Records scan lines of digitizing machines and laser line scanners.", "scansiond");
  app.add_option("--config", arguments.config, "configuration file")->capture_default_str();
  app.add_flag("--check-config", arguments.check, "check the configuration and exit: 0 good, 78 wrong");
  app.add_flag("--print-config", arguments.print, "print the configuration in force as TOML and exit");
  app.add_option("--log-level", arguments.log_level, "trace, debug, info, warning, error or critical")->capture_default_str();
  app.set_version_flag("--version", std::string("scansiond ") + scansion::kVersion);
  try { // CLI11 reports by exception; nothing below throws
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : scansion::exit_code(scansion::Errc::usage);
  }
  return run(arguments);
}
