// The newest raw bytes of a device as a file, for whoever looks into a fault.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/journal/directory.hpp"

namespace scansion {

enum class DumpReason : std::uint8_t {
  fault, ///< the device was lost or not understood: <directory>/<device>-fault.raw
  asked  ///< by a signal: <directory>/<device>-dump.raw
};

/// Writes `transcript` under a name that tells the reason, in place of the one before, so that dumps never fill a disk.
/// The value is its path. Nothing is written where less than `min_free_bytes` would be left.
[[nodiscard]] Result<std::string> write_raw_dump(const JournalDirectory& directory, std::string_view device, DumpReason reason,
                                                 std::string_view transcript, std::uint64_t min_free_bytes);

} // namespace scansion
