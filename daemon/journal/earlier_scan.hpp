// The lines of a device's newest run, read back from the recording directory.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/journal/directory.hpp"
#include "drivers/host.hpp"

namespace scansion {

/// Goes back over the files of one run, which begin where the one before ended, to its line 0. At most `most` lines. Empty:
/// there is no recording of the device, or none whose beginning is left.
[[nodiscard]] Result<std::optional<EarlierScan>> find_earlier_scan(const JournalDirectory& directory, std::string_view device,
                                                                   std::size_t most);

} // namespace scansion
