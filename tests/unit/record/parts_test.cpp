// The parts below the recording: metadata, gap messages, line ranges, pattern search, MCAP values.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/record/synthetic.hpp"

#include "pipeline/record/layout.hpp"
#include "pipeline/record/line_ranges.hpp"
#include "pipeline/record/metadata.hpp"
#include "pipeline/record/window.hpp"

#include <limits>
#include <random>

namespace scansion::synthetic {
namespace {

ByteView content(const Bytes& record) {
  return ByteView(record).subspan(mcap::kRecordHead);
}

TEST(Metadata, FactsComeBack) {
  std::vector<RecordingFacts> all{facts(), RecordingFacts{}};
  RecordingFacts f = facts(16);
  f.device = "A.b_c-9";
  f.lattice = {{1, 1}, {INT64_MIN, INT64_MAX, 0}, Unit::ft, Source::float32, true};
  f.levels = {LevelSpec::Kind::explicit_list, 3, 3.0, 0.0, {1.0 / 3.0, 0.1, 1e-9}, {}};
  f.gap_mm = {};
  f.started_ns = INT64_MIN;
  f.rounding_mm = std::numeric_limits<double>::denorm_min();
  all.push_back(f);
  f.lattice = {{(std::int64_t{1} << 53) - 1, 127}, {1, -2, 3}, Unit::um, Source::float64, false};
  f.levels = {LevelSpec::Kind::uniform, 5, 3.0, 0.7, {}, {}};
  f.stored_levels = 1;
  f.levels.floor = {0.5, true};
  all.push_back(f);
  f.levels.floor = {0.0125, false};
  all.push_back(f);
  for (const RecordingFacts& one : all) {
    const auto again = parse_facts(content(facts_record(one)));
    ASSERT_OK(again);
    EXPECT_EQ(again.value(), one);
    EXPECT_OK(check_facts(one));
  }
}

TEST(Metadata, EndComesBack) {
  RecordingEnd end{UINT64_MAX, 1, 2, 3, 4, 5, -7, 0.1};
  for (int i = 0; i < 2; ++i) {
    const auto again = parse_end(content(end_record(end)));
    ASSERT_OK(again);
    EXPECT_EQ(again.value(), end);
    end.ended_ns = {};
  }
}

TEST(Metadata, NoFlippedByteIsTaken) {
  const Bytes record = facts_record(facts());
  for (std::size_t at = mcap::kRecordHead; at < record.size(); ++at)
    for (unsigned bit = 0; bit < 8; ++bit) {
      Bytes bytes = record;
      bytes[at] ^= static_cast<std::byte>(1U << bit);
      ASSERT_FALSE(parse_facts(content(bytes))) << at;
    }
  for (std::size_t size = 0; size < record.size() - mcap::kRecordHead; ++size)
    ASSERT_FALSE(parse_facts(content(record).first(size)));
}

TEST(GapText, ComesBackWhateverTheReasonIs) {
  for (const char* reason : {"", "plain", "quote \" backslash \\ newline \n tab \t", "\xC3\xBC\xE2\x82\xAC", "\x01\x1f"}) {
    for (const auto& count : {std::optional<std::uint64_t>{}, std::optional<std::uint64_t>{UINT64_MAX}}) {
      const Gap gap{UINT64_MAX, count, reason};
      const auto again = parse_gap(gap_text(gap));
      ASSERT_OK(again);
      EXPECT_EQ(again.value(), gap);
    }
  }
  const std::string broken_utf8 = gap_text({1, 2, "\xFF\xFE"});
  const auto again = parse_gap(broken_utf8);
  ASSERT_OK(again);
  EXPECT_EQ(gap_text(again.value()), broken_utf8) << "bytes that are no text are replaced once and for all";
}

TEST(GapText, OtherJsonIsRefused) {
  for (const char* text :
       {"", "{}", "[]", "null", "{", R"({"first":-1,"count":1,"reason":""})", R"({"first":1,"count":1.5,"reason":""})",
        R"({"first":1,"count":1,"reason":2})", R"({"first":1,"reason":"x"})"})
    EXPECT_FALSE(parse_gap(text)) << text;
  EXPECT_FALSE(parse_gap(std::string(1U << 20U, '[')));
}

std::vector<LineRange> lost(const std::vector<LineRange>& holes, std::vector<Gap> gaps) {
  std::vector<Hole> with_time;
  for (const LineRange& hole : holes) with_time.push_back({hole, 0});
  std::vector<LineRange> ranges;
  for (const Hole& hole : unexplained(with_time, std::move(gaps))) ranges.push_back(hole.lines);
  return ranges;
}

TEST(LineRanges, GapsExplainHoles) {
  using Ranges = std::vector<LineRange>;
  EXPECT_EQ(lost({{10, 19}}, {}), (Ranges{{10, 19}}));
  EXPECT_EQ(lost({{10, 19}}, {{10, 10, ""}}), Ranges{});
  EXPECT_EQ(lost({{10, 19}}, {{10, {}, ""}}), Ranges{});
  EXPECT_EQ(lost({{10, 19}}, {{12, 3, ""}}), (Ranges{{10, 11}, {15, 19}}));
  EXPECT_EQ(lost({{10, 19}}, {{15, {}, ""}}), (Ranges{{10, 14}}));
  EXPECT_EQ(lost({{10, 19}}, {{5, 6, ""}, {18, 100, ""}}), (Ranges{{11, 17}}));
  EXPECT_EQ(lost({{10, 19}, {30, 39}}, {{30, 10, ""}, {10, 10, ""}}), Ranges{});
  EXPECT_EQ(lost({{10, 19}, {30, 39}}, {{0, 35, ""}}), (Ranges{{35, 39}}));
  EXPECT_EQ(lost({{10, 19}, {30, 39}}, {{5, {}, ""}}), (Ranges{{10, 19}, {30, 39}})) << "told of an earlier place";
  EXPECT_EQ(lost({{10, 19}}, {{10, 0, ""}}), (Ranges{{10, 19}}));
  EXPECT_EQ(lost({{10, 19}}, {{0, UINT64_MAX, ""}, {UINT64_MAX, UINT64_MAX, ""}}), Ranges{});
}

/// Against counting line by line.
TEST(LineRanges, AgreeWithCounting) {
  std::mt19937 random(5);
  for (int round = 0; round < 3000; ++round) {
    std::vector<LineRange> holes;
    for (std::uint64_t at = random() % 5; at < 60;) {
      const std::uint64_t last = at + random() % 8;
      holes.emplace_back(at, last);
      at = last + 2 + random() % 8;
    }
    std::vector<Gap> gaps;
    std::array<bool, 100> named{};
    for (std::size_t n = random() % 5; n > 0; --n) {
      gaps.push_back({random() % 60, random() % 12, ""});
      for (std::uint64_t k = 0; k < *gaps.back().count; ++k) named.at(gaps.back().first + k) = true;
    }
    std::vector<std::uint64_t> expected;
    for (const auto& [first, last] : holes)
      for (std::uint64_t k = first; k <= last; ++k)
        if (!named.at(k)) expected.push_back(k);
    std::vector<std::uint64_t> actual;
    for (const auto& [first, last] : lost(holes, gaps))
      for (std::uint64_t k = first; k <= last; ++k) actual.push_back(k);
    ASSERT_EQ(actual, expected) << round;
  }
}

TEST(PatternFinder, FindsWhatAPlainSearchFinds) {
  const Folder folder;
  std::mt19937 random(9);
  std::string text(3U << 20U, '.');
  for (int k = 0; k < 400; ++k) {
    static constexpr std::array<std::string_view, 2> kWords{"needle", "ned"};
    const std::string_view word = kWords[random() % 2];
    text.replace(k < 40 ? (1U << 20U) - 80 + static_cast<std::size_t>(k) * 4 : random() % (text.size() - 8), word.size(), word);
  }
  write_file(folder / "a", std::as_bytes(std::span(text)));
  auto file = File::open_read(folder / "a");
  ASSERT_OK(file);
  Window window(file.value(), text.size());
  static constexpr std::array<std::string_view, 2> kPatterns{"needle", "ned"};
  PatternFinder finder(window, kPatterns);
  std::uint64_t at = 0;
  for (;;) {
    const auto hit = finder.find(at, text.size());
    ASSERT_OK(hit);
    const std::size_t expected = std::min(text.find("needle", at), text.find("ned", at));
    ASSERT_EQ(hit.value().has_value(), expected != std::string::npos);
    if (!hit.value()) break;
    ASSERT_EQ(hit.value()->offset, expected);
    ASSERT_EQ(hit.value()->pattern, text.compare(expected, 6, "needle") == 0 ? 0U : 1U);
    at = expected + 1;
    ASSERT_OK(window.view((at * 7919) % text.size(), 100)); // the finder does not depend on where the window is
  }
}

TEST(Crc32, JoinedIsTheSameAsWhole) {
  Bytes bytes(1000);
  for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<std::byte>(k * k);
  const ByteView view(bytes);
  for (const std::size_t cut : {0U, 1U, 500U, 1000U})
    EXPECT_EQ(mcap::crc32_joined(mcap::crc32(0, view.first(cut)), mcap::crc32(0, view.subspan(cut)), bytes.size() - cut),
              mcap::crc32(0, view));
  EXPECT_EQ(mcap::crc32(0, mcap::bytes_of("123456789")), 0xCBF43926U);
  EXPECT_EQ(mcap::crc32(7, {}), 7U);
}

TEST(Cursor, NeverReadsBeyondItsBytes) {
  Bytes bytes;
  mcap::Builder b(bytes);
  b.u32(5);
  b.raw("abc");
  mcap::Cursor cursor(bytes);
  EXPECT_EQ(cursor.string(), "");
  EXPECT_FALSE(cursor.ok());
  EXPECT_EQ(cursor.u64(), 0U);
  mcap::Cursor entries(bytes);
  EXPECT_TRUE(entries.entries().empty());
  EXPECT_FALSE(entries.ok());
}

} // namespace
} // namespace scansion::synthetic
