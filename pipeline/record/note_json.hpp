// Numbers, words and lists of messages as JSON text.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <concepts>
#include <string>
#include <string_view>

namespace scansion::json {

inline void put(std::string& out, std::integral auto value) {
  std::array<char, 24> text{};
  out.append(text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr);
}

/// The shortest text of `value` rounded to 1 / `per_unit`; as it is for 0. What is no number becomes 0.
inline void put(std::string& out, double value, double per_unit) {
  // Beyond this the lattice's own counts are coarser than the rounding.
  constexpr double kLargest = 1e11;
  double rounded = std::isfinite(value) ? value : 0.0;
  if (per_unit > 0.0 && std::fabs(rounded) < kLargest) rounded = std::nearbyint(rounded * per_unit) / per_unit;
  if (rounded == 0.0) rounded = 0.0; // no -0
  std::array<char, 32> text{};
  out.append(text.data(), std::to_chars(text.data(), text.data() + text.size(), rounded).ptr);
}

template <class Items, class Put>
void put_list(std::string& out, const Items& items, Put put_item) {
  out += '[';
  bool first = true;
  for (const auto& item : items) {
    if (!first) out += ',';
    first = false;
    put_item(item);
  }
  out += ']';
}

inline void put_key(std::string& out, std::string_view key) {
  if (out.back() != '{') out += ',';
  ((out += '"') += key) += "\":";
}

inline void put_word(std::string& out, std::string_view key, std::string_view word) {
  put_key(out, key);
  ((out += '"') += word) += '"';
}

} // namespace scansion::json
