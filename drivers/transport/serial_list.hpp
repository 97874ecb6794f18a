// The serial ports that are plugged in, with names that stay and what stands in the way of opening them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <optional>
#include <string>
#include <vector>

namespace scansion {

struct SerialPortInfo {
  std::string path;     ///< /dev/ttyACM0: changes from plug to plug
  std::string selector; ///< for the key `port`: a name below /dev/serial/by-id where there is one, else the path
  std::string description;
  std::string manufacturer, product, serial;     ///< of a USB device; empty: not told
  std::optional<unsigned> vendor_id, product_id; ///< of a USB device
  std::string problem;                           ///< why it cannot be opened now; empty: it can
  std::string fix;                               ///< what to do about that
  std::string driver;                            ///< that most likely speaks to it; empty: not known
};

/// Ordered by path. Opens nothing.
[[nodiscard]] Result<std::vector<SerialPortInfo>> list_serial_ports();

/// What keeps this user from reading and writing `path`, and the remedy; both empty when nothing does. A port that is in use
/// by another program is told, too.
void check_access(const std::string& path, std::string& problem, std::string& fix);

} // namespace scansion
