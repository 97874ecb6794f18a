// One SCIP 2 message taken apart: echo, status, body. Only its shape and its status sum are judged here.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

namespace scansion::scip {

struct Frame {
  std::string_view echo;   ///< the request as the sensor heard it
  std::string_view status; ///< two characters; one in SCIP 1.1
  std::string_view body;   ///< lines, each with its line feed; may be empty
};

enum class FrameFault : std::uint8_t { none, framing, checksum };

/// `text`: a message without its closing empty line.
[[nodiscard]] FrameFault parse_frame(std::string_view text, Frame& frame) noexcept;

/// The next line of `body` without its sum character, cut off with its line feed; nothing when the sum is wrong or the line
/// is empty.
[[nodiscard]] std::optional<std::string_view> take_summed(std::string_view& body) noexcept;

/// The value of KEY in rows `KEY:value;X`. Rows with a wrong sum are passed over. Sums over the text with and without the
/// semicolon occur.
[[nodiscard]] std::optional<std::string_view> find_key(std::string_view body, std::string_view key) noexcept;
/// The same as a number of 0 to 2^31 - 1.
[[nodiscard]] std::optional<std::int32_t> find_number(std::string_view body, std::string_view key) noexcept;

} // namespace scansion::scip
