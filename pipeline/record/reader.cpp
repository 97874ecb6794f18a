// Opening a recording and handing out its raw payloads.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/reader.hpp"

#include "pipeline/record/index.hpp"
#include "pipeline/record/notes.hpp"
#include "pipeline/record/reader_impl.hpp"

namespace scansion {

RecordingReader::RecordingReader(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
RecordingReader::RecordingReader(RecordingReader&&) noexcept = default;
RecordingReader& RecordingReader::operator=(RecordingReader&&) noexcept = default;
RecordingReader::~RecordingReader() = default;

Result<RecordingReader> RecordingReader::open(const std::string& path) {
  SCANSION_TRY(file, File::open_read(path));
  auto impl = std::make_unique<Impl>(std::move(file));
  SCANSION_TRY(size, impl->file.size());
  impl->size = size;
  Window window(impl->file, size);
  SCANSION_TRY(head, read_head(window));
  SCANSION_TRY(index, build_index(window, head));
  impl->facts = std::move(head.facts);
  impl->complete = index.complete;
  impl->end = index.end;
  impl->groups = std::move(index.groups);
  impl->gaps = std::move(index.gaps);
  impl->notes = std::move(index.notes);
  return RecordingReader(std::move(impl));
}

const RecordingFacts& RecordingReader::facts() const noexcept {
  return impl_->facts;
}
bool RecordingReader::complete() const noexcept {
  return impl_->complete;
}
const std::optional<RecordingEnd>& RecordingReader::end() const noexcept {
  return impl_->end;
}
const std::vector<GroupEntry>& RecordingReader::groups() const noexcept {
  return impl_->groups;
}
const std::vector<Gap>& RecordingReader::gaps() const noexcept {
  return impl_->gaps;
}
const std::vector<NoteEntry>& RecordingReader::notes() const noexcept {
  return impl_->notes;
}

Result<void> RecordingReader::read_note(std::size_t i, FeatureReport& report) {
  if (i >= impl_->notes.size()) return fail(Errc::usage, impl_->file.path(), ": there is no such message");
  const NoteEntry& note = impl_->notes[i];
  impl_->payload.resize(note.size);
  SCANSION_TRY(impl_->file.read_at(note.offset, impl_->payload));
  const std::string_view text = mcap::text_of(impl_->payload);
  auto read = note.patches ? parse_patches_message(text, report) : parse_features_message(text, report);
  if (read) return success();
  return fail(read.error().code, impl_->file.path(), ": byte ", std::to_string(note.offset), ": ", read.error().context,
              "; use scansion recover");
}

std::uint64_t RecordingReader::bytes() const noexcept {
  return impl_->size;
}

Result<PayloadHeader> RecordingReader::read_header(std::size_t i, std::size_t payload) {
  if (i >= impl_->groups.size() || payload >= impl_->groups[i].payloads.size())
    return fail(Errc::usage, impl_->file.path(), ": there is no such group or payload");
  const GroupEntry::Place place = impl_->groups[i].payloads[payload];
  std::array<std::byte, kLongestPayloadHeader> room{};
  const auto bytes = std::span(room).first(std::min<std::size_t>(room.size(), place.size));
  SCANSION_TRY(impl_->file.read_at(place.offset, bytes));
  auto header = parse_payload_header(bytes, place.size);
  if (!header)
    return fail(header.error().code, impl_->file.path(), ": byte ", std::to_string(place.offset), ": ", header.error().context,
                "; use scansion recover");
  return header;
}

Result<void> RecordingReader::read_payload(std::size_t i, std::size_t payload, Bytes& out) {
  if (i >= impl_->groups.size() || payload >= impl_->groups[i].payloads.size())
    return fail(Errc::usage, impl_->file.path(), ": there is no such group or payload");
  const GroupEntry::Place place = impl_->groups[i].payloads[payload];
  out.resize(place.size);
  return impl_->file.read_at(place.offset, out);
}

} // namespace scansion
