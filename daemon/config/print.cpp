// The configuration in force as TOML with comments from the schema.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/config.hpp"
#include "daemon/config/schema.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>

namespace scansion {
namespace {

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20 || byte == 0x7F) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04X", static_cast<unsigned>(byte));
      out += escape;
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string number_text(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  std::string text(buffer, end);
  // TOML tells a real number from an integer by its point or exponent.
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

/// Bounds read better without exponent and without ".0".
std::string bound_text(double value) {
  char buffer[64];
  if (value == std::floor(value) && std::abs(value) < 1e15) {
    std::snprintf(buffer, sizeof buffer, "%.0f", value);
    return buffer;
  }
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

std::string toml_text(const OptionValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return std::to_string(*integer);
  if (const auto* real = std::get_if<double>(&value)) return number_text(*real);
  return quoted(*std::get_if<std::string>(&value));
}

std::string default_text(const OptionDefault& standard) {
  if (const auto* flag = std::get_if<bool>(&standard)) return *flag ? "true" : "false";
  if (const auto* integer = std::get_if<std::int64_t>(&standard)) return std::to_string(*integer);
  if (const auto* real = std::get_if<double>(&standard)) return number_text(*real);
  if (const auto* text = std::get_if<std::string_view>(&standard)) return quoted(*text);
  return {};
}

void print_key(const Option& option, const OptionValue* value, std::string_view lead, std::string& out) {
  std::string facts;
  if (std::isfinite(option.min) && std::isfinite(option.max)) {
    facts = bound_text(option.min) + " to " + bound_text(option.max);
  }
  const std::string standard = default_text(option.standard);
  if (!standard.empty()) facts += (facts.empty() ? "default " : "; default ") + standard;
  if (option.required) facts += facts.empty() ? "required" : "; required";
  out.append(lead).append("# ").append(option.meaning);
  if (!facts.empty()) out.append(" (").append(facts).append(")");
  out += '\n';
  const std::string shown = value != nullptr ? toml_text(*value) : (standard.empty() ? std::string(option.example) : standard);
  // A key without value and default is shown as a comment, so that printing never sets anything.
  out.append(lead).append(value == nullptr && lead.empty() ? "# " : "").append(option.key).append(" = ").append(shown);
  out += '\n';
}

void print_section(const Section& section, const OptionValues& values, std::string& out) {
  out.append("# ").append(section.meaning).append("\n[").append(section.name).append("]\n");
  for (const Option& option : section.options) print_key(option, values.find(option.key), "", out);
  out += '\n';
}

void print_device(const DeviceConfig& device, std::string& out) {
  out.append("[[device]]\n");
  const auto& common = device_section().options;
  for (const Option& option : common) print_key(option, device.common.find(option.key), "", out);
  for (const Option& option : device.driver->options) print_key(option, device.options.find(option.key), "", out);
  out += '\n';
}

/// What a device of this driver would look like, as a comment.
void print_example(const DriverInfo& info, std::size_t number, std::string& out) {
  out.append("# ").append(info.name).append(": ").append(info.meaning).append(".\n#[[device]]\n");
  const auto& common = device_section().options;
  const OptionValue driver = std::string(info.name);
  const OptionValue name = "table-" + std::to_string(number);
  for (const Option& option : common)
    print_key(option, option.key == "name" ? &name : option.key == "driver" ? &driver : nullptr, "#", out);
  for (const Option& option : info.options) print_key(option, nullptr, option.alternative ? "##" : "#", out);
  out += '\n';
}

} // namespace

std::string print_config(const Config& config) {
  std::string out = "# Configuration of scansiond; see scansiond.toml(5). An unknown key is an error.\n\n";
  print_section(recording_section(), config.recording_values, out);
  print_section(control_section(), config.control_values, out);
  print_section(pipeline_section(), config.pipeline_values, out);
  out.append("# ").append(device_section().meaning).append("\n");
  for (const DeviceConfig& device : config.devices) print_device(device, out);
  if (config.devices.empty()) {
    out += "# There is none yet; a device of each driver looks like this:\n\n";
    std::size_t number = 0;
    for (const DriverInfo* info : drivers()) print_example(*info, ++number, out);
  }
  out.pop_back();
  return out;
}

} // namespace scansion
