// scansion tail: what happens in the daemon, as it happens.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/command.hpp"
#include "daemon/control/client.hpp"

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

namespace scansion::cli {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string topic = "lines", socket;
  bool json = false;
};

std::string shown(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// device, then each key with its value; a feature line as its type, number, length and place.
std::string text_of(const Json& message) {
  const auto feature = message.find("feature");
  std::string text = shown(message.value("device", Json("-")));
  if (feature != message.end() && feature->is_object()) {
    for (const char* key : {"type", "id", "piece", "level", "length", "begins", "ends"}) {
      if (const auto value = feature->find(key); value != feature->end()) text += std::string("  ") + key + ' ' + shown(*value);
    }
    return text;
  }
  for (const auto& [key, value] : message.items()) {
    if (key != "device") text += "  " + key + ' ' + shown(value);
  }
  return text;
}

Result<int> run_tail(const Options& o) {
  const auto on_line = [&](std::string_view line) -> Result<void> {
    const Json message = Json::parse(line, nullptr, false);
    if (!message.is_object()) return fail(Errc::undecodable, "the daemon's answer is no JSON object");
    if (const auto error = message.find("error"); error != message.end())
      return fail(Errc::unavailable, "the daemon answers: ", shown(*error));
    if (message.contains("tail")) return success(); // the answer to the request
    if (const auto lost = message.find("lost"); lost != message.end())
      say(shown(*lost) + " messages are missing here: they came faster than they were read");
    const std::string text = o.json ? std::string(line) : text_of(message);
    if (o.json || !message.contains("lost")) std::printf("%s\n", text.c_str());
    if (std::fflush(stdout) != 0) return fail(Errc::io, "cannot write standard output");
    return success();
  };
  SCANSION_TRY(stream(o.socket.empty() ? std::nullopt : std::optional(o.socket),
                      Json{{"command", "tail"}, {"topic", o.topic}}.dump(), on_line));
  return kDone;
}

} // namespace

Verb add_tail(CLI::App& root) {
  auto* app = root.add_subcommand("tail", "Show what happens in the running daemon until interrupted");
  auto o = std::make_shared<Options>();
  app->add_option("topic", o->topic, "lines, features or events")
      ->check(CLI::IsMember({"lines", "features", "events"}))
      ->capture_default_str();
  app->add_option("--socket", o->socket, "The daemon's control socket; default: where it listens by default")
      ->envname("SCANSION_SOCKET");
  app->add_flag("--json", o->json, "Print one JSON object a line");
  return {app, [o] { return run_tail(*o); }};
}

} // namespace scansion::cli
