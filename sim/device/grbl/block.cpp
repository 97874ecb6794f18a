// One line of G-code as words.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/grbl/block.hpp"

#include <cmath>

namespace scansion::sim::grbl {
namespace {

constexpr int kNoLetter = 1, kBadNumber = 2, kUnsupported = 20, kRepeated = 25, kNegative = 4;
constexpr double kLargest = 1e7;
constexpr std::string_view kLetters = "FIJKLNPRSTXYZ";

} // namespace

std::optional<double> take_number(std::string_view& text) noexcept {
  double sign = 1.0;
  if (text.starts_with('-') || text.starts_with('+')) {
    if (text.front() == '-') sign = -1.0;
    text.remove_prefix(1);
  }
  double value = 0.0, scale = 1.0;
  bool any = false, point = false;
  while (!text.empty()) {
    const char c = text.front();
    if (c >= '0' && c <= '9') {
      any = true;
      value = value * 10.0 + (c - '0');
      if (point) scale *= 10.0;
    } else if (c == '.' && !point) {
      point = true;
    } else {
      break;
    }
    text.remove_prefix(1);
  }
  if (!any) return std::nullopt;
  return sign * value / scale;
}

Block parse_block(std::string_view line) {
  Block out;
  while (!line.empty() && out.error == 0) {
    const char letter = line.front();
    line.remove_prefix(1);
    if (letter < 'A' || letter > 'Z') {
      out.error = kNoLetter;
      break;
    }
    const auto number = take_number(line);
    if (!number || std::abs(*number) > kLargest) {
      out.error = kBadNumber;
    } else if (letter == 'G' || letter == 'M') {
      (letter == 'G' ? out.g : out.m).push_back(static_cast<int>(std::lround(*number * 10.0)));
    } else if (kLetters.find(letter) == std::string_view::npos) {
      out.error = kUnsupported;
    } else if (out.get(letter)) {
      out.error = kRepeated;
    } else if (*number < 0.0 && std::string_view("FNPST").find(letter) != std::string_view::npos) {
      out.error = kNegative;
    } else {
      out.value[static_cast<std::size_t>(letter - 'A')] = *number;
    }
  }
  return out;
}

} // namespace scansion::sim::grbl
