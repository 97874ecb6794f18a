// scansion devices: what is plugged in, with selectors for the configuration, and what stands in the way of using it.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/command.hpp"
#include "drivers/transport/serial_list.hpp"

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

namespace scansion::cli {
namespace {

nlohmann::ordered_json text_or_null(const std::string& text) {
  return text.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(text);
}

std::string usb_id(const SerialPortInfo& port) {
  if (!port.vendor_id || !port.product_id) return {};
  char text[16];
  std::snprintf(text, sizeof text, "%04x:%04x", *port.vendor_id & 0xFFFFU, *port.product_id & 0xFFFFU);
  return text;
}

nlohmann::ordered_json port_json(const SerialPortInfo& port) {
  return {
      {"kind", "serial"},
      {"selector", "port = " + nlohmann::json(port.selector).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)},
      {"path", port.path},
      {"description", text_or_null(port.description)},
      {"manufacturer", text_or_null(port.manufacturer)},
      {"product", text_or_null(port.product)},
      {"serial", text_or_null(port.serial)},
      {"usb", text_or_null(usb_id(port))},
      {"driver", text_or_null(port.driver)},
      {"problem", text_or_null(port.problem)},
      {"fix", text_or_null(port.fix)}};
}

void print_port(const SerialPortInfo& port) {
  std::printf("%s", port.path.c_str());
  for (const std::string* part : {&port.description, &port.manufacturer, &port.serial}) {
    if (!part->empty()) std::printf("  %s", part->c_str());
  }
  if (const std::string id = usb_id(port); !id.empty()) std::printf("  usb %s", id.c_str());
  std::printf("\n  port = \"%s\"\n", port.selector.c_str());
  if (!port.driver.empty()) std::printf("  driver = \"%s\"\n", port.driver.c_str());
  if (!port.problem.empty())
    std::printf("  %s%s%s\n", port.problem.c_str(), port.fix.empty() ? "" : "; fix: ", port.fix.c_str());
}

Result<int> run_devices(bool json) {
  SCANSION_TRY(ports, list_serial_ports());
  if (json) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const SerialPortInfo& port : ports) out.push_back(port_json(port));
    std::printf(
        "%s\n",
        nlohmann::ordered_json{{"devices", out}}.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace).c_str());
    return kDone;
  }
  for (const SerialPortInfo& port : ports) print_port(port);
  if (ports.empty()) say("no serial port is plugged in; devices on TCP are named by their address");
  return kDone;
}

} // namespace

Verb add_devices(CLI::App& root) {
  auto* app = root.add_subcommand("devices", "List what is plugged in, with selectors for the configuration");
  auto json = std::make_shared<bool>(false);
  app->add_flag("--json", *json, "Print JSON");
  return {app, [json] { return run_devices(*json); }};
}

} // namespace scansion::cli
