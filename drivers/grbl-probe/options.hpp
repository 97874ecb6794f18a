// The keys of a grbl-probe device and the typed values made from them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/grbl-probe/session.hpp"
#include "drivers/option.hpp"
#include "drivers/transport/options.hpp"

namespace scansion::grbl {

inline constexpr TransportKinds kTransports{.serial = true, .tcp = true, .keeps_dtr = true};

struct ProbeOptions {
  SessionOptions session;
  bool resume = false;
};

[[nodiscard]] std::span<const Option> probe_schema();
[[nodiscard]] Result<ProbeOptions> probe_options(const OptionValues& values);

} // namespace scansion::grbl
