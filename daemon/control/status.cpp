// What the daemon says about itself, as JSON.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/control/status.hpp"

#include <ctime>
#include <nlohmann/json.hpp>

namespace scansion {
namespace {

using Json = nlohmann::ordered_json;

Json text_or_null(const std::string& text) {
  return text.empty() ? Json(nullptr) : Json(text);
}

/// Bytes that are no UTF-8 (a strange file name) are replaced, never thrown about.
std::string one_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json link_json(const std::optional<LinkStatus>& link) {
  if (!link) return nullptr;
  Json rejected = Json::object();
  std::uint64_t frames = link->accepted;
  for (const auto& [cause, count] : link->rejected) {
    rejected[cause] = count;
    frames += count;
  }
  return {{"bytes_in", link->bytes_in}, {"bytes_out", link->bytes_out}, {"frames", frames},
          {"accepted", link->accepted}, {"rejected", rejected},         {"raw_dropped", link->raw_dropped}};
}

Json device_json(const DeviceStatus& device) {
  Json out;
  out["name"] = device.name;
  out["driver"] = device.driver;
  out["state"] = device.state;
  out["error"] = text_or_null(device.error);
  out["lines"] = device.lines;
  out["points"] = device.points;
  out["invalid"] = device.invalid;
  out["gaps"] = device.gaps;
  out["lost_lines"] = device.lost_lines;
  out["groups_written"] = device.groups_written;
  out["lines_written"] = device.lines_written;
  out["queue"] = {{"depth", device.queue_depth}, {"bound", device.queue_bound}};
  out["pending_groups"] = device.pending_groups;
  out["lag_ms"] = device.lag_ms;
  if (device.recording.empty())
    out["recording"] = nullptr;
  else
    out["recording"] = {{"path", device.recording}, {"bytes", device.recording_bytes}};
  out["last_recording"] = text_or_null(device.last_recording);
  out["blocked"] = text_or_null(device.blocked);
  out["last_line_at"] = device.last_line_ns ? Json(iso_time(*device.last_line_ns)) : Json(nullptr);
  out["link"] = link_json(device.link);
  return out;
}

std::string error_json(std::string_view reason) {
  return one_line(Json{{"error", reason}});
}

} // namespace

std::string iso_time(std::int64_t realtime_ns) {
  std::int64_t milliseconds = realtime_ns / 1'000'000;
  if (realtime_ns % 1'000'000 < 0) --milliseconds;
  std::int64_t rest = milliseconds % 1000;
  if (rest < 0) rest += 1000;
  const std::time_t seconds = (milliseconds - rest) / 1000;
  std::tm parts{};
  ::gmtime_r(&seconds, &parts);
  char date[40];
  const std::size_t length = std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S", &parts);
  std::string fraction = std::to_string(1000 + rest);
  fraction[0] = '.';
  return std::string(date, length) + fraction + 'Z';
}

std::string to_json(const DaemonStatus& status) {
  std::string blocked;
  for (const DeviceStatus& device : status.devices) {
    if (blocked.empty()) blocked = device.blocked;
  }
  Json out;
  out["version"] = status.version;
  out["pid"] = status.pid;
  out["started"] = iso_time(status.started_ns);
  const std::int64_t uptime_ms = status.uptime_ns / 1'000'000;
  out["uptime_s"] = static_cast<double>(uptime_ms) / 1000.0;
  out["config"] = status.config;
  out["recording"] = {{"directory", status.directory},
                      {"free_mb", status.free_mb ? Json(*status.free_mb) : Json(nullptr)},
                      {"blocked", text_or_null(blocked)}};
  out["devices"] = Json::array();
  for (const DeviceStatus& device : status.devices) out["devices"].push_back(device_json(device));
  return one_line(out);
}

std::string answer(std::string_view request, const Answers& answers) {
  const Json json = Json::parse(request, nullptr, false);
  if (!json.is_object()) return error_json("a request is one JSON object a line, such as {\"command\":\"status\"}");
  const auto command = json.find("command");
  if (command == json.end() || !command->is_string())
    return error_json(
        "the request has no \"command\"; there are: status, start, stop, tail (with a \"topic\": lines, features or events)");
  if (*command == "status") return to_json(answers.status());
  const bool stops = *command == "stop";
  if (!stops && *command != "start")
    return error_json("unknown command; there are: status, start, stop, tail (with a \"topic\": lines, features or events)");
  const auto device = json.find("device");
  if (device == json.end() || !device->is_string()) return error_json("the request has no \"device\"");
  const auto release = json.find("release");
  const bool releases = release != json.end() && release->is_boolean() && release->get<bool>();
  const auto done = answers.order(device->get_ref<const std::string&>(), !stops     ? Order::start
                                                                         : releases ? Order::release
                                                                                    : Order::stop);
  return done ? one_line(Json{{"done", true}}) : error_json(done.error().context);
}

} // namespace scansion
