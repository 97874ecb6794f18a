// What happened on a transport, event by event, and its text form: the lines of a transcript.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/transport/transport.hpp"

#include <vector>

namespace scansion {

/// A transcript is text, one event a line: `KIND MONOTONIC_NS REALTIME_NS TEXT`. TEXT is the bytes, where backslash, bytes
/// outside 0x20..0x7E and a line feed stand as \\, \xHH and \n. `#` starts a comment line.
struct RawEvent {
  enum class Kind : char {
    opened = 'O',
    received = '<', ///< bytes from the device
    sent = '>',     ///< bytes to the device
    lost = 'L',     ///< the transport failed; the text says why
    ended = 'E',    ///< the source came to its end
    closed = 'C'
  };
  Kind kind = Kind::received;
  Moment at;
  std::vector<std::uint8_t> bytes;

  friend bool operator==(const RawEvent&, const RawEvent&) = default;
};

inline constexpr std::string_view kTranscriptHeading = "# scansion raw transcript 1\n";

/// Puts the event's line at the end of `text`.
void append_event(std::string& text, RawEvent::Kind kind, const Moment& at, std::span<const std::uint8_t> bytes);
/// One line without its line feed. Fails with undecodable; the context is the reason.
[[nodiscard]] Result<RawEvent> parse_event(std::string_view line);

} // namespace scansion
