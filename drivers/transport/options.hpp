// The keys that say how a device is connected; every driver shows those that fit it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/option.hpp"
#include "drivers/transport/raw_ring.hpp"

#include <memory>
#include <vector>

namespace scansion {

/// What a driver can be reached by, and its defaults.
struct TransportKinds {
  bool serial = false, tcp = false, udp = false, file = false;
  std::int64_t baud = 115200;
  bool keeps_dtr = false; ///< of serial_transport
};

/// Rows for the keys port, baud, tcp, udp, file (as `kinds` says), transcript and raw, behind the driver's own rows.
[[nodiscard]] std::vector<Option> with_transport(std::span<const Option> own, const TransportKinds& kinds);

/// The transport that `values` ask for, its bytes kept in `ring`. Fails with config unless exactly one of port, tcp, udp, file
/// and transcript is given.
[[nodiscard]] Result<std::unique_ptr<Transport>> make_transport(const OptionValues& values, const TransportKinds& kinds,
                                                                std::shared_ptr<RawRing> ring);

} // namespace scansion
