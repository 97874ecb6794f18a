// When a handful of points is enough.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/link/evidence.hpp"

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

Evidence asked(std::size_t points, double narrow, std::size_t steps = 0, double sharpness = 6.0) {
  FeaturePoint point;
  point.tau = -15.0;
  point.sharpness = sharpness;
  point.narrow_sharpness = narrow;
  Evidence evidence;
  for (std::size_t i = 0; i < points; ++i) evidence.add(point);
  point.step = true;
  for (std::size_t i = 0; i < steps; ++i) evidence.add(point);
  return evidence;
}

TEST(Evidence, TheNarrowestWindowsTellAnEdgeFromAnArc) {
  EXPECT_TRUE(asked(8, -0.3).is_arc());
  EXPECT_FALSE(asked(7, -0.3).is_arc()) << "too few to tell";
  EXPECT_FALSE(asked(8, 0.9).is_arc());
  EXPECT_FALSE(asked(8, -0.3, 9).is_arc()) << "most are edges of a step";
  EXPECT_FALSE(asked(8, 0.9).is_edge()) << "neither";
  EXPECT_TRUE(asked(5, 1.5).is_edge());
  EXPECT_FALSE(asked(5, 1.5, 0, 2.0).is_edge());
}

// A wave whose crests have a radius of 7 mm: over 4 mm a side it looks like a broken line.
TEST(Evidence, AWaveHasNoEdges) {
  const Surface wave = [](double x, double y) { return 0.285 * std::sin((x + 0.3 * y) * 0.714); };
  EXPECT_TRUE(Scan(wave, 50.0, 160).run(64).lines.empty());
  const Surface folds = [](double x, double y) { return 0.18 * std::asin(std::sin((x + 0.3 * y) * 0.714)); };
  EXPECT_GE(Scan(folds, 50.0, 160).run(64).lines.size(), 4U) << "sharp ones of about the same size";
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
