// The known name that a mistyped one most likely meant.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace scansion {

/// Smallest number of insertions, deletions, changes and swaps of neighbours; the first name on ties. Empty for no names.
[[nodiscard]] std::string_view nearest_name(std::string_view typed, std::span<const std::string_view> names);

} // namespace scansion
