// The whole contract between a device driver and the daemon.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/host.hpp"
#include "drivers/option.hpp"
#include "pipeline/model/lattice.hpp"
#include "pipeline/model/scan_line.hpp"

#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace scansion {

/// What a device says about its lines when it has started. Holds until close().
struct DeviceFacts {
  Lattice lattice;
  std::optional<double> gap_mm; ///< steps longer than this split a line
  double rounding_mm = 0.0;     ///< largest rounding error promised on entry (half a count), 0 when lossless
  /// Lines come when the device likes. False for a recorded source that waits without loss: its groups close when they are
  /// full, never by time, so that the same scan gives the same bytes at any speed.
  bool live = true;
  std::optional<double> pace; ///< lines per second at which the session asks for lines; empty: as they come

  friend bool operator==(const DeviceFacts&, const DeviceFacts&) = default;
};

enum class Delivery : std::uint8_t {
  line,    ///< `line` was filled, stamps included
  gap,     ///< lines were lost: `gap.count` and `gap.reason` were filled; the session knows the first index
  nothing, ///< nothing came within Driver::kPatienceNs
  busy,    ///< no line within that time, but the device answers and works on one: it is not stale
  end      ///< the source is at its end and will not go on (a recorded scan)
};

struct LinkCounters; // drivers/port/link_counters.hpp
class RawRing;       // drivers/transport/raw_ring.hpp

/// What other threads may look at while a driver works, and after. Both are thread-safe; null for a device without a link.
struct LinkView {
  std::shared_ptr<const LinkCounters> counters;
  std::shared_ptr<const RawRing> raw; ///< the newest bytes from and to the device
};

/// One configured device. Most are a decoder and a handshake on a PortDriver (drivers/port). Thread-bound: all calls come from
/// the acquisition thread of its session. It owns no thread, reads no clock and writes no log; reopening, back-off, staleness,
/// pacing and counting are the session's.
///
/// An error's code says what the session does next (see after_error): a missing device is normal and not an error of the
/// configuration. Every context names device or file, place, reason and fix.
class Driver {
public:
  /// next() comes back after this long at the latest, so that stopping and staleness work.
  static constexpr std::int64_t kPatienceNs = 100'000'000;

  Driver() = default;
  Driver(const Driver&) = delete;
  Driver& operator=(const Driver&) = delete;
  virtual ~Driver() = default;

  /// Called before anything else, if at all. A driver that moves no machine needs none of it.
  virtual void attach(DriverHost& /*host*/) {}
  /// Obeys Wanted::hold: comes to rest, stays open and goes on when asked. Any other driver is closed instead.
  [[nodiscard]] virtual bool can_hold() const noexcept { return false; }
  /// It obeyed: nothing moves, and nothing will before Wanted::run.
  [[nodiscard]] virtual bool is_at_rest() const noexcept { return false; }
  /// What keeps the device from delivering, or how it was left, for a person; empty: nothing.
  [[nodiscard]] virtual std::string condition() const { return {}; }
  /// Takes hold of the device: file, port, lock. Called again after close().
  [[nodiscard]] virtual Result<void> open() = 0;
  /// Handshake; lines come from now on.
  [[nodiscard]] virtual Result<DeviceFacts> start() = 0;
  /// `line` and `gap` come in cleared, with buffers to use again.
  [[nodiscard]] virtual Result<Delivery> next(LineBuffer& line, Gap& gap) = 0;
  /// After a failure: trying again is of no use, since a recorded source has nothing more. That is an end, not a loss.
  [[nodiscard]] virtual bool is_over() const noexcept { return false; }
  /// Lets go of the device. Allowed in every state.
  virtual void close() noexcept = 0;
  /// Largest rounding error met since start(), in mm.
  [[nodiscard]] virtual double rounding_mm() const noexcept { return 0.0; }
  /// The same for the whole life of the driver.
  [[nodiscard]] virtual LinkView link() const { return {}; }
};

/// An entry of the registry. To add a driver: a folder with this function, and one scansion_driver() line in
/// drivers/CMakeLists.txt.
struct DriverInfo {
  std::string_view name;
  std::string_view meaning;        ///< one line for a person
  std::span<const Option> options; ///< the keys of its [[device]] table besides name and driver
  /// Makes a driver from values that passed the schema. Checks what a single key cannot show; no input or output.
  Result<std::unique_ptr<Driver>> (*make)(const OptionValues& values);
};

/// What a session does about an error of a driver.
enum class AfterError : std::uint8_t {
  reopen, ///< not there, lost, or not understood: let go, wait with back-off, open again
  give_up ///< trying again cannot help before the configuration changes, or a person says so
};
[[nodiscard]] constexpr AfterError after_error(Errc code) noexcept {
  switch (code) {
    case Errc::usage:
    case Errc::config:
    case Errc::attention:
    case Errc::bug: return AfterError::give_up;
    default: return AfterError::reopen;
  }
}

} // namespace scansion
