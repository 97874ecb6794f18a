// Lattice arithmetic: units, fractions, correctly rounded values, distances in units of least precision.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/model/lattice.hpp"

#include <bit>
#include <charconv>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <string>

namespace scansion {
namespace {

TEST(Units, NamesAndMillimetres) {
  for (const Unit unit : {Unit::m, Unit::mm, Unit::um, Unit::in, Unit::ft}) {
    const auto parsed = parse_unit(name(unit));
    ASSERT_TRUE(parsed) << name(unit);
    EXPECT_EQ(parsed.value(), unit);
  }
  EXPECT_EQ(millimetres(Unit::m), (Rational{1000, 1}));
  EXPECT_EQ(millimetres(Unit::mm), (Rational{1, 1}));
  EXPECT_EQ(millimetres(Unit::um), (Rational{1, 1000}));
  EXPECT_EQ(millimetres(Unit::in), (Rational{127, 5}));
  EXPECT_DOUBLE_EQ(millimetres(Unit::ft).value(), 304.8);
  const auto unknown = parse_unit("cm");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, Errc::usage);
  EXPECT_NE(unknown.error().context.find("cm"), std::string::npos);
}

TEST(Rationals, LowestTermsAndLimits) {
  EXPECT_EQ(make_rational(6, 4).value(), (Rational{3, 2}));
  EXPECT_EQ(make_rational((std::int64_t{1} << 60), (std::int64_t{1} << 59)).value(), (Rational{2, 1}));
  for (const auto& [num, den] :
       {std::pair<std::int64_t, std::int64_t>{0, 1}, {1, 0}, {-1, 2}, {1, -2}, {std::int64_t{1} << 53, 1}}) {
    const auto r = make_rational(num, den);
    ASSERT_FALSE(r) << num << '/' << den;
    EXPECT_EQ(r.error().code, Errc::out_of_range);
  }
  EXPECT_EQ(multiply({1, 1000}, {127, 5}).value(), (Rational{127, 5000}));
  EXPECT_EQ(multiply({std::int64_t{1} << 52, 3}, {3, std::int64_t{1} << 52}).value(), (Rational{1, 1}));
  EXPECT_FALSE(multiply({1, std::int64_t{1} << 52}, {1, 3}));
}

TEST(Rationals, Parse) {
  const std::pair<const char*, Rational> good[] = {{"0.005", {1, 200}},
                                                   {"1e-3", {1, 1000}},
                                                   {"5", {5, 1}},
                                                   {"+2.50", {5, 2}},
                                                   {".25", {1, 4}},
                                                   {"1.5E+2", {150, 1}},
                                                   {"0.00000095367431640625", {1, 1048576}}};
  for (const auto& [text, want] : good) {
    const auto r = parse_rational(text);
    ASSERT_TRUE(r) << text << ": " << r.error().context;
    EXPECT_EQ(r.value(), want) << text;
  }
  for (const char* text : {"", ".", "-1", "1/2", "1e", "1e99999", "0x10", "1 ", "nan", "1.2.3"}) {
    const auto r = parse_rational(text);
    ASSERT_FALSE(r) << text;
    EXPECT_EQ(r.error().code, Errc::usage) << text;
  }
  for (const char* text : {"0", "0.000", "1e-30", "1e20", "1e9999", "9007199254740993"}) {
    const auto r = parse_rational(text);
    ASSERT_FALSE(r) << text;
    EXPECT_EQ(r.error().code, Errc::out_of_range) << text;
  }
}

TEST(LatticeValue, ResolutionInMillimetres) {
  Lattice lattice{.resolution = {1, 10000}, .unit = Unit::in};
  EXPECT_EQ(resolution_mm(lattice).value(), (Rational{127, 50000}));
  lattice.resolution = {1, (std::int64_t{1} << 52)};
  lattice.unit = Unit::um;
  EXPECT_FALSE(resolution_mm(lattice));
}

/// The text of total * 10^-digits is the value's definition: reading it correctly rounded must give the lattice's answer.
TEST(LatticeValue, EqualsCorrectlyRoundedDecimal) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 200000; ++round) {
    const int digits = static_cast<int>(random() % 16);
    std::int64_t den = 1;
    for (int k = 0; k < digits; ++k) den *= 10;
    const auto total = static_cast<std::int64_t>(random()) >> (random() % 63);
    const std::string text = std::to_string(total) + "e-" + std::to_string(digits);
    double wide = 0;
    float narrow = 0;
    std::from_chars(text.data(), text.data() + text.size(), wide);
    std::from_chars(text.data(), text.data() + text.size(), narrow);
    Lattice lattice{.resolution = make_rational(1, den).value()};
    ASSERT_EQ(lattice_value(lattice, total), wide) << text;
    lattice.source = Source::float64;
    ASSERT_EQ(lattice_value(lattice, total), wide) << text;
    lattice.source = Source::float32;
    ASSERT_EQ(lattice_value(lattice, total), static_cast<double>(narrow)) << text;
  }
}

TEST(LatticeValue, RoundsToSinglesOnce) {
  // 1 + 2^-24 + 2^-60 lies just above the middle of two singles; rounding to double first would lose the 2^-60.
  const std::int64_t den = std::int64_t{1} << 50;
  Lattice lattice{.resolution = {1, den}, .source = Source::float32};
  EXPECT_EQ(lattice_value(lattice, den + (den >> 24)), 1.0); // a true tie goes to even
  EXPECT_EQ(lattice_value(lattice, den + (den >> 24) + 1), static_cast<double>(std::nextafter(1.0F, 2.0F)));
  lattice.resolution = {(std::int64_t{1} << 53) - 1, (std::int64_t{1} << 53) - 2};
  EXPECT_EQ(lattice_value(lattice, std::numeric_limits<std::int64_t>::max()), 9223372036854775808.0);
  EXPECT_EQ(lattice_value(lattice, std::numeric_limits<std::int64_t>::min()), -9223372036854775808.0);
}

TEST(LatticeValue, IsOdd) {
  std::mt19937_64 random(2);
  for (const Source source : {Source::decimal, Source::float32, Source::float64}) {
    const Lattice lattice{.resolution = {127, 50000}, .source = source};
    for (int round = 0; round < 10000; ++round) {
      const auto total = static_cast<std::int64_t>(random() >> (1 + random() % 40));
      ASSERT_EQ(lattice_value(lattice, -total), -lattice_value(lattice, total)) << total;
    }
  }
}

TEST(Ulps, CountNeighbours) {
  EXPECT_EQ(ulps_between(Source::float64, 1.0, std::nextafter(1.0, 2.0)), 1);
  EXPECT_EQ(ulps_between(Source::float64, 1.0, std::nextafter(1.0, 0.0)), -1);
  EXPECT_EQ(ulps_between(Source::float32, 1.0, static_cast<double>(std::nextafter(1.0F, 2.0F))), 1);
  EXPECT_EQ(ulps_between(Source::float64, 0.0, -0.0), -1);
  EXPECT_EQ(ulps_between(Source::float32, -0.0, 0.0), 1);
  EXPECT_TRUE(std::signbit(step_ulps(Source::float64, 0.0, -1)));
  EXPECT_TRUE(std::signbit(step_ulps(Source::float32, 0.0, -1)));
}

TEST(Ulps, EveryFiniteValueComesBack) {
  std::mt19937_64 random(3);
  const auto any64 = [&] {
    for (;;)
      if (const auto v = std::bit_cast<double>(random()); std::isfinite(v)) return v;
  };
  const auto any32 = [&] {
    for (;;)
      if (const auto v = std::bit_cast<float>(static_cast<std::uint32_t>(random())); std::isfinite(v)) return v;
  };
  for (int round = 0; round < 200000; ++round) {
    const double a = any64();
    const double b = any64();
    ASSERT_EQ(std::bit_cast<std::uint64_t>(step_ulps(Source::float64, a, ulps_between(Source::float64, a, b))),
              std::bit_cast<std::uint64_t>(b));
    const float c = any32();
    const float d = any32();
    const double back = step_ulps(Source::float32, static_cast<double>(c),
                                  ulps_between(Source::float32, static_cast<double>(c), static_cast<double>(d)));
    ASSERT_EQ(std::bit_cast<std::uint32_t>(static_cast<float>(back)), std::bit_cast<std::uint32_t>(d));
  }
  const double most = std::numeric_limits<double>::max();
  EXPECT_EQ(step_ulps(Source::float64, -most, ulps_between(Source::float64, -most, most)), most);
}

} // namespace
} // namespace scansion
