// What the daemon does for a driver that moves a machine: what is asked of the device now, and what it gave before.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/lattice.hpp"
#include "pipeline/model/result.hpp"
#include "pipeline/model/scan_line.hpp"

#include <optional>
#include <string>
#include <vector>

namespace scansion {

enum class Wanted : std::uint8_t {
  run,
  hold, ///< come to rest and stay so, ready to go on
  leave ///< come to rest; the device will be closed
};

/// Lines of a device's newest scan on disk, from line 0 as far as none is missing. Of several runs over it, each of which began
/// with the lines of before, that of the run that came farthest.
struct EarlierScan {
  std::string file; ///< the last of that run
  Lattice lattice;
  std::vector<LineBuffer> lines;
};

/// The driver's window to the daemon.
class DriverHost {
public:
  DriverHost() = default;
  DriverHost(const DriverHost&) = delete;
  DriverHost& operator=(const DriverHost&) = delete;
  virtual ~DriverHost() = default;

  /// Changes at any time; a driver that moves a machine looks at it at least every kLookNs, in open() and start() too.
  [[nodiscard]] virtual Wanted wanted() const noexcept = 0;
  static constexpr std::int64_t kLookNs = 20'000'000;

  /// Empty: there is no recording of this device. At most `most` lines.
  [[nodiscard]] virtual Result<std::optional<EarlierScan>> earlier_scan(std::size_t most) = 0;
};

} // namespace scansion
