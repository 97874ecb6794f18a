// Feature lines as files: text, tables, drawings and meshes, one layer or attribute a type.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/export/output_file.hpp"
#include "pipeline/model/lattice.hpp"
#include "pipeline/record/findings.hpp"

#include <string_view>

namespace scansion {

enum class FeatureFormat : std::uint8_t { txt, csv, json, obj, dxf, ply, vtp };

/// The format of a name; fails with usage.
[[nodiscard]] Result<FeatureFormat> parse_feature_format(std::string_view name);

/// Positions in `unit`; lengths in headers stay millimetres.
[[nodiscard]] Result<void> write_feature_lines(const std::vector<FeatureLine>& lines, FeatureFormat format, Unit unit,
                                               OutputFile& file);

/// The colour of a type in every picture and file: red, green, blue, 0 to 255.
[[nodiscard]] std::array<std::uint8_t, 3> colour(FeatureType type) noexcept;
/// A colour that tells a patch from its neighbours; grey for none.
[[nodiscard]] std::array<std::uint8_t, 3> patch_colour(std::int64_t patch) noexcept;

} // namespace scansion
