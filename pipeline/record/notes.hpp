// Feature lines and patches as JSON messages of a recording (docs/FORMAT.md, "Feature lines and patches").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_line.hpp"
#include "pipeline/model/result.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace scansion {

/// Positions of vertices to 0.1 um, or as they are.
enum class Rounding : std::uint8_t { tenth_um, none };
/// One feature line, {"id":...}: also what `scansion export` writes.
void append_feature_line(std::string& out, const FeatureLine& line, Rounding rounding = Rounding::tenth_um);

/// The messages for the two channels: none when there is nothing to say, several when one would be long. Positions are rounded
/// to 0.1 um, all else to three decimals.
[[nodiscard]] std::vector<std::string> features_messages(const FeatureReport& report);
[[nodiscard]] std::vector<std::string> patches_messages(const FeatureReport& report);

/// Adds what a message says to `report`. Fails with damaged.
[[nodiscard]] Result<void> parse_features_message(std::string_view text, FeatureReport& report);
[[nodiscard]] Result<void> parse_patches_message(std::string_view text, FeatureReport& report);

} // namespace scansion
