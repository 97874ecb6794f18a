// The keys of a hokuyo-scip device and the typed values made from them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/hokuyo-scip/scan_geometry.hpp"
#include "drivers/port/spacing.hpp"
#include "drivers/transport/options.hpp"

namespace scansion::scip {

inline constexpr TransportKinds kScipKinds{.serial = true, .tcp = true, .baud = 115200};

struct Options {
  ScanPlan plan;                          ///< without its first and last step
  std::optional<std::int32_t> start, end; ///< empty: the sensor's
  int baud = 0;
  std::optional<int> change_baud; ///< the rate to go to by SS
  double height_mm = 0.0;
  std::optional<double> gap_mm;
  LineSpacing spacing;
};

[[nodiscard]] std::span<const Option> schema() noexcept;
[[nodiscard]] Result<Options> read_options(const OptionValues& values);

} // namespace scansion::scip
