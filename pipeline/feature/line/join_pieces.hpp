// Pieces of feature lines put together.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_line.hpp"

#include <vector>

namespace scansion {

/// Whole lines by id, each with the attributes of all its pieces. What was found as two lines in pieces and then met is one
/// line with the lower id. Pieces that are missing leave a straight stretch.
[[nodiscard]] std::vector<FeatureLine> join_pieces(std::vector<FeatureLine> pieces);

} // namespace scansion
