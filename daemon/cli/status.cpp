// scansion status: what the daemon is doing.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/command.hpp"
#include "daemon/control/client.hpp"

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>
#include <unistd.h>

namespace scansion::cli {
namespace {

struct Options {
  std::string socket;
  bool json = false, watch = false;
};

/// One line about the port, with the causes for which something was refused.
void print_link(const nlohmann::json& device) {
  const auto link = device.find("link");
  if (link == device.end() || !link->is_object()) return;
  std::string refused;
  const auto causes = link->find("rejected");
  if (causes != link->end() && causes->is_object()) {
    for (const auto& [cause, count] : causes->items()) {
      if (count.is_number() && count != 0) refused += "  " + cause + " " + count.dump();
    }
  }
  std::printf("  bytes in %s out %s, frames %s%s%s\n", link->value("bytes_in", nlohmann::json()).dump().c_str(),
              link->value("bytes_out", nlohmann::json()).dump().c_str(), link->value("frames", nlohmann::json()).dump().c_str(),
              refused.empty() ? "" : ", refused:", refused.c_str());
}

void print_text(const nlohmann::json& status) {
  const auto text = [](const nlohmann::json& object, const char* key) {
    const auto it = object.find(key);
    if (it == object.end() || it->is_null()) return std::string("-");
    return it->is_string() ? it->get<std::string>() : it->dump();
  };
  std::printf("scansiond %s, pid %s, up %s s\n", text(status, "version").c_str(), text(status, "pid").c_str(),
              text(status, "uptime_s").c_str());
  for (const auto& device : status.value("devices", nlohmann::json::array())) {
    std::printf("%-16s %-12s %-10s lines %s written %s points %s gaps %s\n", text(device, "name").c_str(),
                text(device, "driver").c_str(), text(device, "state").c_str(), text(device, "lines").c_str(),
                text(device, "lines_written").c_str(), text(device, "points").c_str(), text(device, "gaps").c_str());
    print_link(device);
    if (const auto error = text(device, "error"); error != "-" && !error.empty()) std::printf("  %s\n", error.c_str());
  }
}

Result<int> run_status(const Options& o) {
  while (true) {
    const std::string question = R"({"command":"status"})";
    SCANSION_TRY(answer, o.socket.empty() ? request(question) : request(o.socket, question));
    const auto status = nlohmann::json::parse(answer, nullptr, false);
    if (!status.is_object()) return fail(Errc::undecodable, "the daemon's answer is no JSON object");
    if (const auto error = status.find("error"); error != status.end() && error->is_string())
      return fail(Errc::unavailable, "the daemon answers: ", error->get_ref<const std::string&>());
    if (o.watch && ::isatty(STDOUT_FILENO) == 1) std::fputs("\033[H\033[J", stdout);
    if (o.json)
      std::printf("%s\n", status.dump(o.watch ? -1 : 2).c_str());
    else
      print_text(status);
    std::fflush(stdout);
    if (!o.watch || std::ferror(stdout) != 0) return kDone;
    std::this_thread::sleep_for(std::chrono::seconds(1));
  }
}

} // namespace

Verb add_status(CLI::App& root) {
  auto* app = root.add_subcommand("status", "Ask the running daemon what it does");
  auto o = std::make_shared<Options>();
  app->add_option("--socket", o->socket, "The daemon's control socket; default: where it listens by default")
      ->envname("SCANSION_SOCKET");
  app->add_flag("--json", o->json, "Print JSON");
  app->add_flag("--watch", o->watch, "Ask every second until stopped");
  return {app, [o] { return run_status(*o); }};
}

} // namespace scansion::cli
