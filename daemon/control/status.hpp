// What the daemon says about itself, as values and as JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scansion {

/// What came over a device's port. frames = accepted + all of rejected.
struct LinkStatus {
  std::uint64_t bytes_in = 0, bytes_out = 0;
  std::uint64_t accepted = 0;                                  ///< frames
  std::vector<std::pair<std::string, std::uint64_t>> rejected; ///< frames by cause
  std::uint64_t raw_dropped = 0;                               ///< events that a transcript at its bound did not take
};

/// State and counters of one device. Counters run since the daemon took the device up; none of them ever goes back.
struct DeviceStatus {
  std::string name;
  std::string driver;
  std::string state;         ///< see name(SessionState)
  std::string error;         ///< the last one; empty when all is well
  std::uint64_t lines = 0;   ///< taken from the device
  std::uint64_t points = 0;  ///< valid ones
  std::uint64_t invalid = 0; ///< invalid samples
  std::uint64_t gaps = 0;
  std::uint64_t lost_lines = 0; ///< taken but never recorded: the disk refused them until the end
  std::uint64_t groups_written = 0;
  std::uint64_t lines_written = 0;
  std::uint64_t queue_depth = 0; ///< lines between acquisition and pipeline
  std::uint64_t queue_bound = 0;
  std::uint64_t pending_groups = 0; ///< closed groups that the disk has not taken yet
  std::int64_t lag_ms = 0;          ///< age of the oldest line that is not written
  std::string recording;            ///< path of the file being written; empty: none
  std::uint64_t recording_bytes = 0;
  std::string last_recording;               ///< path of the newest finished file
  std::string blocked;                      ///< why the disk takes nothing; empty: it does
  std::optional<std::int64_t> last_line_ns; ///< realtime
  std::optional<LinkStatus> link;           ///< empty: a device without a port
};

struct DaemonStatus {
  std::string version;
  std::int64_t pid = 0;
  std::int64_t started_ns = 0; ///< realtime
  std::int64_t uptime_ns = 0;
  std::string config;
  std::string directory;
  std::optional<std::uint64_t> free_mb;
  std::vector<DeviceStatus> devices;
};

/// 2024-05-17T08:30:00.123Z
[[nodiscard]] std::string iso_time(std::int64_t realtime_ns);

/// The reply to {"command":"status"}, one line.
[[nodiscard]] std::string to_json(const DaemonStatus& status);

/// What a command wants of a device.
enum class Order : std::uint8_t {
  start,  ///< go on
  stop,   ///< come to rest, stay ready to go on
  release ///< come to rest and let go of the port
};

/// What requests are answered with. Each is called only when it is needed.
struct Answers {
  std::function<DaemonStatus()> status;
  std::function<Result<void>(std::string_view device, Order order)> order;
};

/// The reply to one request line. Any bytes may come in.
[[nodiscard]] std::string answer(std::string_view request, const Answers& answers);

} // namespace scansion
