// The reader: finished, unfinished, growing and broken files; and what it may touch.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/record/synthetic.hpp"

#include <chrono>
#include <unistd.h>

namespace scansion::synthetic {
namespace {

void expect_payloads(RecordingReader& reader, const Made& made, std::size_t count) {
  ASSERT_EQ(reader.groups().size(), count);
  Bytes payload;
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(reader.groups()[i].number, made.groups[i].number);
    ASSERT_EQ(reader.groups()[i].payloads.size(), made.groups[i].payloads.size());
    for (std::size_t k = 0; k < made.groups[i].payloads.size(); ++k) {
      ASSERT_OK(reader.read_payload(i, k, payload));
      EXPECT_EQ(payload, made.groups[i].payloads[k]);
      const auto header = reader.read_header(i, k);
      ASSERT_OK(header);
      EXPECT_EQ(header.value(), parse_payload_header(payload).value());
    }
  }
}

TEST(RecordingReader, FinishedAndUnfinished) {
  const Folder folder;
  for (const bool finish : {true, false}) {
    const std::string path = folder / (finish ? "a" : "b");
    const Made made = make(path, {.groups = 300, .body = 9, .gap_after_first = true, .finish = finish});
    auto reader = RecordingReader::open(path);
    ASSERT_OK(reader);
    EXPECT_EQ(reader.value().complete(), finish);
    EXPECT_EQ(reader.value().end().has_value(), finish);
    EXPECT_EQ(reader.value().facts(), facts());
    EXPECT_EQ(reader.value().bytes(), made.size);
    ASSERT_EQ(reader.value().gaps().size(), 1U);
    EXPECT_EQ(reader.value().gaps()[0].reason, "the \"device\" said: \xC3\xBC");
    expect_payloads(reader.value(), made, 300);
    EXPECT_EQ(reader.value().read_header(300, 0).error().code, Errc::usage);
    EXPECT_EQ(reader.value().read_header(0, 5).error().code, Errc::usage);
  }
}

TEST(RecordingReader, OpensAsFarAsTheLastWholeChunk) {
  const Folder folder;
  const std::string path = folder / "a.mcap";
  const Made made = make(path, {.groups = 4});
  for (std::uint64_t size = made.size; size-- > 0;) {
    ASSERT_EQ(::truncate(path.c_str(), static_cast<off_t>(size)), 0);
    auto reader = RecordingReader::open(path);
    if (size < made.head) {
      EXPECT_EQ(reader.error().code, size == 0 ? Errc::undecodable : Errc::damaged);
      continue;
    }
    ASSERT_OK(reader);
    std::size_t whole = 0;
    for (const std::uint64_t end : made.block_end) whole += end <= size ? 1 : 0;
    ASSERT_FALSE(reader.value().complete());
    ASSERT_EQ(reader.value().groups().size(), whole) << size;
    if (size % 97 == 0) expect_payloads(reader.value(), made, whole);
  }
}

TEST(RecordingReader, GrowingFile) {
  const Folder folder;
  auto writer = RecordingWriter::create(folder / "a.mcap", facts());
  ASSERT_OK(writer);
  Made made;
  for (std::uint32_t i = 0; i < 5; ++i) {
    made.groups.push_back(group(facts(), i, i * 64, 64));
    append(writer.value(), made.groups.back());
    auto reader = RecordingReader::open(folder / "a.mcap");
    ASSERT_OK(reader);
    expect_payloads(reader.value(), made, i + 1);
  }
}

/// After a power cut a file may have its length but zeros in its last blocks.
TEST(RecordingReader, DropsLastChunksWithoutTheirBytes) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 6, .body = 3000, .finish = false});
  Bytes bytes = read_file(folder / "a.mcap");
  for (const std::size_t i : {4U, 5U})
    std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(made.payloads_end[i] - 500), 300, std::byte{0});
  write_file(folder / "a.mcap", bytes);
  auto reader = RecordingReader::open(folder / "a.mcap");
  ASSERT_OK(reader);
  expect_payloads(reader.value(), made, 4);
}

TEST(RecordingReader, BrokenSummaryIsDoneWithout) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 3, .gap_after_first = true});
  const Bytes original = read_file(folder / "a.mcap");
  for (std::uint64_t at = made.data_end; at < made.size; ++at) {
    Bytes bytes = original;
    bytes[at] ^= std::byte{0x10};
    write_file(folder / "b.mcap", bytes);
    auto reader = RecordingReader::open(folder / "b.mcap");
    ASSERT_TRUE(reader) << at << ' ' << reader.error().context;
    ASSERT_EQ(reader.value().groups().size(), 3U) << at;
    ASSERT_EQ(reader.value().gaps().size(), 1U) << at;
  }
}

TEST(RecordingReader, BrokenFramingIsAnErrorOrWorkedRound) {
  const Folder folder;
  const Made made = make(folder / "a.mcap", {.groups = 3, .body = 40});
  const Bytes original = read_file(folder / "a.mcap");
  Bytes payload;
  for (std::uint64_t at = made.block_end[0]; at < made.block_end[1]; ++at) {
    Bytes bytes = original;
    bytes[at] ^= std::byte{0x10};
    write_file(folder / "b.mcap", bytes);
    auto reader = RecordingReader::open(folder / "b.mcap");
    if (!reader) {
      ASSERT_EQ(reader.error().code, Errc::damaged) << at;
      ASSERT_NE(reader.error().context.find("recover"), std::string::npos);
      continue;
    }
    for (std::size_t i = 0; i < reader.value().groups().size(); ++i)
      for (std::size_t k = 0; k < 5; ++k) ASSERT_OK(reader.value().read_payload(i, k, payload));
  }
}

TEST(RecordingReader, FilesOfOthers) {
  const Folder folder;
  EXPECT_EQ(RecordingReader::open(folder / "none").error().code, Errc::not_found);
  EXPECT_EQ(RecordingReader::open(folder / "").error().code, Errc::undecodable);
  write_file(folder / "text", std::as_bytes(std::span("0 0 1\n")));
  EXPECT_EQ(RecordingReader::open(folder / "text").error().code, Errc::undecodable);
  make(folder / "a.mcap", {});
  Bytes bytes = read_file(folder / "a.mcap");
  bytes[8 + 9 + 4] = std::byte{'X'}; // profile
  write_file(folder / "b.mcap", bytes);
  EXPECT_EQ(RecordingReader::open(folder / "b.mcap").error().code, Errc::undecodable);
}

TEST(RecordingReader, HundredThousandGroups) {
  const Folder folder;
  constexpr std::uint32_t kGroups = 100'000;
  const RecordingFacts f = facts();
  auto writer = RecordingWriter::create(folder / "a.mcap", f);
  ASSERT_OK(writer);
  EncodedGroup g = group(f, 0, 0, 1, 30);
  for (std::uint32_t i = 0; i < kGroups; ++i) {
    for (Bytes& payload : g.payloads) {
      PayloadHeader h = parse_payload_header(payload).value();
      h.group = i;
      h.first_line = i;
      h.first_time_ns = h.last_time_ns = i * 1'000'000ULL;
      const Bytes body(payload.end() - h.body_size, payload.end());
      seal_payload(h, body, payload);
    }
    ASSERT_OK(writer.value().append(g, 1000, 1, i % 3));
  }
  ASSERT_OK(writer.value().finish({}, 0));
  auto reader = RecordingReader::open(folder / "a.mcap");
  ASSERT_OK(reader);
  ASSERT_EQ(reader.value().groups().size(), kGroups);
  EXPECT_EQ(reader.value().groups().back().number, kGroups - 1);
  EXPECT_EQ(reader.value().read_header(kGroups - 1, 4).value().first_line, kGroups - 1);
  const auto report = verify_with(folder / "a.mcap", inspector());
  ASSERT_OK(report);
  EXPECT_TRUE(report.value().sound);
  EXPECT_EQ(report.value().groups, kGroups);
}

} // namespace
} // namespace scansion::synthetic
