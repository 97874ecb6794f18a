// Lines in space to lines in the plane: the peers are plane, and get the two axes on which a line spans most.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/bench/lines.hpp"
#include "tests/bench/plain.hpp"

#include <vector>

namespace scansion::bench {

using PlaneLines = std::vector<std::vector<PlanePoint>>;
[[nodiscard]] PlaneLines plane_lines(const std::vector<RunView>& runs, Rational resolution_mm);

} // namespace scansion::bench
