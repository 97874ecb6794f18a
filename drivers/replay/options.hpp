// The keys of a replay device and the typed values made from them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/option.hpp"
#include "pipeline/import/import.hpp"

namespace scansion {

struct ReplayOptions {
  std::string file;
  ImportOptions import;
  std::optional<double> rate; ///< lines per second; empty: as fast as they are taken
  bool loop = false;
};

[[nodiscard]] std::span<const Option> replay_schema() noexcept;
[[nodiscard]] Result<ReplayOptions> replay_options(const OptionValues& values);

} // namespace scansion
