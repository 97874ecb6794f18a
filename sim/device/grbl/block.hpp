// One line of G-code as words.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

namespace scansion::sim::grbl {

/// Words of a line: G and M as they stand (G38.2 is 382), every other letter at most once.
struct Block {
  std::vector<int> g, m;                         ///< tenths
  std::array<std::optional<double>, 26> value{}; ///< by letter
  int error = 0;                                 ///< 0, or the number of the error

  [[nodiscard]] std::optional<double> get(char letter) const noexcept { return value[static_cast<std::size_t>(letter - 'A')]; }
};

/// `line` is upper case without spaces and comments.
[[nodiscard]] Block parse_block(std::string_view line);

/// A number at the front of `text`, which goes on behind it.
[[nodiscard]] std::optional<double> take_number(std::string_view& text) noexcept;

} // namespace scansion::sim::grbl
