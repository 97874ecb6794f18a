// The text form of what happened on a transport.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/raw_event.hpp"

#include <charconv>

namespace scansion {
namespace {

constexpr std::string_view kHex = "0123456789abcdef";

void append_number(std::string& text, std::int64_t value) {
  char buffer[24];
  text.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

bool take_number(std::string_view& line, std::int64_t& value) {
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
  if (error != std::errc()) return false;
  line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  if (line.empty()) return true;
  if (line.front() != ' ') return false;
  line.remove_prefix(1);
  return true;
}

bool unescape(std::string_view text, std::vector<std::uint8_t>& bytes) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      bytes.push_back(static_cast<std::uint8_t>(text[i]));
      continue;
    }
    const char code = ++i < text.size() ? text[i] : '\0';
    if (code == 'n') {
      bytes.push_back('\n');
    } else if (code == '\\') {
      bytes.push_back('\\');
    } else if (code == 'x' && i + 2 < text.size()) {
      const std::size_t high = kHex.find(text[i + 1]);
      const std::size_t low = kHex.find(text[i + 2]);
      if (high == std::string_view::npos || low == std::string_view::npos) return false;
      bytes.push_back(static_cast<std::uint8_t>(high * 16 + low));
      i += 2;
    } else {
      return false;
    }
  }
  return true;
}

} // namespace

void append_event(std::string& text, RawEvent::Kind kind, const Moment& at, std::span<const std::uint8_t> bytes) {
  text += static_cast<char>(kind);
  text += ' ';
  append_number(text, at.monotonic_ns);
  text += ' ';
  append_number(text, at.realtime_ns);
  if (!bytes.empty()) text += ' ';
  for (const std::uint8_t byte : bytes) {
    if (byte == '\n') {
      text += "\\n";
    } else if (byte == '\\') {
      text += "\\\\";
    } else if (byte >= 0x20 && byte <= 0x7E) {
      text += static_cast<char>(byte);
    } else {
      text += "\\x";
      text += kHex[byte >> 4U];
      text += kHex[byte & 15U];
    }
  }
  text += '\n';
}

Result<RawEvent> parse_event(std::string_view line) {
  RawEvent event;
  constexpr std::string_view kKinds = "O<>LEC";
  if (line.size() < 2 || kKinds.find(line[0]) == std::string_view::npos || line[1] != ' ') {
    return fail(Errc::undecodable, "does not begin with one of O < > L E C and a space");
  }
  event.kind = static_cast<RawEvent::Kind>(line[0]);
  line.remove_prefix(2);
  if (!take_number(line, event.at.monotonic_ns) || !take_number(line, event.at.realtime_ns)) {
    return fail(Errc::undecodable, "has no two times in ns");
  }
  if (!unescape(line, event.bytes)) return fail(Errc::undecodable, "has a backslash that is none of \\\\ \\n \\xHH");
  return event;
}

} // namespace scansion
