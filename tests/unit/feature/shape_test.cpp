// Classes of triplets and angles, and the triplets themselves.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/feature_point.hpp"
#include "pipeline/feature/lengthwise/vertices.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace scansion {
namespace {

TEST(Shape, EveryPairOfSlopesHasAClassOfItsPolarity) {
  for (int before = -89; before <= 89; before += 2) {
    for (int after = -89; after <= 89; after += 2) {
      const ShapeElement shape = classify(before, after);
      const std::string_view word = name(shape);
      if (std::abs(after - before) < 7) {
        EXPECT_EQ(shape, ShapeElement::straight) << before << ' ' << after;
      } else {
        EXPECT_NE(shape, ShapeElement::straight) << before << ' ' << after;
        EXPECT_TRUE(!word.ends_with("-convex") || after < before) << word;
        EXPECT_TRUE(!word.ends_with("-concave") || after > before) << word;
      }
    }
  }
}

TEST(Shape, NamesWhatTheTableNames) {
  EXPECT_EQ(classify(30, -30), ShapeElement::peak);
  EXPECT_EQ(classify(-30, 30), ShapeElement::pit);
  EXPECT_EQ(classify(0, -30), ShapeElement::shoulder_falling);
  EXPECT_EQ(classify(30, 0), ShapeElement::shoulder_levelling);
  EXPECT_EQ(classify(-30, 0), ShapeElement::foot_levelling);
  EXPECT_EQ(classify(0, 30), ShapeElement::foot_rising);
  EXPECT_EQ(classify(0, -80), ShapeElement::step_top);
  EXPECT_EQ(classify(80, 0), ShapeElement::step_top);
  EXPECT_EQ(classify(-80, 0), ShapeElement::step_bottom);
  EXPECT_EQ(classify(80, -80), ShapeElement::blade);
  EXPECT_EQ(classify(-80, 80), ShapeElement::slit);
  EXPECT_EQ(classify(20, 40), ShapeElement::slope_change_concave);
  EXPECT_EQ(classify(7.5, -7.5), ShapeElement::weak_bend_convex);
}

TEST(Shape, AngleClassesFollowInnerAngleAndOrientation) {
  EXPECT_EQ(angle_class(20), AngleClass::needle);
  EXPECT_EQ(angle_class(90), AngleClass::right);
  EXPECT_EQ(angle_class(170), AngleClass::flat);
  FeaturePoint peak;
  peak.theta_before = 45;
  peak.theta_after = -45;
  peak.tau = -90;
  EXPECT_DOUBLE_EQ(peak.inner_angle(), 90);
  EXPECT_DOUBLE_EQ(peak.orientation(), -90);
  EXPECT_EQ(leaning(peak.orientation()), Leaning::upright);
  EXPECT_EQ(leaning(-60), Leaning::leaning_right);
  EXPECT_EQ(leaning(170), Leaning::lying_left);
}

TEST(Vertices, NeighboursAreTheNearestRankedHalfAsHigh) {
  const double far = std::numeric_limits<double>::infinity();
  Profile p;
  p.ranked = {far, 0.01, 1.0, 0.3, 0.6, 0.05, 2.0, 0.9, far, far, 0.4, far};
  p.distance = p.ranked;
  p.s.resize(p.distance.size());
  p.ends = {9, 12};
  std::vector<std::uint32_t> stack;
  std::vector<Vertex> found;
  find_vertices(p, 0.04, stack, found);
  // Against the definition, point by point.
  std::size_t next = 0;
  for (std::uint32_t k = 0; k < p.distance.size(); ++k) {
    if (p.distance[k] < 0.04 || p.distance[k] == far) continue;
    ASSERT_LT(next, found.size());
    const Vertex& v = found[next++];
    EXPECT_EQ(v.k, k);
    std::uint32_t before = k - 1, after = k + 1;
    while (p.distance[before] < 0.5 * p.distance[k]) --before;
    while (p.distance[after] < 0.5 * p.distance[k]) ++after;
    EXPECT_EQ(v.before, before);
    EXPECT_EQ(v.after, after);
  }
  EXPECT_EQ(next, found.size());
}

} // namespace
} // namespace scansion
