// CSV profiles: headings, columns, labels, line numbers, made y.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/import/support.hpp"

#include <gtest/gtest.h>

namespace scansion::test {
namespace {

using Points = std::vector<Point>;
using Runs = std::vector<Run>;

Imported import_csv(std::string_view text, const ImportOptions& options = {}) {
  return import_text(text, options, "scan.csv");
}

TEST(ImportCsv, TwoColumnsAreXAndZ) {
  ImportOptions options;
  options.spacing = 0.1;
  const Imported r = import_csv("1,10\n2,20\n\n3,30\n\n\n4,40\n", options);
  ASSERT_FALSE(r.error) << r.error->context;
  ASSERT_EQ(r.lines.size(), 3U);
  EXPECT_EQ(r.points(), (Points{{1, 0, 10}, {2, 0, 20}, {3, 0.1, 30}, {4, 0.2, 40}}));
  EXPECT_EQ(r.lattice.resolution, (Rational{1, 10}));
}

TEST(ImportCsv, OneFilePerProfile) {
  const Scratch scratch;
  for (int i = 1; i <= 11; ++i) scratch.write("p" + std::to_string(i) + ".csv", std::to_string(i) + ";7\n");
  const Imported r = import_all({scratch.path()});
  ASSERT_FALSE(r.error) << r.error->context;
  ASSERT_EQ(r.lines.size(), 11U);
  for (std::size_t i = 0; i < 11; ++i)
    EXPECT_EQ(r.lines[i].points, (Points{{static_cast<double>(i + 1), static_cast<double>(i), 7}}));
}

TEST(ImportCsv, HeadingsNameColumnsInAnyOrder) {
  const Imported r = import_csv("\"Z [mm]\";intensity;Line;X;y\n3;9;1;1;2\n6;9;1;4;5\n9;9;A2;7;8\n");
  ASSERT_FALSE(r.error) << r.error->context;
  ASSERT_EQ(r.lines.size(), 2U);
  EXPECT_EQ(r.lines[0].points, (Points{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(r.lines[1].points, (Points{{7, 8, 9}}));
  ASSERT_EQ(r.notes.size(), 1U);
  EXPECT_NE(r.notes[0].find("intensity"), std::string::npos);
}

TEST(ImportCsv, ManyLineChangesAcrossBlocks) {
  for (const int length : {1, 2, 3, 5}) {
    std::string text = "line,x,z\n";
    for (int i = 0; i < 2000; ++i) text += std::to_string(i / length % 2) + "," + std::to_string(i) + ",5\n";
    const Imported r = import_csv(text);
    ASSERT_FALSE(r.error) << r.error->context;
    ASSERT_EQ(r.lines.size(), static_cast<std::size_t>((2000 + length - 1) / length));
    double x = 0;
    double y = 0;
    for (const ImportedLine& line : r.lines) {
      for (const Point& p : line.points) EXPECT_EQ(p, (Point{x++, y, 5}));
      ++y;
    }
    EXPECT_EQ(x, 2000);
  }
}

TEST(ImportCsv, EmptyFieldsAreInvalidSamples) {
  for (const char* text : {"1,10\n2,\n3,30\n", "1;10\n2; \n3;30\n", "1\t10\n2\t\n3\t30\n"}) {
    const Imported r = import_csv(text);
    ASSERT_FALSE(r.error) << text << r.error->context;
    ASSERT_EQ(r.lines.size(), 1U);
    EXPECT_EQ(r.lines[0].runs, (Runs{{0, 1, 0}, {1, 1, 1}})) << text;
    EXPECT_EQ(r.counts.invalid, 1U);
  }
}

TEST(ImportCsv, AThirdColumnOfZerosAndOnesIsALabel) {
  const Imported r = import_csv("1,10,0\n2,20,1.000\n3,30,0\n");
  ASSERT_FALSE(r.error) << r.error->context;
  EXPECT_EQ(r.points(), (Points{{1, 0, 10}, {2, 0, 20}, {3, 0, 30}}));
  ASSERT_EQ(r.notes.size(), 1U);
  EXPECT_NE(r.notes[0].find("labels"), std::string::npos);
  const Imported zeros = import_csv("1,10,0\n2,20,0\n");
  EXPECT_EQ(zeros.points(), (Points{{1, 10, 0}, {2, 20, 0}}));
  const Imported heights = import_csv("1,10,0\n2,20,1\n3,30,2\n");
  EXPECT_EQ(heights.points(), (Points{{1, 10, 0}, {2, 20, 1}, {3, 30, 2}}));
  const Imported named = import_csv("x,y,z\n1,10,0\n2,20,1\n");
  EXPECT_EQ(named.points(), (Points{{1, 10, 0}, {2, 20, 1}}));
  ImportOptions options;
  options.columns = "x,y,z";
  EXPECT_EQ(import_csv("1,10,0\n2,20,1\n", options).points(), (Points{{1, 10, 0}, {2, 20, 1}}));
  options.columns = "x,z,-";
  EXPECT_EQ(import_csv("1,10,foo\n2,20,1\n", options).points(), (Points{{1, 0, 10}, {2, 0, 20}}));
  options.columns = "-,z,x";
  EXPECT_EQ(import_csv("a,b,c\n0,10,1\n0,20,2\n", options).points(), (Points{{1, 0, 10}, {2, 0, 20}}));
}

/// The first look takes the third column for labels; a 2 far behind it proves that it was z.
TEST(ImportCsv, ALateValueTurnsLabelsIntoHeights) {
  std::string text;
  while (text.size() < (std::size_t{5} << 20U)) text += "1.125,10,1\n2.125,20,0\n";
  const Imported labels = import_csv(text);
  ASSERT_FALSE(labels.error) << labels.error->context;
  EXPECT_EQ(labels.restarts, 0);
  EXPECT_EQ(labels.points()[0], (Point{1.125, 0, 10}));
  const Imported heights = import_csv(text + "3,30,2\n");
  ASSERT_FALSE(heights.error) << heights.error->context;
  EXPECT_EQ(heights.restarts, 1);
  EXPECT_EQ(heights.points()[0], (Point{1.125, 10, 1}));
  EXPECT_EQ(heights.points().back(), (Point{3, 30, 2}));
}

TEST(ImportCsv, FoundByContentOnly) {
  EXPECT_EQ(import_text("x,z\n1,2\n", {}, "profile").points(), (Points{{1, 0, 2}}));
  EXPECT_EQ(import_text("1,2\n", {}, "profile").points(), (Points{{1, 0, 2}}));
  EXPECT_EQ(import_text("1,2,3\n", {}, "profile").points(), (Points{{1, 2, 3}}));
  EXPECT_TRUE(import_text("1 2\n", {}, "profile").error);
  ImportOptions options;
  options.format = ImportFormat::csv;
  EXPECT_EQ(import_text("1 2\n", options, "profile").points(), (Points{{1, 0, 2}}));
}

TEST(ImportCsv, MadeYIsExactForLongScans) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += "1,2\n\n";
  ImportOptions options;
  options.spacing = 0.1;
  const Imported r = import_csv(text, options);
  ASSERT_EQ(r.lines.size(), 1000U);
  EXPECT_EQ(r.lines[3].points[0][1], 0.3);
  EXPECT_EQ(r.lines[999].points[0][1], 99.9);
  options.spacing = 0.1234567890123456; // its multiples leave 18 digits
  const Imported fine = import_csv(text, options);
  ASSERT_FALSE(fine.error) << fine.error->context;
  EXPECT_DOUBLE_EQ(fine.lines[999].points[0][1], 999 * 0.1234567890123456);
}

TEST(ImportCsv, Errors) {
  const std::pair<const char*, const char*> bad[] = {{"x,y\n1,2\n", "scan.csv:1: the heading"},
                                                     {"x,x,z\n1,2,3\n", "twice"},
                                                     {"1\n", "scan.csv:1: found 1 field"},
                                                     {"1,2\n3\n", "scan.csv:2: found 1 field"},
                                                     {"1,2\n3,a\n", "scan.csv:2: found \"a\""},
                                                     {"1;2\n3,5;4\n", "scan.csv:2: found \"3,5\""},
                                                     {"x,z\n", "no points"}};
  for (const auto& [text, says] : bad) {
    const Imported r = import_csv(text);
    ASSERT_TRUE(r.error) << text;
    EXPECT_EQ(r.error->code, Errc::undecodable) << r.error->context;
    EXPECT_NE(r.error->context.find(says), std::string::npos) << r.error->context;
  }
  for (const char* columns : {"x,y", "x,q,z", "x,x,z", ","}) {
    ImportOptions options;
    options.columns = columns;
    const Imported r = import_csv("1,2,3\n", options);
    ASSERT_TRUE(r.error) << columns;
    EXPECT_EQ(r.error->code, Errc::usage) << columns;
  }
}

} // namespace
} // namespace scansion::test
