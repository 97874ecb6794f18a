// Packed files and tar archives, by libarchive.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/unpack.hpp"

#include <algorithm>
#include <archive.h>
#include <archive_entry.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>

namespace scansion {
namespace {

struct CloseArchive {
  void operator()(archive* a) const noexcept { archive_read_free(a); }
};
using Archive = std::unique_ptr<archive, CloseArchive>;

/// What libarchive's read callback works on.
struct Feed {
  PackedSource source;
  std::uint64_t done = 0;
  std::array<char, std::size_t{1} << 16U> block;
};

la_ssize_t feed_archive(archive* a, void* context, const void** out) {
  auto& feed = *static_cast<Feed*>(context);
  std::size_t want = feed.block.size();
  if (feed.source.seekable) want = static_cast<std::size_t>(std::min<std::uint64_t>(want, feed.source.size - feed.done));
  ssize_t n = 0;
  do {
    n = feed.source.seekable
            ? ::pread(feed.source.fd, feed.block.data(), want, static_cast<off_t>(feed.source.offset + feed.done))
            : ::read(feed.source.fd, feed.block.data(), want);
  } while (n < 0 && errno == EINTR);
  if (n < 0) {
    archive_set_error(a, errno, "reading failed: %s", std::strerror(errno)); // NOLINT(concurrency-mt-unsafe)
    return -1;
  }
  feed.done += static_cast<std::uint64_t>(n);
  *out = feed.block.data();
  return n;
}

Error archive_trouble(archive* a, const std::string& name) {
  const char* text = archive_error_string(a);
  return Error{Errc::undecodable, name + ": cannot be unpacked (" + (text != nullptr ? text : "unknown reason") +
                                      "); copy or pack the file again"};
}

Result<Archive> open_archive(Feed& feed, const std::string& name, bool archives) {
  Archive a(archive_read_new());
  if (!a) return fail(Errc::io, name, ": not enough memory to unpack; free some and try again");
  // Warnings here say that a filter would call another program; Debian's library has all three built in.
  for (const int status :
       {archive_read_support_filter_gzip(a.get()), archive_read_support_filter_xz(a.get()),
        archive_read_support_filter_zstd(a.get()), archive_read_support_format_raw(a.get()),
        archive_read_support_format_empty(a.get()), archives ? archive_read_support_format_tar(a.get()) : ARCHIVE_OK})
    if (status < ARCHIVE_WARN) return archive_trouble(a.get(), name);
  if (archive_read_open(a.get(), &feed, nullptr, feed_archive, nullptr) != ARCHIVE_OK) return archive_trouble(a.get(), name);
  return a;
}

/// Copies the entry's data to the spool.
Result<void> spool_entry(archive* a, Member& member, TempFile& spool) {
  member.offset = spool.size();
  for (;;) {
    const void* data = nullptr;
    std::size_t size = 0;
    la_int64_t offset = 0;
    const int status = archive_read_data_block(a, &data, &size, &offset);
    if (status == ARCHIVE_EOF) break;
    if (status < ARCHIVE_WARN) return archive_trouble(a, member.name);
    if (static_cast<std::uint64_t>(offset) != member.size)
      return fail(Errc::undecodable, member.name, ": has holes; store it in the archive without the sparse option");
    const std::string_view start(static_cast<const char*>(data), std::min(size, kSniffBytes));
    if (offset == 0 && packing_of(start) == Packing::none && is_binary(start))
      return fail(Errc::undecodable, member.name, ":1: binary data; give a text file of points, a CSV or a PLY file");
    SCANSION_TRY(spool.append(std::as_bytes(std::span(static_cast<const char*>(data), size))));
    member.size += size;
  }
  member.fd = spool.fd();
  return success();
}

std::string name_of(archive_entry* entry) {
  if (const char* name = archive_entry_pathname(entry); name != nullptr) return name;
  if (const char* name = archive_entry_pathname_utf8(entry); name != nullptr) return name;
  return {};
}

bool is_plain_file(archive_entry* entry) {
  return archive_entry_filetype(entry) == AE_IFREG && archive_entry_hardlink(entry) == nullptr;
}

} // namespace

Packing packing_of(std::string_view start) noexcept {
  using namespace std::string_view_literals;
  for (const std::string_view mark : {"\x1F\x8B"sv,
                                      "\xFD"
                                      "7zXZ\0"sv,
                                      "\x28\xB5\x2F\xFD"sv})
    if (start.starts_with(mark)) return Packing::packed;
  constexpr std::size_t kTarMark = 257;
  if (start.size() >= 512 && start.substr(kTarMark, 5) == "ustar") return Packing::tar;
  return Packing::none;
}

Result<void> unpack(const PackedSource& source, const std::string& name, const UnpackPlan& plan, MemberList& list) {
  const auto feed = std::make_unique<Feed>();
  feed->source = source;
  SCANSION_TRY(a, open_archive(*feed, name, plan.archives));
  for (;;) {
    archive_entry* entry = nullptr;
    const int status = archive_read_next_header(a.get(), &entry);
    if (status == ARCHIVE_EOF) return success();
    if (status < ARCHIVE_WARN) return archive_trouble(a.get(), name);
    Member member;
    member.name = name;
    if (archive_format(a.get()) != ARCHIVE_FORMAT_RAW) {
      const std::string inner = name_of(entry);
      if (!is_plain_file(entry) || !plan.wanted(inner)) continue;
      member.name += ":" + inner;
    }
    SCANSION_TRY(spool_entry(a.get(), member, list.spool));
    list.members.push_back(std::move(member));
  }
}

} // namespace scansion
