// When a handful of points is enough.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/evidence.hpp"

#include "tests/unit/feature/scan.hpp"

#include <gtest/gtest.h>

namespace scansion {
namespace {

Evidence of(std::size_t points, double turning, double sigma, std::uint32_t window, double sharpness = 6.0, bool step = false) {
  FeaturePoint point;
  point.tau = -turning;
  point.sigma_tau = sigma;
  point.window = window;
  point.sharpness = sharpness;
  point.step = step;
  Evidence evidence;
  for (std::size_t i = 0; i < points; ++i) evidence.add(point);
  return evidence;
}

TEST(Evidence, FewPointsSufficeWhereTheNoiseIsLow) {
  EXPECT_TRUE(of(5, 15.0, 1.0, 5).is_sure());
  EXPECT_FALSE(of(5, 15.0, 4.0, 5).is_sure()) << "noise may turn as much";
  EXPECT_FALSE(of(5, 15.0, 1.0, 5, 2.0).is_sure()) << "an arc is no corner";
  EXPECT_FALSE(of(5, 8.0, 0.1, 5).is_sure()) << "polygons of smooth surfaces turn as much";
}

TEST(Evidence, FourPointsMustBeTwiceAsSure) {
  EXPECT_FALSE(of(4, 15.0, 2.0, 5).is_sure());
  EXPECT_TRUE(of(4, 15.0, 1.0, 5).is_sure());
  EXPECT_FALSE(of(3, 60.0, 0.1, 5).is_sure());
}

// Over many samples a wide arc turns as significantly as a corner.
TEST(Evidence, WideWindowsSayLittle) {
  EXPECT_FALSE(of(8, 15.0, 0.5, 20).is_sure());
  EXPECT_TRUE(of(8, 15.0, 0.1, 20).is_sure());
}

TEST(Evidence, StepsAreNotSureByTheirNominalAngles) {
  EXPECT_FALSE(of(8, 80.0, 0.5, 3, 6.0, true).is_sure());
}

// A low hip roof of 1.2 x 2 mm: no edge but its foot is longer than 0.9 mm, and all turn by less than 20 degrees in most
// sections.
TEST(Evidence, ShortEdgesOfALowRoofAreFound) {
  const Surface roof = [](double x, double y) {
    const double inside = std::min(1.0 - std::abs(x - 10.0), 0.6 - std::abs(y - 4.0));
    return std::tan(18.0 / 57.29577951308232) * std::max(0.0, inside);
  };
  const FeatureReport report = Scan(roof, 2.0, 80).run(16);
  std::size_t convex = 0, concave = 0;
  for (const FeatureLine& line : report.lines) ++(line.type == FeatureType::convex ? convex : concave);
  EXPECT_GE(convex, 2U);
  EXPECT_GE(concave, 1U) << "the foot";
}

} // namespace
} // namespace scansion
