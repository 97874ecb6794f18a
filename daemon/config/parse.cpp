// TOML text to a checked configuration.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/config.hpp"
#include "daemon/config/nearest.hpp"
#include "daemon/config/schema.hpp"
#include "daemon/config/toml.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace scansion {
namespace {

constexpr std::size_t kMaxProblems = 20;
constexpr std::size_t kMaxDevices = 64;

/// The problems found so far, each with its place.
class Problems {
public:
  explicit Problems(std::string file) : file_(std::move(file)) {}

  template <class... Parts>
  void add(const toml::source_region& place, Parts&&... parts) {
    if (++count_ > kMaxProblems) return;
    if (!text_.empty()) text_ += '\n';
    text_ += file_ + ':' + std::to_string(place.begin.line) + ':' + std::to_string(place.begin.column) + ": ";
    (text_.append(std::forward<Parts>(parts)), ...);
  }
  [[nodiscard]] bool any() const noexcept { return count_ > 0; }
  [[nodiscard]] Error take() {
    if (count_ > kMaxProblems) text_ += "\n" + file_ + ": " + std::to_string(count_ - kMaxProblems) + " more problems";
    return Error{Errc::config, std::move(text_)};
  }

private:
  std::string file_;
  std::string text_;
  std::size_t count_ = 0;
};

/// For messages: one line of printable characters, shortened.
std::string shown(std::string_view text) {
  std::string out = "\"";
  for (const char c : text.substr(0, 60)) out += (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) ? '?' : c;
  if (text.size() > 60) out += "...";
  return out + '"';
}

std::string shortest(double value) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  return {buffer, end};
}

std::string_view type_name(OptionType type) {
  switch (type) {
    case OptionType::text: return "a text in quotes";
    case OptionType::integer: return "an integer";
    case OptionType::number: return "a number";
    case OptionType::flag: return "true or false";
    case OptionType::text_or_number: return "a text in quotes or a number";
  }
  return "";
}

/// A value of the right type, or nothing.
std::optional<OptionValue> typed_value(const toml::node& node, OptionType type) {
  const auto* text = node.as_string();
  const auto* integer = node.as_integer();
  const auto* real = node.as_floating_point();
  const auto* flag = node.as_boolean();
  switch (type) {
    case OptionType::text: return text ? std::optional<OptionValue>(text->get()) : std::nullopt;
    case OptionType::integer: return integer ? std::optional<OptionValue>(integer->get()) : std::nullopt;
    case OptionType::flag: return flag ? std::optional<OptionValue>(flag->get()) : std::nullopt;
    case OptionType::number:
      if (real) return OptionValue(real->get());
      return integer ? std::optional<OptionValue>(static_cast<double>(integer->get())) : std::nullopt;
    case OptionType::text_or_number:
      if (text) return OptionValue(text->get());
      if (real) return OptionValue(shortest(real->get()));
      return integer ? std::optional<OptionValue>(std::to_string(integer->get())) : std::nullopt;
  }
  return std::nullopt;
}

/// Range and the option's own check.
void check_value(const Option& option, const OptionValue& value, const toml::source_region& place, Problems& problems) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    if (text->find('\0') != std::string::npos) {
      problems.add(place, std::string(option.key), " = ", shown(*text), " holds a zero byte");
    } else if (option.check != nullptr) {
      if (auto checked = option.check(*text); !checked) {
        problems.add(place, std::string(option.key), " = ", shown(*text), " ", checked.assume_error().context);
      }
    }
    return;
  }
  double number = 0.0;
  if (const auto* integer = std::get_if<std::int64_t>(&value))
    number = static_cast<double>(*integer);
  else if (const auto* real = std::get_if<double>(&value))
    number = *real;
  else
    return;
  if (!(number >= option.min && number <= option.max)) { // also for NaN
    problems.add(place, std::string(option.key), " = ", shortest(number), " is out of range; it must be from ",
                 shortest(option.min), " to ", shortest(option.max));
  }
}

void read_key(const Option& option, const toml::node& node, Problems& problems, OptionValues& out) {
  auto value = typed_value(node, option.type);
  if (!value) {
    problems.add(node.source(), std::string(option.key), " must be ", std::string(type_name(option.type)));
    return;
  }
  check_value(option, *value, node.source(), problems);
  out.set(option.key, std::move(*value));
}

OptionValue to_value(const OptionDefault& standard) {
  if (const auto* flag = std::get_if<bool>(&standard)) return *flag;
  if (const auto* integer = std::get_if<std::int64_t>(&standard)) return *integer;
  if (const auto* real = std::get_if<double>(&standard)) return *real;
  if (const auto* text = std::get_if<std::string_view>(&standard)) return std::string(*text);
  return false;
}

void report_unknown(const toml::key& key, std::span<const std::string_view> known, Problems& problems) {
  const std::string_view nearest = nearest_name(key.str(), known);
  problems.add(key.source(), "unknown key ", shown(key.str()),
               nearest.empty() ? std::string() : "; nearest is \"" + std::string(nearest) + '"');
}

/// Keys of `table` that none of the schemas has.
void check_keys(const toml::table& table, std::initializer_list<std::span<const Option>> schemas, Problems& problems) {
  std::vector<std::string_view> known;
  for (const auto& schema : schemas) {
    for (const Option& option : schema) known.push_back(option.key);
  }
  for (const auto& [key, node] : table) {
    if (std::find(known.begin(), known.end(), key.str()) == known.end()) report_unknown(key, known, problems);
  }
}

/// Reads the keys of one schema; keys it does not have are for check_keys.
void read_table(const toml::table& table, std::span<const Option> schema, Problems& problems, OptionValues& out) {
  for (const Option& option : schema) {
    if (const toml::node* node = table.get(option.key)) {
      read_key(option, *node, problems, out);
    } else if (option.required) {
      problems.add(table.source(), "key \"", std::string(option.key), "\" is missing: ", std::string(option.meaning));
    } else if (!std::holds_alternative<std::monostate>(option.standard)) {
      out.set(option.key, to_value(option.standard));
    }
  }
}

void read_section(const toml::table& root, const Section& section, Problems& problems, OptionValues& out) {
  static const toml::table empty;
  const toml::node* node = root.get(section.name);
  if (node != nullptr && !node->is_table()) {
    problems.add(node->source(), "\"", std::string(section.name), "\" must be a table: [", std::string(section.name), "]");
    node = nullptr;
  }
  const toml::table& table = node != nullptr ? *node->as_table() : empty;
  check_keys(table, {section.options}, problems);
  read_table(table, section.options, problems, out);
}

std::optional<FeatureSettings> feature_settings(const OptionValues& common) {
  if (!common.flag("features")) return std::nullopt;
  FeatureSettings settings;
  settings.linking = common.text("linking") == "paper" ? Linking::paper : Linking::soft;
  settings.backlash = common.text("backlash") == "correct" ? BacklashUse::correct : BacklashUse::report;
  settings.noise_mm = common.get<double>("noise");
  settings.noise_correlation = common.get<double>("noise_correlation").value_or(settings.noise_correlation);
  FeatureLimits& limits = settings.limits;
  limits.least_turning = common.get<double>("least_turning").value_or(limits.least_turning);
  limits.least_step = common.get<double>("least_step").value_or(limits.least_step);
  limits.largest_arc = common.get<double>("largest_arc").value_or(limits.largest_arc);
  limits.shortest_line = common.get<double>("shortest_line").value_or(limits.shortest_line);
  return settings;
}

/// name and driver are looked up first: the other keys are those of the driver.
void read_device(const toml::table& table, Problems& problems, std::vector<DeviceConfig>& out) {
  const auto& common = device_section().options;
  OptionValues head;
  const toml::node* driver_node = table.get("driver");
  const auto* driver_name = driver_node != nullptr ? driver_node->as_string() : nullptr;
  const DriverInfo* driver = driver_name != nullptr ? find_driver(driver_name->get()) : nullptr;
  if (driver == nullptr) {
    // Without its driver nothing can be said about a device's other keys.
    read_table(table, common, problems, head);
    return;
  }
  DeviceConfig device;
  device.driver = driver;
  check_keys(table, {common, driver->options}, problems);
  read_table(table, common, problems, head);
  read_table(table, driver->options, problems, device.options);
  device.name = head.text("name");
  const auto same = [&](const DeviceConfig& other) { return other.name == device.name; };
  if (const toml::node* name = table.get("name"); name != nullptr && std::any_of(out.begin(), out.end(), same)) {
    problems.add(name->source(), "a second device is called ", shown(device.name), "; names must be unique");
  }
  if (!problems.any()) {
    device.features = feature_settings(head);
    device.common = head;
    if (auto made = driver->make(device.options); !made) problems.add(table.source(), made.assume_error().context);
  }
  out.push_back(std::move(device));
}

void read_devices(const toml::table& root, Problems& problems, std::vector<DeviceConfig>& out) {
  const toml::node* node = root.get(device_section().name);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  if (array == nullptr || !array->is_homogeneous(toml::node_type::table)) {
    if (array == nullptr || !array->empty()) problems.add(node->source(), "\"device\" must be an array of tables: [[device]]");
    return;
  }
  if (array->size() > kMaxDevices) {
    problems.add(node->source(), "more than ", std::to_string(kMaxDevices), " devices");
    return;
  }
  for (const toml::node& entry : *array) read_device(*entry.as_table(), problems, out);
}

void check_root(const toml::table& root, Problems& problems) {
  const std::string_view known[] = {recording_section().name, control_section().name, pipeline_section().name,
                                    device_section().name};
  for (const auto& [key, node] : root) {
    if (std::find(std::begin(known), std::end(known), key.str()) == std::end(known)) report_unknown(key, known, problems);
  }
}

} // namespace

Result<Config> parse_config(std::string_view text, const std::string& file_name) {
  const toml::parse_result parsed = toml::parse(text, std::string_view(file_name));
  Problems problems(file_name);
  if (!parsed) {
    problems.add(parsed.error().source(), parsed.error().description());
    return problems.take();
  }
  const toml::table& root = parsed.table();
  Config config;
  config.file = file_name;
  check_root(root, problems);
  read_section(root, recording_section(), problems, config.recording_values);
  read_section(root, control_section(), problems, config.control_values);
  read_section(root, pipeline_section(), problems, config.pipeline_values);
  read_devices(root, problems, config.devices);
  if (problems.any()) return problems.take();

  const OptionValues& recording = config.recording_values;
  config.recording = {recording.text("directory"),    recording.integer("sync_interval_ms"),
                      recording.integer("group_ms"),  recording.integer("min_free_mb"),
                      recording.integer("rotate_mb"), recording.integer("rotate_minutes")};
  config.socket = config.control_values.text("socket");
  SCANSION_TRY(levels, parse_level_spec(config.pipeline_values.text("levels")));
  SCANSION_TRY(floor, parse_floor(config.pipeline_values.text("floor")));
  config.levels = std::move(levels);
  config.levels.floor = floor;
  return config;
}

} // namespace scansion
