// Scene lines as the xyz text form.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/xyz_text.hpp"

#include <array>
#include <charconv>

namespace scansion {
namespace {

// "-2147483.648": 12 characters.
char* put_millimetres(char* out, std::int32_t um) noexcept {
  const auto wide = static_cast<std::int64_t>(um);
  if (wide < 0) *out++ = '-';
  const auto size = static_cast<std::uint32_t>(wide < 0 ? -wide : wide);
  out = std::to_chars(out, out + 8, size / 1000U).ptr;
  const std::uint32_t rest = size % 1000U;
  *out++ = '.';
  *out++ = static_cast<char>('0' + rest / 100U);
  *out++ = static_cast<char>('0' + rest / 10U % 10U);
  *out++ = static_cast<char>('0' + rest % 10U);
  return out;
}

} // namespace

void append_millimetres(std::string& text, std::int32_t um) {
  std::array<char, 16> buffer{};
  text.append(buffer.data(), put_millimetres(buffer.data(), um));
}

void append_xyz(std::string& text, const SceneLine& line, bool& first) {
  bool begun = false;
  std::array<char, 48> row{};
  for (const ScenePoint& point : line.points) {
    if (!point.is_there()) continue;
    if (!begun && !first) text.push_back('\n');
    begun = true;
    char* end = put_millimetres(row.data(), point.x);
    *end++ = ' ';
    end = put_millimetres(end, point.y);
    *end++ = ' ';
    end = put_millimetres(end, point.z);
    *end++ = '\n';
    text.append(row.data(), end);
  }
  if (begun) first = false;
}

} // namespace scansion
