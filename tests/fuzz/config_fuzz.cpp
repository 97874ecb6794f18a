// Any bytes as configuration: an error with its place, or a configuration that prints and reads back the same.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/config/config.hpp"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto config = scansion::parse_config(text, "fuzz.toml");
  if (!config) {
    const auto& error = config.assume_error();
    if (error.code != scansion::Errc::config || !error.context.starts_with("fuzz.toml:")) std::abort();
    return 0;
  }
  const auto again = scansion::parse_config(scansion::print_config(config.assume_value()), "printed.toml");
  if (!again) std::abort();
  const auto& a = config.assume_value();
  const auto& b = again.assume_value();
  if (!(a.recording_values == b.recording_values && a.control_values == b.control_values &&
        a.pipeline_values == b.pipeline_values && a.devices == b.devices)) {
    std::abort();
  }
  return 0;
}
