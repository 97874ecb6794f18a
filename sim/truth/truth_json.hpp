// Ground truth as JSON, written and read.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"
#include "sim/truth/truth.hpp"

#include <string>
#include <string_view>

namespace scansion {

/// Lengths in mm with three decimals; the layout stands in scansim(1).
[[nodiscard]] std::string truth_json(const Truth& truth);
/// Fails with undecodable.
[[nodiscard]] Result<Truth> parse_truth(std::string_view json);

} // namespace scansion
