// Ruled axes come back exactly, others are left alone, hostile ones are refused.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/ruling.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace scansion {
namespace {

struct Axis {
  std::vector<scansion::Run> runs;
  std::vector<std::int32_t> u;

  void add(double first, double pitch, std::span<const std::int64_t> samples) {
    runs.push_back({static_cast<std::uint32_t>(u.size()), static_cast<std::uint32_t>(samples.size()), 0});
    for (const std::int64_t s : samples)
      u.push_back(static_cast<std::int32_t>(std::llround(first + pitch * static_cast<double>(s))));
  }
};

std::vector<std::int64_t> samples_of(std::mt19937_64& random, std::size_t n, unsigned holes) {
  std::vector<std::int64_t> out;
  std::int64_t at = 0;
  for (; out.size() < n; ++at)
    if (out.empty() || holes == 0 || random() % holes != 0)
      out.push_back(at);
    else
      at += static_cast<std::int64_t>(random() % 100);
  return out;
}

// Bytes of the axis, 0 when it is not ruled.
std::size_t through(const Axis& axis) {
  Ruling ruling;
  if (!ruling.find(axis.runs, axis.u)) return 0;
  SymbolWriter writer;
  ruling.write(axis.runs, axis.u, axis.u.front(), 0, writer);
  Bytes bytes;
  writer.write(bytes);
  ByteReader from(bytes);
  SymbolReader reader;
  EXPECT_TRUE(reader.begin(from));
  std::vector<std::int32_t> back(axis.u.size());
  Ruling other;
  EXPECT_TRUE(other.read(axis.runs, axis.u.front(), 0, reader, back));
  EXPECT_TRUE(reader.finish());
  EXPECT_EQ(back, axis.u);
  return bytes.size();
}

// As the definition says, point after point; extremes where they first are.
TEST(Ruling, PointsAlongAPitchAreMeasuredAlikeInVectors) {
  std::mt19937_64 random(11);
  for (int turn = 0; turn < 3000; ++turn) {
    const std::size_t n = 1 + random() % 60;
    const double pitch = (random() % 2 == 0 ? 1 : -1) * static_cast<double>(1 + random() % 100'000) / 997;
    std::vector<std::int32_t> u(n);
    double at = static_cast<double>(random() % 2'000'000) - 1e6;
    for (auto& v : u) {
      v = static_cast<std::int32_t>(at + static_cast<double>(random() % 3));
      at += pitch * (random() % 40 == 0 ? 3 : 1);
    }
    kernels::Spread spread{static_cast<double>(u.front()), pitch};
    kernels::Spread expected = spread;
    std::size_t i = 1;
    for (; i < n && std::abs((static_cast<double>(u[i]) - u[i - 1]) - pitch) < std::abs(pitch) / 2; ++i) {
      expected.last += 1;
      expected.take(u[i]);
    }
    ASSERT_EQ(kernels::along_pitch(u.data() + 1, n - 1, spread), i - 1);
    EXPECT_EQ(spread.last, expected.last);
    EXPECT_EQ(spread.low, expected.low);
    EXPECT_EQ(spread.high, expected.high);
    EXPECT_EQ(spread.low_at, expected.low_at);
    EXPECT_EQ(spread.high_at, expected.high_at);
  }
}

TEST(Ruling, ARasterWithHolesCostsItsHoles) {
  std::mt19937_64 random(1);
  Axis axis;
  for (int line = 0; line < 64; ++line) axis.add(static_cast<double>(random() % 50), 1, samples_of(random, 160, 30));
  const std::size_t bytes = through(axis);
  EXPECT_GT(bytes, 0U);
  EXPECT_LT(8 * bytes, axis.u.size()); // some 340 holes in 10,240 points
}

TEST(Ruling, RoundedMultiplesOfAPitchAreFound) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 200; ++round) {
    Axis axis;
    const double sign = round % 2 == 0 ? 1 : -1;
    const double pitch =
        sign * std::ldexp(1.0 + std::ldexp(static_cast<double>(random() >> 20), -44), static_cast<int>(random() % 12) + 4);
    for (int line = 0; line < 5; ++line) {
      const double first = static_cast<double>(random() % 100000) / 1000;
      axis.add(first, pitch * (1 + 1e-4 * line), samples_of(random, 1 + random() % 1500, round % 3 == 0 ? 20 : 0));
    }
    EXPECT_GT(through(axis), 0U) << "pitch " << pitch;
  }
}

TEST(Ruling, NoiseIsNotRuled) {
  std::mt19937_64 random(3);
  for (const int noise : {1, 2, 100}) {
    Axis axis;
    axis.add(0, 10, samples_of(random, 500, 0));
    for (auto& u : axis.u) u += static_cast<std::int32_t>(random() % static_cast<unsigned>(2 * noise + 1)) - noise;
    EXPECT_EQ(through(axis), 0U) << noise;
  }
  Axis still;
  still.add(7, 0, samples_of(random, 100, 0));
  EXPECT_EQ(through(still), 0U);
  Axis extreme;
  extreme.runs = {{0, 4, 0}};
  extreme.u = {std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max(),
               std::numeric_limits<std::int32_t>::min(), 0};
  EXPECT_EQ(through(extreme), 0U);
}

TEST(Ruling, ASingleStrayPointMakesItNone) {
  std::mt19937_64 random(4);
  Axis axis;
  for (int line = 0; line < 8; ++line) axis.add(line, 82.1925, samples_of(random, 400, 0));
  ASSERT_GT(through(axis), 0U);
  axis.u[1234] += 2;
  EXPECT_EQ(through(axis), 0U);
}

TEST(Ruling, AnyNumbersAreReadWithoutHarm) {
  std::mt19937_64 random(5);
  const std::vector<scansion::Run> runs{{0, 1, 0}, {1, 40, 0}, {41, 2, 0}, {43, 100, 0}};
  std::size_t refused = 0;
  for (int round = 0; round < 2000; ++round) {
    SymbolWriter writer;
    for (int i = 0; i < 400; ++i) writer.put(static_cast<std::int32_t>(random() >> (random() % 64)), 0);
    Bytes bytes;
    writer.write(bytes);
    ByteReader from(bytes);
    SymbolReader reader;
    ASSERT_TRUE(reader.begin(from));
    std::vector<std::int32_t> u(143);
    Ruling ruling;
    refused += ruling.read(runs, 0, 0, reader, u) ? 0U : 1U;
  }
  EXPECT_GT(refused, 0U);
}

} // namespace
} // namespace scansion
