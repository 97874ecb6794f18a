// The lattice an input gets: decimals, exact bits, a given resolution, and starting again with a finer one.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/import/support.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <random>

namespace scansion::test {
namespace {

using Points = std::vector<Point>;
constexpr std::size_t kBeyondFirstLook = (std::size_t{4} << 20U) + 65536;

/// A binary PLY of one line.
template <class T>
std::string ply_of(const std::vector<std::array<T, 3>>& points) {
  const std::string type = sizeof(T) == 4 ? "float" : "double";
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(points.size()) + "\nproperty " +
                     type + " x\nproperty " + type + " y\nproperty " + type + " z\nproperty uchar line\nend_header\n";
  for (const auto& point : points) {
    std::array<char, 3 * sizeof(T) + 1> bytes{};
    std::memcpy(bytes.data(), point.data(), 3 * sizeof(T));
    text.append(bytes.data(), bytes.size());
  }
  return text;
}

template <class T>
void expect_same_bits(const std::vector<std::array<T, 3>>& want, const Imported& got) {
  ASSERT_FALSE(got.error) << got.error->context;
  const auto points = got.points();
  ASSERT_EQ(points.size(), want.size());
  for (std::size_t i = 0; i < want.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      ASSERT_EQ(std::bit_cast<std::uint64_t>(points[i][axis]), std::bit_cast<std::uint64_t>(static_cast<double>(want[i][axis])))
          << i << ' ' << points[i][axis];
}

Imported import_ply(const std::string& text, const ImportOptions& options = {}) {
  return import_text(text, options, "scan.ply");
}

TEST(Decimals, TrailingZerosDoNotCount) {
  EXPECT_EQ(import_text("1.000 2.50 3\n").lattice.resolution, (Rational{1, 10}));
  EXPECT_EQ(import_text("0.005 0.010 300\n").lattice.resolution, (Rational{1, 1000}));
  EXPECT_EQ(import_text("1000 2000 3e3\n").lattice.resolution, (Rational{1, 1}));
  EXPECT_EQ(import_text("1.000000000000000000e-01 0 0\n").lattice.resolution, (Rational{1, 10}));
}

TEST(Decimals, TheOriginIsZeroOrTheMiddle) {
  const Imported zero = import_text("2147483.647 -2147483.648 0\n");
  EXPECT_EQ(zero.lattice.origin, (std::array<std::int64_t, 3>{0, 0, 0}));
  const Imported middle = import_text("5000000.001 0 -4999999.999\n5000000.003 0 -4999999.999\n");
  ASSERT_FALSE(middle.error) << middle.error->context;
  EXPECT_EQ(middle.lattice.origin[0], 5000000002);
  EXPECT_EQ(middle.lattice.origin[2], -4999999999);
  EXPECT_EQ(middle.points(), (Points{{5000000.001, 0, -4999999.999}, {5000000.003, 0, -4999999.999}}));
  // 2.2e9 counts between the ends, in one run.
  const Imported wide = import_text("0 0 -0.1000000001\n0 0 0.1199999999\n");
  ASSERT_FALSE(wide.error) << wide.error->context;
  EXPECT_FALSE(wide.lattice.exact);
  EXPECT_EQ(wide.lattice.resolution, (Rational{1, 10000000000}));
  EXPECT_EQ(wide.points(), (Points{{0, 0, -0.1000000001}, {0, 0, 0.1199999999}}));
  const Imported full = import_text("0 0 0\n\n0 0 4294967295\n");
  EXPECT_FALSE(full.lattice.exact);
  EXPECT_EQ(full.points(), (Points{{0, 0, 0}, {0, 0, 4294967295.0}}));
}

TEST(Decimals, WhatDoesNotFitKeepsEveryBit) {
  for (const char* text : {"0 0 0\n\n0 0 4294967296\n",                      // more than 2^32 counts
                           "1 2 3\n6.123233995736766e-17 5 6.25\n",          // too many decimals
                           "123456789.123456789 0 1e-15\n0.000000001 0 7\n", // too many counts for 64 bits
                           "0.12345678901234567891 1 2\n"}) {
    const Imported r = import_text(text);
    ASSERT_FALSE(r.error) << r.error->context;
    EXPECT_TRUE(r.lattice.exact) << text;
    ASSERT_EQ(r.notes.size(), 1U) << text;
    EXPECT_NE(r.notes[0].find("every bit"), std::string::npos);
    std::string_view rest = text;
    for (const Point& point : r.points())
      for (const double got : point) {
        rest.remove_prefix(rest.find_first_not_of(" \n"));
        const std::string_view word = rest.substr(0, rest.find_first_of(" \n"));
        rest.remove_prefix(word.size());
        double want = 0;
        std::from_chars(word.data(), word.data() + word.size(), want);
        const float single = static_cast<float>(want);
        EXPECT_EQ(got, r.lattice.source == Source::float32 ? static_cast<double>(single) : want) << word;
      }
  }
  // A run just below the limit stays decimal.
  EXPECT_FALSE(import_text("0 0 0\n0 0 1073741823\n").lattice.exact);
  ImportOptions options;
  options.gap_mm = 1e9;
  EXPECT_FALSE(import_text("0 0 0\n0 0 1073741824\n", options).lattice.exact);
}

TEST(Decimals, TextMadeFromSinglesIsKeptAsSingles) {
  const Imported r = import_text("0 0 1e-30\n-0.09475 0.122609 0.0234474\n0.1234567 0 3e-20\n");
  ASSERT_FALSE(r.error) << r.error->context;
  EXPECT_TRUE(r.lattice.exact);
  EXPECT_EQ(r.lattice.source, Source::float32);
  EXPECT_EQ(static_cast<float>(r.points()[1][0]), -0.09475F);
  EXPECT_EQ(static_cast<float>(r.points()[2][0]), 0.1234567F);
  EXPECT_EQ(import_text("0 0 1e-30\n0.123456789 1 2\n").lattice.source, Source::float64);
}

TEST(Ieee, DecimalsThatGiveTheSameBitsAreUsed) {
  std::vector<std::array<float, 3>> singles;
  std::vector<std::array<double, 3>> doubles;
  for (int i = -2000; i < 2000; ++i) {
    singles.push_back({static_cast<float>(i) / 1000.0F, static_cast<float>(i * 0.5), 7.25F});
    doubles.push_back({i / 1000.0, i * 0.5, -i / 100.0 + 0.0});
  }
  const Imported s = import_ply(ply_of(singles));
  expect_same_bits(singles, s);
  EXPECT_FALSE(s.lattice.exact);
  EXPECT_EQ(s.lattice.source, Source::float32);
  EXPECT_EQ(s.lattice.resolution, (Rational{1, 1000}));
  doubles[2000][2] = 0.0;
  const Imported d = import_ply(ply_of(doubles));
  expect_same_bits(doubles, d);
  EXPECT_FALSE(d.lattice.exact);
  EXPECT_EQ(d.lattice.source, Source::float64);
}

TEST(Ieee, MinusZeroKeepsItsSign) {
  const std::vector<std::array<double, 3>> points{{1.5, -0.0, 0.0}, {-0.0, 2.5, 3.0}};
  const Imported r = import_ply(ply_of(points));
  EXPECT_TRUE(r.lattice.exact);
  expect_same_bits(points, r);
  EXPECT_FALSE(std::signbit(import_text("-0 -0.0 -0e5\n1 1 1\n").points()[0][0]));
}

TEST(Ieee, EveryBitOfRandomValuesComesBack) {
  std::mt19937_64 random(11);
  const auto value64 = [&](double scale) { return scale * (static_cast<double>(random() >> 11U) * 0x1p-52 - 1.0); };
  for (const double scale : {1e-9, 0.25, 1.0, 1000.0, 5e6, 1e12}) {
    std::vector<std::array<double, 3>> doubles;
    std::vector<std::array<float, 3>> singles;
    for (int i = 0; i < 3000; ++i) {
      doubles.push_back({value64(scale), value64(scale) + 0.5 * scale * (scale < 1e12 ? 1 : 0), value64(1e-300)});
      singles.push_back(
          {static_cast<float>(value64(scale)), static_cast<float>(value64(scale * 0.5)), static_cast<float>(value64(1e-42))});
    }
    for (const bool exact : {false, true}) {
      ImportOptions options;
      if (exact) options.resolution = ResolutionExact{};
      for (const Unit unit : {Unit::mm, Unit::um, Unit::in}) {
        if (unit == Unit::in && scale > 1e10) continue;
        options.unit = unit;
        const Imported d = import_ply(ply_of(doubles), options);
        ASSERT_NO_FATAL_FAILURE(expect_same_bits(doubles, d)) << scale;
        EXPECT_TRUE(d.lattice.exact);
        EXPECT_TRUE(resolution_mm(d.lattice));
        ASSERT_NO_FATAL_FAILURE(expect_same_bits(singles, import_ply(ply_of(singles), options))) << scale;
      }
    }
  }
}

TEST(Ieee, TheResolutionIsAPowerOfTwo) {
  ImportOptions options;
  options.resolution = ResolutionExact{};
  // ulp(1000) of a single is 2^-14: coarser than what the span asks for.
  const std::vector<std::array<float, 3>> singles{{1000.0F, 0.0F, 1.0F}, {1000.5F, 0.1F, 1.0F}};
  EXPECT_EQ(import_ply(ply_of(singles), options).lattice.resolution, (Rational{1, 1 << 14}));
  // A span of 1000 in doubles: 2^30 counts allow 2^-20.
  const std::vector<std::array<double, 3>> doubles{{0.0, 0.0, 1.0}, {1000.0, 0.1, 1.0}};
  EXPECT_EQ(import_ply(ply_of(doubles), options).lattice.resolution, (Rational{1, 1 << 20}));
  EXPECT_EQ(import_text("0 0 0\n", options).lattice.resolution, (Rational{1, 1}));
  const Imported text = import_text("0.1 0.2 0.3\n", options);
  EXPECT_TRUE(text.lattice.exact);
  EXPECT_EQ(text.lattice.source, Source::float64);
  EXPECT_EQ(text.points(), (Points{{0.1, 0.2, 0.3}}));
  EXPECT_TRUE(text.notes.empty());
}

TEST(Given, RoundsAndReportsTheLargestError) {
  ImportOptions options;
  options.unit = Unit::m;
  options.resolution = ResolutionGiven{parse_rational("0.001").value()};
  const Imported r = import_text("0.0014 0.0015 -0.0015\n1 2 3.0002\n", options);
  ASSERT_FALSE(r.error) << r.error->context;
  EXPECT_EQ(r.points(), (Points{{0.001, 0.002, -0.002}, {1, 2, 3}}));
  EXPECT_DOUBLE_EQ(r.counts.rounding_mm, 0.5);
  EXPECT_EQ(import_text("1 2 3\n", options).counts.rounding_mm, 0.0);
  const std::vector<std::array<float, 3>> singles{{0.25F, 1.5F, 3.0F}};
  EXPECT_EQ(import_ply(ply_of(singles), options).lattice.source, Source::float32);
}

TEST(Given, WhatDoesNotFitNamesTheRow) {
  ImportOptions options;
  options.resolution = ResolutionGiven{parse_rational("0.001").value()};
  const Imported far = import_text("0 0 0\n1 1 1\n\n5000000 0 0\n", options);
  ASSERT_TRUE(far.error);
  EXPECT_EQ(far.error->code, Errc::out_of_range) << far.error->context;
  EXPECT_NE(far.error->context.find("scan.xyz:"), std::string::npos) << far.error->context;
  options.resolution = ResolutionGiven{{1, (std::int64_t{1} << 53) - 1}};
  EXPECT_EQ(import_text("100000 0 0\n", options).error.value().code, Errc::out_of_range);
  options.resolution = ResolutionGiven{{0, 1}};
  EXPECT_TRUE(import_text("1 0 0\n", options).error);
}

struct Late {
  const char* row; ///< far behind the first look
  const char* expect;
};

TEST(StartingAgain, ALaterValueThatNeedsMore) {
  std::string text;
  while (text.size() < kBeyondFirstLook) text += "1.5 2.5 3.5\n4.5 5.5 6.5\n\n";
  for (const Late& late : {Late{"0.125 0 0\n", "decimals"}, Late{"0 300000000 0\n", "range"}, Late{"0 0 1e-17\n", "bits"},
                           Late{"0.12345678901234567891 0 0\n", "bits"}}) {
    const std::string whole = text + late.row;
    const Imported r = import_text(whole);
    ASSERT_FALSE(r.error) << r.error->context;
    EXPECT_EQ(r.restarts, 1) << late.row;
    // The same values in another order, so that the first look sees the last one, give the same lattice.
    const Imported other = import_text(late.row + ("\n" + text));
    ASSERT_FALSE(other.error) << other.error->context;
    EXPECT_EQ(r.lattice, other.lattice) << late.row;
    EXPECT_EQ(r.counts.points, other.counts.points);
    EXPECT_EQ(r.points().back(), other.points().front());
    EXPECT_EQ(r.points().front(), (Point{1.5, 2.5, 3.5}));
  }
}

TEST(StartingAgain, SurveyAllFirstGivesTheSame) {
  const Scratch scratch;
  std::string text;
  while (text.size() < kBeyondFirstLook) text += "1.5 2.5 3.5\n4.5 5.5 6.5\n\n";
  const std::string path = scratch.write("scan.xyz", text + "0.0625 7 8\n");
  const Imported restarted = import_all({path});
  ASSERT_EQ(restarted.restarts, 1);
  auto importer = Importer::open({path}, {}, {}).value();
  EXPECT_EQ(importer.lattice().resolution, (Rational{1, 10}));
  LineBuffer line;
  ASSERT_TRUE(importer.next(line).value());
  ASSERT_TRUE(importer.survey_all());
  EXPECT_EQ(importer.lattice(), restarted.lattice);
  EXPECT_EQ(importer.counts().lines, 0U);
  std::uint64_t lines = 0;
  while (importer.next(line).value()) ++lines;
  EXPECT_EQ(lines, restarted.counts.lines);
  EXPECT_EQ(importer.counts().points, restarted.counts.points);
}

TEST(StartingAgain, AnErrorStays) {
  const Scratch scratch;
  std::string text;
  while (text.size() < kBeyondFirstLook) text += "1.5 2.5 3.5\n\n";
  auto importer = Importer::open({scratch.write("scan.xyz", text + "1 2\n")}, {}, {}).value();
  LineBuffer line;
  for (;;) {
    const auto more = importer.next(line);
    if (more) {
      ASSERT_TRUE(more.value());
      continue;
    }
    EXPECT_EQ(more.error().code, Errc::undecodable);
    EXPECT_EQ(importer.next(line).error(), more.error());
    break;
  }
}

} // namespace
} // namespace scansion::test
