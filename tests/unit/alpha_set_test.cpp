// The choice of an alpha-set, and its calibration.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/model/alpha_set.hpp"

#include "pipeline/pipeline.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace scansion {
namespace {

constexpr Rational kMicrometre{1, 1000};

TEST(LevelSpec, ReadsWhatItWrites) {
  for (const char* text : {"geometric:3:3", "geometric:5:2.5", "uniform:4", "uniform:4:1.5", "explicit:1,0.1,0.01"})
    EXPECT_EQ(to_string(parse_level_spec(text).value()), text);
  EXPECT_EQ(parse_level_spec("geometric:3").value(), LevelSpec{});
}

TEST(Floor, ReadsWhatItWrites) {
  for (const char* text : {"off", "half", "0.0125"}) EXPECT_EQ(to_string(parse_floor(text).value()), text);
  EXPECT_EQ(parse_floor("half").value().in_counts({5, 1000}), 0.5);
  EXPECT_EQ(parse_floor("0.0125").value().in_counts({5, 1000}), 2.5);
  for (const char* text : {"", "0", "-1", "nan", "1e10", "halves", "0.5 "}) EXPECT_FALSE(parse_floor(text)) << text;
}

TEST(LevelSpec, RefusesNonsense) {
  for (const char* text :
       {"", "geometric", "geometric:0", "geometric:17", "geometric:3:1", "geometric:3:x", "uniform:-1", "uniform:2:0",
        "explicit:", "explicit:1,2", "explicit:1,1", "explicit:0", "explicit:nan", "cubic:3", "geometric:3:2:1"})
    EXPECT_FALSE(parse_level_spec(text)) << text;
}

TEST(AlphaSet, WidthIsTheFirstLevelThatHoldsThePoint) {
  const AlphaSet alpha{.tolerances = {1.0, 0.1}, .epoch = 0};
  EXPECT_EQ(alpha.width(std::numeric_limits<double>::infinity()), 0U);
  EXPECT_EQ(alpha.width(1.5), 0U);
  EXPECT_EQ(alpha.width(1.0), 1U); // S_0 = {D > 1}
  EXPECT_EQ(alpha.width(0.1), 2U);
  EXPECT_EQ(alpha.width(0.0), 2U);
}

// A group of lines with gaussian noise of `sigma` counts on a sine of `height` counts.
LineGroup noisy_group(std::mt19937& random, double sigma, double height) {
  std::normal_distribution<double> noise(0.0, sigma);
  LineGroup group;
  for (std::uint64_t l = 0; l < 16; ++l) {
    LineBuffer line;
    line.runs.push_back({0, 1000, 0});
    for (int i = 0; i < 1000; ++i) {
      line.xyz[0].push_back(i * 100);
      line.xyz[1].push_back(static_cast<std::int32_t>(l) * 200);
      line.xyz[2].push_back(static_cast<std::int32_t>(std::lround(height * std::sin(i * 0.02) + noise(random))));
    }
    append_line(group, l, line);
  }
  return group;
}

TEST(Calibrator, FinestGeometricLevelIsAboveTheNoise) {
  std::mt19937 random(1);
  Ranker ranker(kMicrometre);
  GroupRanks ranks;
  for (const double sigma : {5.0, 20.0}) {
    Calibrator calibrator(LevelSpec{});
    const LineGroup group = noisy_group(random, sigma, 0);
    rank_group(ranker, group, ranks);
    const AlphaSet& alpha = calibrator.next(group, ranks, kMicrometre);
    ASSERT_EQ(alpha.tolerances.size(), 3U);
    EXPECT_NEAR(alpha.tolerances[2], 5.5 * sigma / 1000, 0.5 * sigma / 1000);
    EXPECT_NEAR(alpha.tolerances[0] / alpha.tolerances[1], 3.0, 1e-9);
  }
}

TEST(Calibrator, AChangeOfTheScanStartsAnEpochAndNoiseAloneDoesNot) {
  std::mt19937 random(2);
  Ranker ranker(kMicrometre);
  GroupRanks ranks;
  Calibrator calibrator(LevelSpec{});
  const auto next = [&](double sigma, double height) -> const AlphaSet& {
    const LineGroup group = noisy_group(random, sigma, height);
    rank_group(ranker, group, ranks);
    return calibrator.next(group, ranks, kMicrometre);
  };
  for (int g = 0; g < 10; ++g) EXPECT_EQ(next(5, 0).epoch, 0U); // a noisy plane: the share alone would recalibrate each time
  const double before = next(5, 0).tolerances.back();
  EXPECT_EQ(next(100, 3000).epoch, 1U);
  EXPECT_GT(next(100, 3000).tolerances.back(), 5 * before);
}

TEST(Calibrator, UniformFollowsTheLargestDistance) {
  std::mt19937 random(3);
  Ranker ranker(kMicrometre);
  GroupRanks ranks;
  Calibrator calibrator(parse_level_spec("uniform:4").value());
  const auto largest = [&] {
    double d = 0;
    for (const double x : ranks.distance)
      if (std::isfinite(x)) d = std::max(d, x);
    return d;
  };
  const LineGroup small = noisy_group(random, 1, 1000);
  rank_group(ranker, small, ranks);
  const AlphaSet first = calibrator.next(small, ranks, kMicrometre);
  EXPECT_EQ(first.tolerances.front(), largest());
  EXPECT_NEAR(first.tolerances[3] * 4, first.tolerances[0], 1e-12);
  const LineGroup tall = noisy_group(random, 1, 5000);
  rank_group(ranker, tall, ranks);
  const AlphaSet second = calibrator.next(tall, ranks, kMicrometre);
  EXPECT_EQ(second.epoch, 1U);
  EXPECT_EQ(second.tolerances.front(), largest());
}

} // namespace
} // namespace scansion
