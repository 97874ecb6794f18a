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

} // namespace
} // namespace scansion
