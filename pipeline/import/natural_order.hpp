// Natural order of file names: digits compare as numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace scansion {

/// True when `a` comes before `b`: text and numbers alternate, text compares by bytes, numbers by value ("9" before "10").
/// Names that are equal so ("1", "01") are ordered by bytes, so that the order never depends on the file system.
[[nodiscard]] bool natural_less(std::string_view a, std::string_view b) noexcept;

} // namespace scansion
