// Looking into the payloads of a group with the codec.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/codec.hpp"
#include "pipeline/record/group_check.hpp"

namespace scansion {
namespace {

struct Scratch {
  GroupDecoder decoder;
  DecodedGroup group;
};

GroupCounts count(const LineGroup& group) noexcept {
  GroupCounts counts;
  counts.runs = group.runs.size();
  for (const Run& run : group.runs) counts.invalid += run.invalid_before;
  for (const ScanLine& line : group.lines) counts.invalid += line.invalid_after;
  return counts;
}

/// Decodes the line table and, when `all`, every level behind it.
GroupInspector inspector(bool all) {
  return [scratch = std::make_shared<Scratch>(), all](std::span<const ByteView> payloads) -> Result<GroupCounts> {
    if (payloads.empty()) return fail(Errc::damaged, "a group without a line table");
    SCANSION_TRY(scratch->decoder.begin(payloads.front(), scratch->group));
    for (const ByteView level : payloads.subspan(1)) {
      if (!all) break;
      SCANSION_TRY(scratch->decoder.add(level, scratch->group));
    }
    return count(scratch->group.group);
  };
}

} // namespace

GroupInspector inspect_all_levels() {
  return inspector(true);
}
GroupInspector inspect_line_table() {
  return inspector(false);
}

} // namespace scansion
