// The repairs with the look into payloads left open; repair.cpp fills it in with the codec.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/group_check.hpp"
#include "pipeline/record/repair.hpp"

namespace scansion {

/// `inspect` decodes a whole group.
[[nodiscard]] Result<VerifyReport> verify_with(const std::string& path, const GroupInspector& inspect);
/// `inspect` decodes a whole group: a group that does not decode is not brought back.
[[nodiscard]] Result<RecoverReport> recover_with(const std::string& input, const std::string& output,
                                                 const GroupInspector& inspect);
/// `count_lines` looks at the line table alone; so below.
[[nodiscard]] Result<std::uint64_t> finish_in_place_with(const std::string& path, const GroupInspector& count_lines);
[[nodiscard]] Result<void> cut_to_level_with(const std::string& input, std::uint32_t level, const std::string& output,
                                             const GroupInspector& count_lines);

} // namespace scansion
