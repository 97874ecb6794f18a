// The lines of the newest scan of a device, read back from the recording directory.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/journal/directory.hpp"
#include "drivers/host.hpp"

namespace scansion {

/// Of the runs that went on with one another, each beginning with the lines of before, the one that came farthest: its last
/// line is the newest. Goes back over its files, which begin where the one before ended, to line 0. At most `most` lines.
/// Empty: there is no recording of the device, or none whose beginning is left.
[[nodiscard]] Result<std::optional<EarlierScan>> find_earlier_scan(const JournalDirectory& directory, std::string_view device,
                                                                   std::size_t most);

} // namespace scansion
