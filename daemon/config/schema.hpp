// The keys of the configuration's own tables; those of a device come from its driver.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/option.hpp"

namespace scansion {

/// One table of the configuration.
struct Section {
  std::string_view name;
  std::string_view meaning;
  std::span<const Option> options;
};

[[nodiscard]] const Section& recording_section() noexcept;
[[nodiscard]] const Section& control_section() noexcept;
[[nodiscard]] const Section& pipeline_section() noexcept;
/// The keys every device has.
[[nodiscard]] const Section& device_section() noexcept;

} // namespace scansion
