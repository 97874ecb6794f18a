// scansion stop and start: a device comes to rest, and goes on, by command.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/command.hpp"
#include "daemon/control/client.hpp"

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

namespace scansion::cli {
namespace {

struct Options {
  std::string socket, device;
  bool release = false;
};

constexpr std::chrono::seconds kPatience{5};
constexpr std::chrono::milliseconds kLook{50};

Result<nlohmann::json> ask(const Options& o, const nlohmann::json& question) {
  const std::string text = question.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  SCANSION_TRY(answer, o.socket.empty() ? request(text) : request(o.socket, text));
  auto json = nlohmann::json::parse(answer, nullptr, false);
  if (!json.is_object()) return fail(Errc::undecodable, "the daemon's answer is no JSON object");
  if (const auto error = json.find("error"); error != json.end() && error->is_string())
    return fail(Errc::unavailable, "the daemon answers: ", error->get_ref<const std::string&>());
  return json;
}

Result<std::string> state_of(const Options& o) {
  SCANSION_TRY(status, ask(o, {{"command", "status"}}));
  for (const auto& device : status.value("devices", nlohmann::json::array())) {
    if (device.value("name", "") == o.device) return device.value("state", std::string());
  }
  return fail(Errc::unavailable, "the daemon no longer has the device");
}

/// Until it stands, so that a script may rely on it.
Result<int> run_stop(const Options& o) {
  SCANSION_TRY(ask(o, {{"command", "stop"}, {"device", o.device}, {"release", o.release}}));
  const auto end = std::chrono::steady_clock::now() + kPatience;
  for (;;) {
    SCANSION_TRY(state, state_of(o));
    const bool stands = state == "stopped" || state == "closed" || state == "finished" || (state == "held" && !o.release);
    if (stands || std::chrono::steady_clock::now() >= end) {
      std::printf("%s: %s\n", o.device.c_str(), state.c_str());
      return stands ? kDone : kBadAnswer;
    }
    std::this_thread::sleep_for(kLook);
  }
}

Result<int> run_start(const Options& o) {
  SCANSION_TRY(ask(o, {{"command", "start"}, {"device", o.device}}));
  return kDone;
}

CLI::App* add_options(CLI::App& root, const char* verb, const char* meaning, Options& o) {
  auto* app = root.add_subcommand(verb, meaning);
  app->add_option("DEVICE", o.device, "Name of the device")->required();
  app->add_option("--socket", o.socket, "The daemon's control socket; default: where it listens by default")
      ->envname("SCANSION_SOCKET");
  return app;
}

} // namespace

Verb add_stop(CLI::App& root) {
  auto o = std::make_shared<Options>();
  auto* app = add_options(root, "stop", "Bring a device to rest at once; a machine is held where it is", *o);
  app->add_flag("--release", o->release, "Let go of its port too; a machine that was in use is reset and must be homed");
  return {app, [o] { return run_stop(*o); }};
}

Verb add_start(CLI::App& root) {
  auto o = std::make_shared<Options>();
  auto* app = add_options(root, "start", "Let a device go on that was stopped, or that waits for a person", *o);
  return {app, [o] { return run_start(*o); }};
}

} // namespace scansion::cli
