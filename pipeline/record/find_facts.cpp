// Reading the head, or doing without it.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/find_facts.hpp"

#include "pipeline/record/metadata.hpp"

namespace scansion {
namespace {

using namespace std::string_view_literals;

constexpr std::uint64_t kMaxHeadRecord = kMaxMetadata;
constexpr std::size_t kMaxHeadRecords = 64;
/// Length and text of the name in a Metadata record; the record's framing stands before it.
constexpr std::string_view kFactsPattern = "\x08\0\0\0scansion"sv;

/// The content of the Metadata record at `offset`, if that is one.
Result<std::optional<ByteView>> metadata_at(Window& window, std::uint64_t offset) {
  SCANSION_TRY(start, window.view(offset, mcap::kRecordHead));
  const mcap::RecordHead head = mcap::record_head(start);
  if (!mcap::is(head, mcap::Opcode::metadata) || head.length > kMaxMetadata) return std::optional<ByteView>{};
  SCANSION_TRY(record, window.view(offset, mcap::kRecordHead + head.length));
  if (record.size() != mcap::kRecordHead + head.length) return std::optional<ByteView>{};
  return std::optional<ByteView>{record.subspan(mcap::kRecordHead)};
}

Result<void> check_profile(const std::string& path, ByteView header_content) {
  mcap::Cursor cursor(header_content);
  const std::string profile = cursor.string();
  if (profile != "scansion")
    return fail(Errc::undecodable, path, ": is an MCAP file of another program, no recording of scansion");
  return success();
}

} // namespace

Result<Head> read_head(Window& window) {
  const std::string& path = window.file().path();
  SCANSION_TRY(magic, window.view(0, mcap::kMagic.size()));
  if (mcap::text_of(magic) != mcap::kMagic.substr(0, magic.size()) || magic.empty())
    return fail(Errc::undecodable, path, ": is no recording (it does not start as an MCAP file)");
  std::uint64_t at = mcap::kMagic.size();
  for (std::size_t n = 0; n < kMaxHeadRecords; ++n) {
    SCANSION_TRY(start, window.view(at, mcap::kRecordHead));
    const mcap::RecordHead head = mcap::record_head(start);
    if (head.opcode == 0 || head.length > kMaxHeadRecord || head.length > window.size() - at - mcap::kRecordHead) break;
    SCANSION_TRY(record, window.view(at, mcap::kRecordHead + head.length));
    const ByteView content = record.subspan(mcap::kRecordHead);
    if (n == 0 && !mcap::is(head, mcap::Opcode::header)) break;
    if (n == 0) {
      SCANSION_TRY(check_profile(path, content));
    }
    at += mcap::kRecordHead + head.length;
    if (!mcap::is(head, mcap::Opcode::metadata)) continue;
    auto facts = parse_facts(content);
    if (facts) return Head{std::move(facts).value(), at};
    if (facts.error().code == Errc::undecodable) return fail(Errc::undecodable, path, ": ", facts.error().context);
    return fail(Errc::damaged, path, ": the head cannot be trusted: ", facts.error().context, "; try scansion recover");
  }
  return fail(Errc::damaged, path, ": the head is cut or broken near byte ", std::to_string(at), "; try scansion recover");
}

Result<RecordingFacts> find_facts(Window& window) {
  auto head = read_head(window);
  if (head) return std::move(head).value().facts;
  if (head.error().code == Errc::io) return std::move(head).error();
  PatternFinder finder(window, std::span(&kFactsPattern, 1));
  for (std::uint64_t from = mcap::kRecordHead; from < window.size();) {
    SCANSION_TRY(hit, finder.find(from, window.size()));
    if (!hit) break;
    SCANSION_TRY(content, metadata_at(window, hit->offset - mcap::kRecordHead));
    if (content) {
      auto facts = parse_facts(*content);
      if (facts) return std::move(facts).value();
    }
    from = hit->offset + 1;
  }
  return std::move(head).error();
}

} // namespace scansion
