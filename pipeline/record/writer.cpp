// The writer: a new file and an appender on it.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/writer.hpp"

#include "pipeline/record/appender.hpp"
#include "pipeline/record/metadata.hpp"
#include "pipeline/record/notes.hpp"

#include <deque>
#include <unistd.h>

namespace scansion {

struct RecordingWriter::Impl {
  Appender appender;
  std::vector<ByteView> views; ///< scratch

  struct Note {
    BlockKind kind;
    std::uint64_t time;
    std::string text;
  };
  std::deque<Note> notes; ///< not written yet

  [[nodiscard]] Result<void> write_notes() {
    for (; !notes.empty(); notes.pop_front()) {
      const Note& note = notes.front();
      SCANSION_TRY(appender.append_note(note.kind, mcap::bytes_of(note.text), note.time));
    }
    return success();
  }
};

RecordingWriter::RecordingWriter(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
RecordingWriter::RecordingWriter(RecordingWriter&&) noexcept = default;
RecordingWriter& RecordingWriter::operator=(RecordingWriter&&) noexcept = default;
RecordingWriter::~RecordingWriter() = default;

Result<RecordingWriter> RecordingWriter::create(const std::string& path, const RecordingFacts& facts, ChunkRule rule) {
  SCANSION_TRY(check_facts(facts));
  SCANSION_TRY(file, File::create(path));
  auto appender = Appender::start(std::move(file), facts, rule);
  if (!appender) {
    ::unlink(path.c_str()); // a file without a head is nothing anyone wants; it was ours alone
    return std::move(appender).error();
  }
  return RecordingWriter(std::make_unique<Impl>(Impl{std::move(appender).value(), {}, {}}));
}

Result<void> RecordingWriter::append(const EncodedGroup& group, std::uint64_t points, std::uint64_t runs,
                                     std::uint64_t invalid) {
  impl_->views.assign(group.payloads.begin(), group.payloads.end());
  return impl_->appender.append_group(impl_->views, points, {runs, invalid});
}

Result<void> RecordingWriter::append(const Gap& gap, std::uint64_t log_time_ns) {
  return impl_->appender.append_gap(gap, log_time_ns);
}

Result<void> RecordingWriter::append(FeatureReport& report, std::uint64_t log_time_ns) {
  const auto add = [&](BlockKind kind, std::vector<std::string> texts) {
    for (std::string& text : texts) impl_->notes.push_back({kind, log_time_ns, std::move(text)});
  };
  add(BlockKind::features, features_messages(report));
  add(BlockKind::patches, patches_messages(report));
  report.clear();
  return impl_->write_notes();
}

Result<void> RecordingWriter::sync() {
  return impl_->appender.sync();
}

Result<void> RecordingWriter::finish(std::optional<std::int64_t> ended_ns, double rounding_mm) {
  SCANSION_TRY(impl_->write_notes());
  return impl_->appender.finish(ended_ns, rounding_mm);
}

std::uint64_t RecordingWriter::bytes() const noexcept {
  return impl_->appender.state().size;
}
const RecordingEnd& RecordingWriter::totals() const noexcept {
  return impl_->appender.state().totals;
}

} // namespace scansion
