// Natural order of file names.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/natural_order.hpp"

#include <algorithm>
#include <cstddef>

namespace scansion {
namespace {

bool is_digit(char c) noexcept {
  return c >= '0' && c <= '9';
}

/// Cuts the leading stretch of digits or of other characters off `rest`.
std::string_view take(std::string_view& rest, bool digits) noexcept {
  const auto end = std::find_if(rest.begin(), rest.end(), [digits](char c) { return is_digit(c) != digits; });
  const auto piece = rest.substr(0, static_cast<std::size_t>(end - rest.begin()));
  rest.remove_prefix(piece.size());
  return piece;
}

int compare_numbers(std::string_view a, std::string_view b) noexcept {
  a.remove_prefix(std::min(a.find_first_not_of('0'), a.size()));
  b.remove_prefix(std::min(b.find_first_not_of('0'), b.size()));
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  return a.compare(b);
}

} // namespace

bool natural_less(std::string_view a, std::string_view b) noexcept {
  std::string_view rest_a = a;
  std::string_view rest_b = b;
  while (!rest_a.empty() || !rest_b.empty()) {
    if (const int order = take(rest_a, false).compare(take(rest_b, false)); order != 0) return order < 0;
    const std::string_view number_a = take(rest_a, true);
    const std::string_view number_b = take(rest_b, true);
    if (number_a.empty() != number_b.empty()) return number_a.empty();
    if (const int order = compare_numbers(number_a, number_b); order != 0) return order < 0;
  }
  return a < b;
}

} // namespace scansion
