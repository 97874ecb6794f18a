// Reading and decoding one group, as far as a level.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/reader_impl.hpp"

namespace scansion {
namespace {

Error in_group(const File& file, const GroupEntry& entry, const Error& why) {
  return Error{why.code, file.path() + ": group " + std::to_string(entry.number) + " at byte " +
                             std::to_string(entry.payloads.front().offset) + ": " + why.context + "; use scansion recover"};
}

} // namespace

Result<void> RecordingReader::read_lines(std::size_t i, DecodedGroup& out) {
  SCANSION_TRY(read_payload(i, 0, impl_->payload));
  const auto begun = impl_->decoder.begin(impl_->payload, out);
  if (!begun) return in_group(impl_->file, impl_->groups[i], begun.error());
  return success();
}

Result<void> RecordingReader::read_group(std::size_t i, std::uint32_t level, DecodedGroup& out) {
  SCANSION_TRY(read_lines(i, out));
  const GroupEntry& entry = impl_->groups[i];
  for (std::size_t k = 1; k < entry.payloads.size() && k <= std::size_t{level} + 1; ++k) {
    SCANSION_TRY(read_payload(i, k, impl_->payload));
    const auto added = impl_->decoder.add(impl_->payload, out);
    if (!added) return in_group(impl_->file, entry, added.error());
  }
  return success();
}

} // namespace scansion
