// xyz text: rows, lines, comments, invalid samples, and every kind of bad row.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/import/support.hpp"

#include <gtest/gtest.h>

namespace scansion::test {
namespace {

using Points = std::vector<Point>;
using Runs = std::vector<Run>;

TEST(ImportText, LinesRowsAndDelimiters) {
  const Imported r =
      import_text("# a comment\n1 2 3\r\n 4\t5   6 # here too\n\n\n# between\n\n7,8 , 9\n10;11;12\n   \n-1.5 +2e1 .25");
  ASSERT_FALSE(r.error) << r.error->context;
  ASSERT_EQ(r.lines.size(), 3U);
  EXPECT_EQ(r.lines[0].points, (Points{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(r.lines[1].points, (Points{{7, 8, 9}, {10, 11, 12}}));
  EXPECT_EQ(r.lines[2].points, (Points{{-1.5, 20, 0.25}}));
  EXPECT_EQ(r.lattice.resolution, (Rational{1, 100}));
  EXPECT_EQ(r.lattice.source, Source::decimal);
  EXPECT_FALSE(r.lattice.exact);
  EXPECT_EQ(r.counts.lines, 3U);
  EXPECT_EQ(r.counts.points, 5U);
  EXPECT_EQ(r.counts.bytes_read, r.counts.bytes_total);
  EXPECT_TRUE(r.notes.empty());
}

TEST(ImportText, ByteOrderMarkAndMissingLastLineFeed) {
  const Imported r = import_text("\xEF\xBB\xBF"
                                 "1 2 3");
  ASSERT_FALSE(r.error) << r.error->context;
  EXPECT_EQ(r.points(), (Points{{1, 2, 3}}));
}

TEST(ImportText, ExtraColumnsAreNotedOnce) {
  const Imported r = import_text("1 2 3 99 red\n4 5 6 98 blue\n");
  ASSERT_FALSE(r.error) << r.error->context;
  EXPECT_EQ(r.points(), (Points{{1, 2, 3}, {4, 5, 6}}));
  ASSERT_EQ(r.notes.size(), 1U);
  EXPECT_NE(r.notes[0].find("ignored"), std::string::npos);
}

TEST(ImportText, InvalidSamplesSplitRuns) {
  const Imported r = import_text("nan 0 0\n1 0 0\n2 0 0\nNaN NaN NaN\n0 0 inf\n3 0 0\n4 0 -nan\n\nnan nan nan\n\n5 0 0\n");
  ASSERT_FALSE(r.error) << r.error->context;
  ASSERT_EQ(r.lines.size(), 3U);
  EXPECT_EQ(r.lines[0].runs, (Runs{{0, 2, 1}, {2, 1, 2}}));
  EXPECT_EQ(r.lines[0].invalid_after, 1U);
  EXPECT_TRUE(r.lines[1].runs.empty());
  EXPECT_EQ(r.lines[1].invalid_after, 1U);
  EXPECT_EQ(r.lines[2].runs, (Runs{{0, 1, 0}}));
  EXPECT_EQ(r.counts.invalid, 5U);
  EXPECT_EQ(r.counts.points, 4U);
  EXPECT_EQ(r.counts.lines, 3U);
}

TEST(ImportText, StepsOverTheGapSplitRuns) {
  ImportOptions options;
  options.gap_mm = 5.0;
  // Exactly 5 mm (3-4-5) is not longer than 5 mm.
  const Imported r = import_text("0 0 0\n3 4 0\n3 4 5\n3 4 10.001\n", options);
  ASSERT_FALSE(r.error) << r.error->context;
  EXPECT_EQ(r.lines[0].runs, (Runs{{0, 3, 0}, {3, 1, 0}}));
  options.gap_mm = 0.3;
  options.unit = Unit::m;
  const Imported m = import_text("0 0 0\n0.0003 0 0\n0.0006 0 0\n0.0009001 0 0\n", options);
  ASSERT_FALSE(m.error) << m.error->context;
  EXPECT_EQ(m.lines[0].runs, (Runs{{0, 3, 0}, {3, 1, 0}}));
}

struct BadText {
  const char* text;
  Errc code;
  const char* where;
  const char* says;
};

class ImportBadText : public testing::TestWithParam<BadText> {};

TEST_P(ImportBadText, NamesRowReasonAndFix) {
  const BadText& bad = GetParam();
  const Imported r = import_text(bad.text);
  ASSERT_TRUE(r.error) << bad.text;
  EXPECT_EQ(r.error->code, bad.code) << r.error->context;
  EXPECT_NE(r.error->context.find(bad.where), std::string::npos) << r.error->context;
  EXPECT_NE(r.error->context.find(bad.says), std::string::npos) << r.error->context;
  EXPECT_NE(r.error->context.find("; "), std::string::npos) << r.error->context;
}

INSTANTIATE_TEST_SUITE_P(Rows, ImportBadText,
                         testing::Values(BadText{"1 2 3\n4 5\n", Errc::undecodable, "scan.xyz:2:", "found 2 fields"},
                                         BadText{"1\n", Errc::undecodable, "scan.xyz:1:", "found 1 field,"},
                                         BadText{"1 2 3\n\n1 2 z\n", Errc::undecodable, "scan.xyz:3:", "found \"z\""},
                                         BadText{"x y z\n1 2 3\n", Errc::undecodable, "scan.xyz:1:", "heading"},
                                         BadText{"1 2 3\n1 2 3x\n", Errc::undecodable, "scan.xyz:2:", "found \"3x\""},
                                         BadText{"1 2 3\n1,,3\n", Errc::undecodable, "scan.xyz:2:", "found \"\""},
                                         BadText{"1 2 3\n1,5 2,5 3,5\n", Errc::undecodable, "scan.xyz:2:", "delimiters"},
                                         BadText{"1 2 3\n1;2,5;3\n", Errc::undecodable, "scan.xyz:2:", "delimiters"},
                                         BadText{"1 2 3\n1 2 1e300\n", Errc::out_of_range, "scan.xyz:2:", "1e12 mm"},
                                         BadText{"1 2 1e400\n", Errc::out_of_range, "scan.xyz:1:", "1e12 mm"},
                                         BadText{"1 -1000000000001 1\n", Errc::out_of_range, "scan.xyz:1:", "1e12 mm"},
                                         BadText{"1 2 3\n\x01\x02\xFF 3 4\n", Errc::undecodable,
                                                 "scan.xyz:2:", "\\x01\\x02\\xFF"},
                                         BadText{"", Errc::undecodable, "scan.xyz:", "no points"},
                                         BadText{"\n\n# nothing\n\n", Errc::undecodable, "scan.xyz:", "no points"},
                                         BadText{"nan nan nan\n", Errc::undecodable, "scan.xyz:", "all 1 samples are invalid"},
                                         BadText{"ply\nformat ascii 1.0\n", Errc::undecodable, "scan.xyz:1:", "PLY"}));

TEST(ImportText, TheLimitIsInMillimetres) {
  ImportOptions options;
  options.unit = Unit::m;
  EXPECT_FALSE(import_text("1 2 1000000000\n", options).error);
  EXPECT_EQ(import_text("1 2 1000000000.5\n", options).error.value().code, Errc::out_of_range);
  options.unit = Unit::um;
  EXPECT_FALSE(import_text("1 2 1000000000000000\n", options).error);
}

TEST(ImportText, NulBytesAndLongRows) {
  const Imported nul = import_text(std::string_view("1 2 3\n1 2 \0 3\n", 14));
  ASSERT_TRUE(nul.error);
  EXPECT_NE(nul.error->context.find("scan.xyz:2: binary data"), std::string::npos) << nul.error->context;
  const std::string wide = "1 2 3" + std::string(4091, ' ') + "\n";
  EXPECT_FALSE(import_text(wide).error);
  const Imported r = import_text("1 2 3\n" + std::string(" ") + wide);
  ASSERT_TRUE(r.error);
  EXPECT_EQ(r.error->code, Errc::undecodable);
  EXPECT_NE(r.error->context.find("scan.xyz:2: a row of more than 4096 bytes"), std::string::npos) << r.error->context;
}

TEST(ImportText, RowsAcrossWindowsKeepTheirNumbers) {
  std::string text;
  for (int i = 0; i < 60000; ++i) text += std::to_string(i) + " " + std::to_string(i % 7) + ".5 1\n";
  const Imported good = import_text(text);
  ASSERT_FALSE(good.error) << good.error->context;
  ASSERT_EQ(good.points().size(), 60000U);
  EXPECT_EQ(good.points()[59999], (Point{59999, 2.5, 1}));
  const Imported bad = import_text(text + "oops\n");
  ASSERT_TRUE(bad.error);
  EXPECT_NE(bad.error->context.find("scan.xyz:60001:"), std::string::npos) << bad.error->context;
}

TEST(ImportText, LongLines) {
  // 3,000,000 points are a line; one sample more than kMaxLinePoints is not.
  std::string text;
  for (int i = 0; i < 3000000; ++i) text += "1 2 3\n";
  const Imported good = import_text(text);
  ASSERT_FALSE(good.error) << good.error->context;
  ASSERT_EQ(good.lines.size(), 1U);
  EXPECT_EQ(good.counts.points, 3000000U);
  while (text.size() < 6 * (std::size_t{kMaxLinePoints} + 1)) text += "1 2 3\n";
  const Imported bad = import_text(text);
  ASSERT_TRUE(bad.error);
  EXPECT_EQ(bad.error->code, Errc::out_of_range);
  EXPECT_NE(bad.error->context.find(":4194305: "), std::string::npos) << bad.error->context;
  EXPECT_NE(bad.error->context.find("is a blank line between scan lines missing?"), std::string::npos);
}

} // namespace
} // namespace scansion::test
