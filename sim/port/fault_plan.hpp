// Faults of a simulated connection: what goes wrong, when, how often. Seeded and scriptable in time.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/device/device_model.hpp"
#include "sim/scene/random.hpp"

#include <optional>

namespace scansion {

/// One --fault: KIND[:key=value,...]. Common keys, in seconds from the start: at, for, every; jitter (share by which `every`
/// varies). Without at, for and every it holds all the time.
struct FaultSpec {
  DeviceFault fault; ///< kind and all values
  double at = 0.0;
  std::optional<double> lasts, every;
  double jitter = 0.0;
};
/// Fails with usage; names what is wrong.
[[nodiscard]] Result<FaultSpec> parse_fault(std::string_view text);

/// Kinds that work on the bytes of any device:
///   unplug   the port vanishes; after `for` seconds it is back and the device starts anew, unless power=1: it went on
///   cut      the connection ends; a host may come back at once
///   mute     nothing comes from the device
///   garbage  `count` random bytes (100) come, once
///   flip     each bit of a byte's chance `rate`: one bit of it is turned over
///   drop, insert   each byte is left out, or a random one put before it, with chance `rate`
///   half     the next message stops half-way, once
///   drip     messages come one byte a millisecond
///   duplicate, lose   each message comes twice, or not at all, with chance `rate`
/// Every other kind is the device's own.
class FaultPlan {
public:
  FaultPlan(std::vector<FaultSpec> specs, std::uint64_t seed);

  /// What changes at a moment: an end or a beginning.
  struct Change {
    const DeviceFault* fault = nullptr;
    bool starts = false;
  };
  /// The next change that is due by `now_ns` (since the start); false: none is.
  [[nodiscard]] bool next_change(std::int64_t now_ns, Change& change);
  /// When the next change is due; kNoTime: never.
  [[nodiscard]] std::int64_t next_at() const;

  /// A message on its way to the host with all the byte faults in force; empty when nothing is left of it.
  void disturb(std::vector<std::uint8_t>& message);
  /// Random bytes for a garbage fault.
  [[nodiscard]] std::vector<std::uint8_t> garbage(const DeviceFault& fault);
  /// Stops the next message half-way.
  void halve_next() noexcept { halves_ = true; }
  [[nodiscard]] bool is_muted() const { return holds("mute"); }
  [[nodiscard]] bool is_dripping() const { return holds("drip"); }
  /// True for the kinds above.
  [[nodiscard]] static bool is_of_port(std::string_view kind);

private:
  struct Entry {
    FaultSpec spec;
    std::int64_t next = 0; ///< ns of the next change
    bool holds = false;
  };
  [[nodiscard]] bool holds(std::string_view kind) const;
  /// Sum of the rates in force.
  [[nodiscard]] double rate(std::string_view kind) const;
  [[nodiscard]] bool chance(double probability) { return probability > 0.0 && random_.uniform() < probability; }

  std::vector<Entry> entries_;
  Random random_;
  std::vector<std::uint8_t> scratch_;
  bool halves_ = false;
};

} // namespace scansion
