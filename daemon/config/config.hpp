// The daemon's configuration as a value, and how it is read, checked and printed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/registry.hpp"
#include "pipeline/feature/settings.hpp"
#include "pipeline/model/alpha_set.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scansion {

struct RecordingConfig {
  std::string directory;
  std::int64_t sync_interval_ms = 0;
  std::int64_t group_ms = 0;
  std::int64_t min_free_mb = 0;
  std::int64_t rotate_mb = 0;
  std::int64_t rotate_minutes = 0;

  friend bool operator==(const RecordingConfig&, const RecordingConfig&) = default;
};

struct DeviceConfig {
  std::string name;
  const DriverInfo* driver = nullptr;      ///< never null in a loaded configuration
  OptionValues options;                    ///< the driver's own keys
  OptionValues common;                     ///< the keys of every device, as checked
  std::optional<FeatureSettings> features; ///< empty: none are looked for

  friend bool operator==(const DeviceConfig&, const DeviceConfig&) = default;
};

struct Config {
  std::string file; ///< where it came from
  RecordingConfig recording;
  std::string socket; ///< empty: default_socket_path()
  LevelSpec levels;
  std::vector<DeviceConfig> devices;

  /// The tables as checked, for print_config.
  OptionValues recording_values, control_values, pipeline_values;
};

inline constexpr std::string_view kDefaultConfigFile = "/etc/scansion/scansiond.toml";

/// Checks all of `text`. The error has one line per problem, each `file:line:column: reason; fix` (at most 20).
[[nodiscard]] Result<Config> parse_config(std::string_view text, const std::string& file_name);
/// Reads at most 1 MiB. Fails with config when the file cannot be read, too: the daemon has no other way to go on.
[[nodiscard]] Result<Config> load_config(const std::string& path);
/// The configuration in force as TOML, each key with its meaning, range and default.
[[nodiscard]] std::string print_config(const Config& config);

} // namespace scansion
