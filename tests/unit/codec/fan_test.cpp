// Fans are found, come back, and are left alone where they are none.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/fan.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace scansion {
namespace {

struct Cloud {
  std::vector<std::int32_t> x, y;
};

// Beams over `degrees`, ranges in whole `step` counts, rounded to counts.
Cloud sweep(std::mt19937& random, std::size_t lines, std::size_t beams, double degrees, double step, double start) {
  Cloud out;
  for (std::size_t l = 0; l < lines; ++l)
    for (std::size_t b = 0; b < beams; ++b) {
      if (random() % 20 == 0) continue;
      const double angle = (start + degrees * static_cast<double>(b) / static_cast<double>(beams - 1)) * std::numbers::pi / 180;
      const double range = step * static_cast<double>(50 + random() % 3000);
      out.x.push_back(static_cast<std::int32_t>(std::llround(range * std::cos(angle))));
      out.y.push_back(static_cast<std::int32_t>(std::llround(range * std::sin(angle))));
    }
  return out;
}

void expect_fan(const Cloud& cloud, std::size_t beams) {
  FanFinder finder;
  Fan fan;
  finder.find(cloud.x, cloud.y, fan);
  ASSERT_EQ(fan.directions.size(), beams);
  std::size_t right = 0;
  for (std::size_t i = 0; i < cloud.x.size(); ++i)
    if (fan.coordinate(0, finder.directions[i], finder.ranges[i]) == cloud.x[i] &&
        fan.coordinate(1, finder.directions[i], finder.ranges[i]) == cloud.y[i])
      ++right;
  EXPECT_GT(static_cast<double>(right), 0.999 * static_cast<double>(cloud.x.size()));

  Bytes bytes;
  write_fan(fan, bytes);
  EXPECT_LT(bytes.size(), 8 * beams);
  Fan read;
  ByteReader from(bytes);
  ASSERT_TRUE(read_fan(from, cloud.x.size(), read));
  EXPECT_TRUE(from.at_end());
  EXPECT_EQ(read.directions, fan.directions);
  EXPECT_EQ(read.shift, fan.shift);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ByteReader cut(ByteView(bytes).first(size));
    EXPECT_FALSE(read_fan(cut, cloud.x.size(), read));
  }
}

TEST(Fan, IsFound) {
  std::mt19937 random(1);
  expect_fan(sweep(random, 64, 181, 180, 10000, -90), 181);
  expect_fan(sweep(random, 64, 1081, 270, 1000, -135), 1081);
  expect_fan(sweep(random, 20, 400, 359, 250, 0), 400); // a quarter turns over the end of the half-open circle
}

// So narrow that several directions share a bucket of angles.
TEST(Fan, IsFoundWhereDirectionsLieDense) {
  std::mt19937 random(3);
  expect_fan(sweep(random, 64, 400, 8, 10000, 10), 400);
}

TEST(Fan, IsNotFoundWhereThereIsNone) {
  std::mt19937 random(2);
  FanFinder finder;
  Fan fan;
  Cloud cloud;
  for (int i = 0; i < 20000; ++i) {
    cloud.x.push_back(static_cast<std::int32_t>(i % 1000 * 100));
    cloud.y.push_back(static_cast<std::int32_t>(random() % 3000));
  }
  finder.find(cloud.x, cloud.y, fan);
  EXPECT_TRUE(fan.empty());
  for (auto& v : cloud.x) v = static_cast<std::int32_t>(random());
  for (auto& v : cloud.y) v = static_cast<std::int32_t>(random());
  finder.find(cloud.x, cloud.y, fan);
  EXPECT_TRUE(fan.empty());
  std::ranges::fill(cloud.x, 0);
  std::ranges::fill(cloud.y, 0);
  finder.find(cloud.x, cloud.y, fan);
  EXPECT_TRUE(fan.empty());
}

TEST(Fan, ImpossibleOnesAreRefused) {
  const auto refused = [](Bytes bytes) {
    bytes.resize(bytes.size() + 40);
    ByteReader from(bytes);
    Fan fan;
    return !read_fan(from, 3, fan);
  };
  const auto b = [](int v) { return static_cast<std::byte>(v); };
  EXPECT_FALSE(refused({b(4), b(10), b(3), b(0)}));
  EXPECT_TRUE(refused({b(0), b(10), b(3), b(0)})); // one axis twice
  EXPECT_TRUE(refused({b(7), b(10), b(3), b(0)})); // a fourth axis
  EXPECT_TRUE(refused({b(4), b(31), b(3), b(0)})); // shift
  EXPECT_TRUE(refused({b(4), b(10), b(4), b(0)})); // more directions than points
  EXPECT_TRUE(refused({b(4), b(10), b(0), b(0)})); // none
}

} // namespace
} // namespace scansion
