// A transcript played as the device it was taken from.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/transport/transport.hpp"

#include <memory>

namespace scansion {

/// Gives back the bytes at their recorded times, as fast as they are read. What the driver sends must be what was sent then;
/// anything else fails with undecodable, since the answers would belong to other questions. The order of events decides, not
/// deadlines: bytes that came before the next sending are given however long that took then.
/// A loss is a loss again; open() then goes on behind it.
[[nodiscard]] std::unique_ptr<Transport> transcript_transport(std::string path);

} // namespace scansion
