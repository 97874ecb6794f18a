// The repairs as the rest of the program sees them: with the codec behind them.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/repair.hpp"

#include "pipeline/record/repair_steps.hpp"

namespace scansion {

Result<VerifyReport> verify(const std::string& path) {
  return verify_with(path, inspect_all_levels());
}

Result<RecoverReport> recover(const std::string& input, const std::string& output) {
  return recover_with(input, output, inspect_all_levels());
}

Result<std::uint64_t> finish_in_place(const std::string& path) {
  return finish_in_place_with(path, inspect_line_table());
}

Result<void> cut_to_level(const std::string& input, std::uint32_t level, const std::string& output) {
  return cut_to_level_with(input, level, output, inspect_line_table());
}

} // namespace scansion
