// One SCIP 2 message taken apart.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/hokuyo-scip/scip_frame.hpp"

#include "drivers/hokuyo-scip/scip_text.hpp"

#include <algorithm>
#include <charconv>

namespace scansion::scip {
namespace {

std::string_view take_line(std::string_view& text) noexcept {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

bool is_printable(char c) noexcept {
  return c == '\n' || (c >= 0x20 && c <= 0x7E);
}

} // namespace

FrameFault parse_frame(std::string_view text, Frame& frame) noexcept {
  if (!std::all_of(text.begin(), text.end(), is_printable)) return FrameFault::framing;
  frame.echo = take_line(text);
  const std::string_view status = take_line(text);
  frame.body = text;
  if (frame.echo.empty()) return FrameFault::framing;
  if (status == "0" || status == "E") { // SCIP 1.1 has no sums
    frame.status = status;
    return FrameFault::none;
  }
  if (status.size() != 3) return FrameFault::framing;
  frame.status = status.substr(0, 2);
  return sum_of(frame.status) == status[2] ? FrameFault::none : FrameFault::checksum;
}

std::optional<std::string_view> take_summed(std::string_view& body) noexcept {
  const std::string_view line = take_line(body);
  if (line.size() < 2) return std::nullopt;
  const std::string_view text = line.substr(0, line.size() - 1);
  if (sum_of(text) != line.back()) return std::nullopt;
  return text;
}

std::optional<std::string_view> find_key(std::string_view body, std::string_view key) noexcept {
  while (!body.empty()) {
    const std::string_view line = take_line(body);
    if (line.size() < key.size() + 3 || !line.starts_with(key) || line[key.size()] != ':') continue;
    if (line[line.size() - 2] != ';') continue;
    const std::string_view text = line.substr(0, line.size() - 2);
    const char sum = line.back();
    if (sum != sum_of(text) && sum != sum_of(line.substr(0, line.size() - 1))) continue;
    return text.substr(key.size() + 1);
  }
  return std::nullopt;
}

std::optional<std::int32_t> find_number(std::string_view body, std::string_view key) noexcept {
  const auto text = find_key(body, key);
  std::int32_t value = 0;
  if (!text) return std::nullopt;
  const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
  if (error != std::errc() || end != text->data() + text->size() || value < 0) return std::nullopt;
  return value;
}

} // namespace scansion::scip
