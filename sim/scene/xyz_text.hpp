// Scene lines as the xyz text form: millimetres with three decimals, a blank line between scan lines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/scene/scanner.hpp"

#include <string>

namespace scansion {

/// Appends `um` in mm with three decimals: -1234 is "-1.234".
void append_millimetres(std::string& text, std::int32_t um);

/// Appends the points of `line` that are not missing, one a row; `first` says that no line was written before. A line without
/// such a point appends nothing.
void append_xyz(std::string& text, const SceneLine& line, bool& first);

} // namespace scansion
