// What is said about feature lines that go out: vertices, ends, junctions, partners.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/join_pieces.hpp"
#include "pipeline/feature/line/thinning.hpp"
#include "tests/unit/feature/scan.hpp"

#include <algorithm>
#include <gtest/gtest.h>

namespace scansion {
namespace {

double roof(double x, double) {
  return -0.5 * std::abs(x - 10.0);
}
/// A second roof runs into the side of the first.
double gable(double x, double y) {
  return x > 10.0 ? std::max(roof(x, y), -0.5 * std::abs(y - 9.0)) : roof(x, y);
}
double pocket(double x, double y) {
  return x > 5.0 && x < 14.0 && y > 6.0 && y < 13.0 ? -1.0 : 0.0;
}
double step(double x, double y) {
  return x + 0.3 * y < 12.0 ? 0.0 : 1.0;
}

std::vector<FeatureLine> lines_of(double (*surface)(double, double), std::uint32_t lines, double least_mm) {
  std::vector<FeatureLine> found = join_pieces(Scan(surface, 5.0, lines).run(64).lines);
  std::erase_if(found, [&](const FeatureLine& line) { return line.length_mm < least_mm; });
  return found;
}

TEST(PublishedLine, KeepsTheVerticesThatMatter) {
  const auto lines = lines_of(roof, 120, 5.0);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_LT(lines[0].vertices.size(), 40U);
  EXPECT_GE(lines[0].per_mm, 1000U);
  for (const FeatureVertex& v : lines[0].vertices)
    for (const double x : v.position) EXPECT_DOUBLE_EQ(x, std::nearbyint(x * lines[0].per_mm) / lines[0].per_mm);
  EXPECT_EQ(lines[0].begins, FeatureEnd::border);
  EXPECT_EQ(lines[0].ends, FeatureEnd::open);
}

TEST(PublishedLine, EdgesOfAStepArePartners) {
  const auto lines = lines_of(step, 120, 8.0);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].partner, std::optional(lines[1].id));
  EXPECT_EQ(lines[1].partner, std::optional(lines[0].id));
}

TEST(PublishedLine, AClosedEdgeEndsInItself) {
  const auto lines = lines_of(pocket, 180, 20.0);
  ASSERT_EQ(lines.size(), 2U);
  for (const FeatureLine& line : lines) {
    EXPECT_TRUE(line.closed_loop);
    EXPECT_EQ(line.begins, FeatureEnd::cap);
    EXPECT_EQ(line.ends, FeatureEnd::cap);
    EXPECT_TRUE(line.partner);
  }
}

TEST(PublishedLine, SaysWhereItRunsIntoAnother) {
  auto lines = lines_of(gable, 180, 4.0);
  std::erase_if(lines, [](const FeatureLine& line) { return line.turning.mean > 0.0; }); // the valleys between the roofs
  ASSERT_EQ(lines.size(), 2U);
  const bool main_first = lines[0].length_mm > lines[1].length_mm;
  const FeatureLine &ridge = lines[main_first ? 0 : 1], &second = lines[main_first ? 1 : 0];
  EXPECT_NE(std::find(second.junctions.begin(), second.junctions.end(), ridge.id), second.junctions.end());
  EXPECT_EQ(ridge.junctions, std::vector{second.id});
  EXPECT_TRUE(second.begins == FeatureEnd::junction || second.ends == FeatureEnd::junction);
  EXPECT_NE(ridge.begins, FeatureEnd::junction);
}

TEST(Thinner, StaysWithinItsTolerance) {
  Thinner thinner;
  std::vector<FeatureVertex> arc;
  for (std::uint32_t k = 0; k <= 500; ++k) {
    const double angle = 0.006 * k;
    arc.push_back({{10.0 * std::cos(angle), 10.0 * std::sin(angle), -3.0}, k, 2 * k});
  }
  std::vector<FeatureVertex> thin = arc;
  EXPECT_EQ(thinner.thin(thin, 0.02), 1000U);
  EXPECT_GT(thin.size(), 20U); // a chord of 2 acos(1 - 0.02 / 10) is 0.126
  EXPECT_LT(thin.size(), 60U);
  EXPECT_EQ(thin.front().line, 0U);
  EXPECT_EQ(thin.back().index, 1000U);
  for (const FeatureVertex& v : thin) EXPECT_NEAR(std::hypot(v.position[0], v.position[1]), 10.0, 0.001);
}

TEST(Thinner, OddLinesAreNoTrouble) {
  Thinner thinner;
  std::vector<FeatureVertex> none, one(1), far(3);
  EXPECT_EQ(thinner.thin(none, 0.1), 1U);
  EXPECT_GE(thinner.thin(one, 0.1), 1U);
  far[1].position = {1e12, -1e12, 0.0};
  EXPECT_EQ(thinner.thin(far, 1e-9), 1U);
  EXPECT_EQ(far.size(), 3U);
}

} // namespace
} // namespace scansion
