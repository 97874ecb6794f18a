// What counts as a feature can be set: small edges, low steps, wide roundings, short lines.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/join_pieces.hpp"
#include "tests/unit/feature/scan.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <numbers>

namespace scansion {
namespace {

constexpr double kNoise = 2.0; // um

double slope(double degrees) {
  return std::tan(degrees * std::numbers::pi / 180.0);
}

// Over one axis alone: falls by 0.2 mm at 2.5, turns by 10 degrees at 5, by 30 at 10.
double profile(double x) {
  const double on_ramp = x < 5.0 ? 0.0 : slope(10.0) * (std::min(x, 10.0) - 5.0);
  return on_ramp + (x < 10.0 ? 0.0 : slope(40.0) * (x - 10.0)) - (x < 2.5 ? 0.0 : 0.2);
}
// Turns by 5.5 degrees.
double faint(double x) {
  return slope(5.5) * std::max(0.0, x - 10.0);
}
// Turns by 40 degrees over an arc with a radius of 5 mm.
double arched(double x) {
  constexpr double kRadius = 5.0;
  const double end = kRadius * std::sin(40.0 * std::numbers::pi / 180.0), u = std::clamp(x - 8.0, 0.0, end);
  return kRadius - std::sqrt(kRadius * kRadius - u * u) + slope(40.0) * std::max(0.0, x - 8.0 - end);
}

// The directions of the edges: across the scan lines, and along them.
class FeatureLimitsTest : public testing::TestWithParam<bool> {
protected:
  [[nodiscard]] std::vector<FeatureLine> find(double (*height)(double), const FeatureLimits& limits) const {
    const bool along = GetParam();
    FeatureSettings settings;
    settings.limits = limits;
    Scan scan([=](double x, double y) { return height(along ? y : x); }, kNoise, 200);
    return join_pieces(scan.run(64, settings).lines);
  }
  /// mm of feature lines whose middle is near this place of the profile.
  [[nodiscard]] double length_at(const std::vector<FeatureLine>& lines, double place) const {
    double sum = 0.0;
    for (const FeatureLine& line : lines) {
      const FeatureVertex& middle = line.vertices[line.vertices.size() / 2];
      if (std::abs(middle.position[GetParam() ? 1 : 0] - place) < 0.6) sum += line.length_mm;
    }
    return sum;
  }
};

TEST_P(FeatureLimitsTest, EdgesThatTurnLessAreNone) {
  const auto all = find(profile, {});
  EXPECT_GT(length_at(all, 5.0), 15.0);
  EXPECT_GT(length_at(all, 10.0), 15.0);
  FeatureLimits limits;
  limits.least_turning = 20.0;
  const auto strong = find(profile, limits);
  EXPECT_EQ(length_at(strong, 5.0), 0.0);
  EXPECT_GT(length_at(strong, 10.0), 15.0);
  EXPECT_GT(length_at(strong, 2.5), 15.0);
}

TEST_P(FeatureLimitsTest, FainterEdgesAreFoundWhenAskedFor) {
  EXPECT_LT(length_at(find(faint, {}), 10.0), 3.0);
  FeatureLimits limits;
  limits.least_turning = 4.0;
  EXPECT_GT(length_at(find(faint, limits), 10.0), 15.0);
}

TEST_P(FeatureLimitsTest, LowerStepsAreNone) {
  const auto is_step = [](const FeatureLine& line) {
    return line.type == FeatureType::step_top || line.type == FeatureType::step_bottom;
  };
  EXPECT_GE(std::ranges::count_if(find(profile, {}), is_step), 2);
  FeatureLimits limits;
  limits.least_step = 0.4;
  EXPECT_EQ(std::ranges::count_if(find(profile, limits), is_step), 0);
}

TEST_P(FeatureLimitsTest, WideArcsAreEdgesWhenAskedFor) {
  EXPECT_LT(length_at(find(arched, {}), 9.8), 3.0);
  FeatureLimits limits;
  limits.largest_arc = 8.0;
  EXPECT_GT(length_at(find(arched, limits), 9.8), 12.0); // of 20
}

TEST_P(FeatureLimitsTest, ShortLinesAreNotToldOf) {
  FeatureLimits limits;
  limits.shortest_line = 30.0; // longer than any on 20 mm
  EXPECT_TRUE(find(profile, limits).empty());
  limits.shortest_line = 15.0;
  const auto lines = find(profile, limits);
  EXPECT_GE(lines.size(), 3U);
}

INSTANTIATE_TEST_SUITE_P(, FeatureLimitsTest, testing::Bool(),
                         [](const auto& test) { return test.param ? "AlongTheLines" : "AcrossTheLines"; });

} // namespace
} // namespace scansion
