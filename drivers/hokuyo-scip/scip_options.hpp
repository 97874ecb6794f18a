// The keys of a hokuyo-scip device and the typed values made from them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/hokuyo-scip/scan_geometry.hpp"
#include "drivers/transport/options.hpp"

namespace scansion::scip {

inline constexpr TransportKinds kScipKinds{.serial = true, .tcp = true, .baud = 115200};

struct Options {
  char kind = 'D';
  std::optional<std::int32_t> start, end; ///< empty: the sensor's first and last step
  std::int32_t cluster = 1, skip = 0;
  double height_mm = 0.0;
  std::optional<double> gap_mm;
  LineSpacing spacing;
};

[[nodiscard]] std::span<const Option> schema() noexcept;
[[nodiscard]] Result<Options> read_options(const OptionValues& values);

} // namespace scansion::scip
