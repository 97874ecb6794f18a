// Numbers as text and as IEEE values; natural order; rounding to a lattice.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/natural_order.hpp"
#include "pipeline/import/number.hpp"
#include "pipeline/import/rounding.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <string>
#include <vector>

namespace scansion {
namespace {

Number parse(const std::string& text) {
  const std::string row = text + "\n";
  Number number;
  const char* end = parse_number(row.data(), number);
  EXPECT_EQ(end, row.data() + text.size()) << text;
  return number;
}

void expect_decimal(const std::string& text, std::int64_t mantissa, int exponent) {
  const Number n = parse(text);
  EXPECT_EQ(n.kind, NumberKind::decimal) << text;
  EXPECT_EQ(n.mantissa, mantissa) << text;
  EXPECT_EQ(n.exponent, exponent) << text;
}

TEST(ParseNumber, Decimals) {
  expect_decimal("0", 0, 0);
  expect_decimal("-0", 0, 0);
  expect_decimal("+12.50", 1250, -2);
  expect_decimal("-.5", -5, -1);
  expect_decimal("7.", 7, 0);
  expect_decimal("1.5e-05", 15, -6);
  expect_decimal("2E3", 2, 3);
  expect_decimal("123456789012345678", 123456789012345678, 0);
  expect_decimal("1e999999999999", 1, kMaxExponent);
}

TEST(ParseNumber, ManyZerosAreNoDigits) {
  expect_decimal("0.000000000000000000000012", 12, -24);
  expect_decimal("1.000000000000000000e+00", 1, 0);
  expect_decimal("-00000000000000000000042.5000000000000000000", -425, -1);
  expect_decimal("1000000000000000000000", 1, 21);
  expect_decimal("0.0000000000000000000000000", 0, 0);
}

TEST(ParseNumber, MoreThanEighteenDigitsAreTheNearestDouble) {
  const Number n = parse("0.1000000000000000055511151231257827");
  EXPECT_EQ(n.kind, NumberKind::float64);
  EXPECT_EQ(n.bits_value(), 0.1);
  EXPECT_EQ(parse("-1234567890123456789012e-3").bits_value(), -1234567890123456789.012);
  EXPECT_EQ(parse("0." + std::string(400, '0') + "1234567890123456789").mantissa, 0);
  EXPECT_EQ(parse("1234567890123456789e400").exponent, kMaxExponent);
  EXPECT_FALSE(std::signbit(to_double(parse("-0.0000000000000000000"))));
}

TEST(ParseNumber, NotNumbers) {
  for (const char* text : {"nan", "NaN", "-nan", "nan(ind)", "inf", "-Infinity", "+INF"})
    EXPECT_EQ(parse(text).kind, NumberKind::invalid) << text;
  for (const char* text : {"", "-", ".", "abc", "e5", "-.e1", "n", "na"}) {
    const std::string row = std::string(text) + "\n";
    Number number;
    EXPECT_EQ(parse_number(row.data(), number), nullptr) << text;
  }
  for (const auto& [text, length] : {std::pair<std::string, int>{"1e", 1}, {"1.2.3", 3}, {"5x", 1}, {"1e+", 1}}) {
    const std::string row = text + "\n";
    Number number;
    EXPECT_EQ(parse_number(row.data(), number), row.data() + length) << text;
  }
}

TEST(ParseNumber, ToDoubleRoundsCorrectly) {
  std::mt19937_64 random(5);
  for (int round = 0; round < 100000; ++round) {
    const auto mantissa = static_cast<std::int64_t>(random() % 1000000000000000000U) >> (random() % 60);
    const Number n{random() % 2 == 0 ? mantissa : -mantissa, static_cast<int>(random() % 60) - 45, NumberKind::decimal};
    const std::string text = std::to_string(n.mantissa) + "e" + std::to_string(n.exponent);
    double want = 0;
    std::from_chars(text.data(), text.data() + text.size(), want);
    ASSERT_EQ(to_double(n), want) << text;
    const Number again = parse(text);
    ASSERT_EQ(again.mantissa, n.mantissa);
  }
}

TEST(ParseNumber, ShortestDecimals) {
  const Number single = shortest_decimal(Number::ieee(NumberKind::float32, static_cast<double>(0.1F)));
  EXPECT_EQ(single.mantissa, 1);
  EXPECT_EQ(single.exponent, -1);
  EXPECT_EQ(decimals_of(shortest_decimal(Number::ieee(NumberKind::float64, 0.005))), 3);
  EXPECT_EQ(decimals_of(parse("1.500")), 1);
  EXPECT_EQ(decimals_of(parse("1500")), 0);
  EXPECT_EQ(decimals_of(parse("15e1")), 0);
}

TEST(AsSingle, AcceptsWhatShortestPrintingGives) {
  std::mt19937 random(6);
  for (int round = 0; round < 100000; ++round) {
    const auto single = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
    if (!std::isfinite(single)) continue;
    std::array<char, 64> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), single, std::chars_format::scientific).ptr;
    const auto back = as_single(parse(std::string(text.data(), end)));
    ASSERT_TRUE(back) << std::string(text.data(), end);
    ASSERT_EQ(*back, single);
  }
  EXPECT_TRUE(as_single(parse("0.0360343000")));
  EXPECT_FALSE(as_single(parse("111194.927")));
  EXPECT_FALSE(as_single(parse("0.100000001490116")));
  EXPECT_FALSE(as_single(parse("1e60")));
}

TEST(NaturalOrder, AsInPython) {
  std::vector<std::string> names{"a10",   "a9",     "a",    "b", "a10b2", "a10b10", "10", "9",
                                 "a/2/x", "a/10/x", "a009", "",  "A",     "a9.csv", "a9a"};
  std::sort(names.begin(), names.end(), [](const auto& a, const auto& b) { return natural_less(a, b); });
  const std::vector<std::string> want{"",    "9",   "10",    "A",      "a",     "a009",   "a9", "a9.csv",
                                      "a9a", "a10", "a10b2", "a10b10", "a/2/x", "a/10/x", "b"};
  EXPECT_EQ(names, want);
  EXPECT_TRUE(natural_less("x99999999999999999999998", "x99999999999999999999999"));
  EXPECT_FALSE(natural_less("same1", "same1"));
}

TEST(RoundTo, NearestTiesAwayFromZero) {
  const auto total = [](const char* text, Rational r) { return round_to(parse(text), r).value().total; };
  EXPECT_EQ(total("0.5", {1, 1}), 1);
  EXPECT_EQ(total("-0.5", {1, 1}), -1);
  EXPECT_EQ(total("0.49999999999999999", {1, 1}), 0);
  EXPECT_EQ(total("2.5e3", {1, 1000}), 2500000);
  EXPECT_EQ(total("0.0075", {1, 200}), 2);
  EXPECT_EQ(total("1", {1, 3}), 3);
  EXPECT_EQ(total("1e-90", {1, 3}), 0);
  EXPECT_DOUBLE_EQ(round_to(parse("0.3"), {1, 1}).value().error, 0.3);
  EXPECT_DOUBLE_EQ(round_to(parse("0.7"), {1, 1}).value().error, 0.3);
  EXPECT_EQ(round_to(Number::ieee(NumberKind::float64, -2.5), {1, 1}).value().total, -3);
  EXPECT_EQ(round_to(Number::ieee(NumberKind::float64, 0x1p-1000), {1, 1}).value().total, 0);
  EXPECT_FALSE(round_to(parse("1e19"), {1, 1}));
  EXPECT_FALSE(round_to(Number::ieee(NumberKind::float64, 1e300), {1, 1}));
}

TEST(RoundTo, ErrsAtMostHalfACount) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 100000; ++round) {
    const auto num = static_cast<std::int64_t>(random() % 5000 + 1);
    const auto den = static_cast<std::int64_t>(random() % 100000 + 1);
    const Rational r = make_rational(num, den).value();
    const auto mantissa = static_cast<std::int64_t>(random() % 2000000000) - 1000000000;
    const auto rounded = round_to({mantissa, -4, NumberKind::decimal}, r);
    ASSERT_TRUE(rounded);
    // 10^4 * num * (value / resolution - total), in whole numbers.
    const std::int64_t off = mantissa * r.den - rounded->total * r.num * 10000;
    ASSERT_LE(2 * std::llabs(off), r.num * 10000);
    ASSERT_NEAR(rounded->error, std::fabs(static_cast<double>(off)) / (1e4 * static_cast<double>(r.num)), 1e-12);
  }
}

} // namespace
} // namespace scansion
