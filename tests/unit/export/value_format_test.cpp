// Counts to numbers: exact decimals, units, IEEE bits.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/export/value_format.hpp"

#include <array>
#include <gtest/gtest.h>
#include <string>

namespace scansion {
namespace {

std::string text(const Lattice& lattice, Unit unit, std::int32_t count, std::int64_t ulp = 0, bool single = false) {
  const auto format = ValueFormat::make(lattice, unit, single);
  EXPECT_TRUE(format);
  std::array<char, ValueFormat::kMaxText> buffer;
  return {buffer.data(), format.value().write(buffer.data(), 0, count, ulp)};
}

Lattice decimal(std::int64_t num, std::int64_t den, Unit unit = Unit::mm, std::int64_t origin = 0) {
  Lattice lattice;
  lattice.resolution = {num, den};
  lattice.unit = unit;
  lattice.origin = {origin, 0, 0};
  return lattice;
}

TEST(ValueFormat, DecimalsAreExactAndShort) {
  EXPECT_EQ(text(decimal(1, 1000), Unit::mm, 0), "0");
  EXPECT_EQ(text(decimal(1, 1000), Unit::mm, 5), "0.005");
  EXPECT_EQ(text(decimal(1, 1000), Unit::mm, -5), "-0.005");
  EXPECT_EQ(text(decimal(1, 1000), Unit::mm, 14975), "14.975");
  EXPECT_EQ(text(decimal(1, 1000), Unit::mm, 14970), "14.97");
  EXPECT_EQ(text(decimal(1, 1000), Unit::mm, -1000), "-1");
  EXPECT_EQ(text(decimal(1, 1), Unit::mm, 120), "120");
  EXPECT_EQ(text(decimal(1, 200), Unit::mm, 3), "0.015");
  EXPECT_EQ(text(decimal(5, 1), Unit::mm, 3), "15");
  EXPECT_EQ(text(decimal(1, 10'000'000'000, Unit::m), Unit::m, -858679), "-0.0000858679");
  EXPECT_EQ(text(decimal(1, 1000, Unit::mm, 9'000'000'000'000), Unit::mm, 1), "9000000000.001");
}

TEST(ValueFormat, UnitsChangeExactlyWhereTheyCan) {
  EXPECT_EQ(text(decimal(1, 1000, Unit::m), Unit::mm, 1234), "1234");
  EXPECT_EQ(text(decimal(1, 1000, Unit::in), Unit::mm, 1000), "25.4");
  EXPECT_EQ(text(decimal(1, 1000, Unit::mm), Unit::um, 1), "1");
  EXPECT_EQ(text(decimal(1, 10, Unit::mm), Unit::in, 254), "1");
  EXPECT_EQ(text(decimal(1, 1, Unit::mm), Unit::in, 1), "0.03937007874015748"); // no finite decimal: shortest double
}

TEST(ValueFormat, ExactLatticesGiveBackTheBits) {
  Lattice lattice = decimal(1, 1 << 20);
  lattice.exact = true;
  lattice.source = Source::float64;
  const double value = 0.1;
  const auto count = static_cast<std::int32_t>(value * (1 << 20) + 0.5);
  const std::int64_t ulp = ulps_between(Source::float64, lattice_value(lattice, count), value);
  EXPECT_EQ(text(lattice, Unit::mm, count, ulp), "0.1");
  lattice.source = Source::float32;
  const std::int64_t single = ulps_between(Source::float32, lattice_value(lattice, count), static_cast<double>(0.1F));
  EXPECT_EQ(text(lattice, Unit::mm, count, single), "0.1");
}

TEST(ValueFormat, SinglePrecision) {
  EXPECT_EQ(text(decimal(1, 1'000'000'000), Unit::mm, 123'456'789, 0, true), "0.12345679");
}

} // namespace
} // namespace scansion
