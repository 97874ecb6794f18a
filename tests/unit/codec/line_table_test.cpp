// Axis scales: shared steps and steps that nearly all values share.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/line_table.hpp"

#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace scansion {
namespace {

void expect_scale_holds(const std::vector<std::int32_t>& values) {
  const AxisScale scale = find_scale(values);
  for (const std::int32_t v : values) {
    const std::int64_t u = scale.steps(v);
    const std::int64_t r = scale.remainder(v);
    EXPECT_EQ(std::int64_t{scale.base} + static_cast<std::int64_t>(scale.step) * u + r, v);
    EXPECT_EQ(u, static_cast<std::int32_t>(u));
    if (!scale.split) {
      EXPECT_EQ(r, 0);
    }
  }
}

TEST(AxisScale, FindsTheSharedStep) {
  EXPECT_EQ(find_scale(std::vector<std::int32_t>{7, 1007, -2993}).step, 1000U);
  EXPECT_FALSE(find_scale(std::vector<std::int32_t>{7, 1007, -2993}).split);
  EXPECT_EQ(find_scale(std::vector<std::int32_t>{5, 5, 5}).step, 1U);
  expect_scale_holds({7, 1007, -2993});
}

TEST(AxisScale, SplitsWhenNearlyAllShareACoarserStep) {
  std::mt19937 random(1);
  std::vector<std::int32_t> values;
  for (int i = 0; i < 2000; ++i)
    values.push_back(static_cast<std::int32_t>(random() % 2000000) * 1000 + (i % 20 == 0 ? 370 : 0) - 1000000000);
  const AxisScale scale = find_scale(values);
  EXPECT_EQ(scale.step, 1000U);
  EXPECT_TRUE(scale.split);
  expect_scale_holds(values);
}

TEST(AxisScale, ExtremesFit) {
  constexpr std::int32_t low = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t high = std::numeric_limits<std::int32_t>::max();
  expect_scale_holds({low, high});
  expect_scale_holds({low, high, 0, 1, -1});
  expect_scale_holds({high - 1, high});
  expect_scale_holds({low, low + 1});
  expect_scale_holds({high});
  std::mt19937 random(2);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::int32_t> values;
    const auto step = static_cast<std::int32_t>(1 + random() % 100000);
    for (int i = 0; i < 100; ++i) values.push_back(static_cast<std::int32_t>(random()) / step * step);
    expect_scale_holds(values);
  }
}

TEST(AxisScale, EvenRunsAreFound) {
  std::vector<std::int32_t> scratch;
  const std::vector<scansion::Run> runs{{0, 3, 0}, {3, 1, 0}, {4, 4, 2}};
  const std::vector<std::int32_t> even{100, 200, 300, 7000, 50, 0, -50, -100};
  AxisScale scale = find_scale(even, runs, scratch);
  EXPECT_TRUE(scale.even);
  EXPECT_EQ(scale.step, 50U);
  std::vector<std::int32_t> u(even.size());
  to_steps(even, scale, u);
  for (std::size_t i = 0; i < even.size(); ++i) EXPECT_EQ(scale.base + static_cast<std::int32_t>(scale.step) * u[i], even[i]);
  for (std::size_t i = 0; i < even.size(); ++i) {
    std::vector<std::int32_t> bent = even;
    ++bent[i];
    EXPECT_EQ(find_scale(bent, runs, scratch).even, i == 3) << i; // a single point is always even
  }
  // Steps that wrap around 32 bits are not even.
  constexpr std::int32_t low = std::numeric_limits<std::int32_t>::min();
  EXPECT_FALSE(
      find_scale(std::vector<std::int32_t>{0, 2000000000, low + 1705032704}, std::vector<scansion::Run>{{0, 3, 0}}, scratch)
          .even);
}

TEST(AxisScale, StepsAreTheSameAsByDivision) {
  std::mt19937 random(3);
  for (int round = 0; round < 300; ++round) {
    const auto step = static_cast<std::int32_t>(1 + random() % (round % 2 == 0 ? 1000 : 100000000));
    std::vector<std::int32_t> values;
    for (int i = 0; i < 50; ++i) values.push_back(static_cast<std::int32_t>(random()) / step * step + 17 % step);
    const AxisScale scale = find_scale(values);
    std::vector<std::int32_t> u(values.size());
    to_steps(values, scale, u);
    for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(u[i], scale.steps(values[i]));
  }
}

} // namespace
} // namespace scansion
