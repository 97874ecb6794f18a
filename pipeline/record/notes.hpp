// Feature lines and patches as JSON messages of a recording (docs/FORMAT.md, "Feature lines and patches").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_line.hpp"
#include "pipeline/model/result.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace scansion {

/// One feature line as `scansion export` and `scansion tail` write it: every attribute, vertices as [x, y, z, line, index].
void append_feature_line(std::string& out, const FeatureLine& line);
/// The same as an entry of a message: what is usual is left out, vertices are differences of whole counts.
void append_line_entry(std::string& out, const FeatureLine& line);

/// A form feature as messages and `scansion export` have it; lengths in mm, but its place in another unit when one is given.
void append_form(std::string& out, const Form& form, double mm_per_unit = 1.0);

/// The messages for the two channels: none when there is nothing to say, several when one would be long.
[[nodiscard]] std::vector<std::string> features_messages(const FeatureReport& report);
[[nodiscard]] std::vector<std::string> patches_messages(const FeatureReport& report);

/// Adds what a message says to `report`. Fails with damaged.
[[nodiscard]] Result<void> parse_features_message(std::string_view text, FeatureReport& report);
[[nodiscard]] Result<void> parse_patches_message(std::string_view text, FeatureReport& report);

} // namespace scansion
