// Found feature lines and patches from the files that `scansion export` writes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"
#include "tests/score/score.hpp"

#include <string_view>

namespace scansion::score {

/// `--what features --format txt`. Fails with undecodable.
[[nodiscard]] Result<std::vector<FoundLine>> parse_lines_text(std::string_view text);
/// `--what patches --format txt` of every point, in input order; `truth` says how many points each line has.
[[nodiscard]] Result<std::vector<std::vector<std::uint32_t>>> parse_patches_text(std::string_view text, const Truth& truth);

} // namespace scansion::score
