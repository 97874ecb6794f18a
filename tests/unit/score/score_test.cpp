// The feature scorer on lines whose score is known beforehand: the truth itself, and the truth spoilt in one way at a time.
// SPDX-License-Identifier: Apache-2.0
#include "tests/score/score.hpp"

#include "tests/score/found_file.hpp"

#include <gtest/gtest.h>

namespace scansion::score {
namespace {

std::vector<std::array<double, 3>> straight(double x, double y0, double y1, double z = 0.0) {
  std::vector<std::array<double, 3>> points;
  for (int k = 0; k <= 100; ++k) points.push_back({x, y0 + (y1 - y0) * k / 100.0, z});
  return points;
}

TrueCurve curve(FeatureType type, std::vector<std::array<double, 3>> points) {
  TrueCurve made;
  made.type = type;
  made.points = std::move(points);
  return made;
}

/// Two creases of 20 mm, 5 mm apart, scanned every 0.2 mm along x: both cross the scan lines at a right angle.
Truth two_creases() {
  Truth truth;
  truth.pitch_mm = 0.2;
  truth.spacing_mm = 0.2;
  truth.noise_um = 5.0;
  truth.curves = {curve(FeatureType::convex, straight(5.0, 0.0, 20.0)), curve(FeatureType::concave, straight(10.0, 0.0, 20.0))};
  return truth;
}

Found the_truth(const Truth& truth) {
  Found found;
  for (const TrueCurve& c : truth.curves) found.lines.push_back({c.type, c.points});
  return found;
}

TEST(Score, TheTruthIsPerfect) {
  const Truth truth = two_creases();
  const Score score = judge(truth, the_truth(truth));
  EXPECT_NEAR(score.true_mm, 40.0, 0.2);
  EXPECT_DOUBLE_EQ(score.f1, 1.0);
  EXPECT_DOUBLE_EQ(score.precision, 1.0);
  EXPECT_DOUBLE_EQ(score.polarity_recall, 1.0);
  EXPECT_NEAR(score.position_mean, 0.0, 1e-9);
  EXPECT_DOUBLE_EQ(score.longest, 1.0);
  EXPECT_DOUBLE_EQ(score.fragments, 1.0);
  EXPECT_DOUBLE_EQ(score.false_mm, 0.0);
  EXPECT_NEAR(score.angle_found_mm[4], 40.0, 0.2);
}

TEST(Score, NothingFoundIsNoRecall) {
  const Score score = judge(two_creases(), {});
  EXPECT_DOUBLE_EQ(score.recall, 0.0);
  EXPECT_DOUBLE_EQ(score.f1, 0.0);
  EXPECT_DOUBLE_EQ(score.longest, 0.0);
}

TEST(Score, ShiftedLinesLosePositionThenEverything) {
  const Truth truth = two_creases();
  Found found = the_truth(truth);
  for (FoundLine& line : found.lines) {
    for (auto& p : line.points) p[0] += 0.1;
  }
  Score score = judge(truth, found);
  EXPECT_DOUBLE_EQ(score.f1, 1.0);
  EXPECT_NEAR(score.position_mean, 0.5, 1e-3); // 0.1 mm in units of 0.2
  for (FoundLine& line : found.lines) {
    for (auto& p : line.points) p[0] += 0.25; // 0.35 mm: outside 1.5 * 0.2
  }
  score = judge(truth, found);
  EXPECT_DOUBLE_EQ(score.recall, 0.0);
  EXPECT_DOUBLE_EQ(score.strict_precision, 0.0);
  EXPECT_NEAR(score.false_mm, 40.0, 0.2);
}

TEST(Score, ADoubledLineIsRightOnce) {
  const Truth truth = two_creases();
  Found found = the_truth(truth);
  found.lines.push_back({FeatureType::convex, straight(5.1, 0.0, 20.0)});
  const Score score = judge(truth, found);
  EXPECT_DOUBLE_EQ(score.precision, 1.0);
  EXPECT_NEAR(score.strict_precision, 2.0 / 3.0, 0.02);
  EXPECT_DOUBLE_EQ(score.recall, 1.0);
}

TEST(Score, WrongPolarityCountsForPlaceOnly) {
  const Truth truth = two_creases();
  Found found = the_truth(truth);
  found.lines[0].type = FeatureType::valley;
  const Score score = judge(truth, found);
  EXPECT_DOUBLE_EQ(score.recall, 1.0);
  EXPECT_DOUBLE_EQ(score.strict_precision, 1.0);
  EXPECT_NEAR(score.polarity_recall, 0.5, 0.01);
}

TEST(Score, CutLinesLoseLengthAndPieces) {
  const Truth truth = two_creases();
  Found found;
  found.lines = {{FeatureType::convex, straight(5.0, 0.0, 8.0)},
                 {FeatureType::convex, straight(5.0, 12.0, 20.0)},
                 {FeatureType::concave, straight(10.0, 0.0, 20.0)}};
  const Score score = judge(truth, found);
  EXPECT_NEAR(score.recall, 0.9 + 2.0 * 0.3 / 40.0, 0.01); // the ends of the cut are within the tolerance
  EXPECT_NEAR(score.longest, 0.5 * (0.4 + 0.3 / 20.0 + 1.0), 0.01);
  EXPECT_DOUBLE_EQ(score.fragments, 1.5);
  EXPECT_DOUBLE_EQ(score.strict_precision, 1.0);
}

TEST(Score, TopAndBottomOfAStepAreTwoCurves) {
  Truth truth = two_creases();
  truth.curves = {curve(FeatureType::step_top, straight(5.0, 0.0, 20.0, 0.2)),
                  curve(FeatureType::step_bottom, straight(5.0, 0.0, 20.0))};
  for (TrueCurve& c : truth.curves) c.wall_mm = 0.2;
  EXPECT_DOUBLE_EQ(judge(truth, the_truth(truth)).strict_precision, 1.0);
  EXPECT_NEAR(judge(truth, the_truth(truth)).position_mean, 0.0, 1e-9);
}

TEST(Score, OptionalCurvesAndLowStepsCountForNothing) {
  Truth truth = two_creases();
  truth.curves[0].optional = true;
  truth.curves[1].wall_mm = 0.05;
  truth.curves[1].type = FeatureType::step_bottom;
  const Score score = judge(truth, the_truth(truth));
  EXPECT_DOUBLE_EQ(score.true_mm, 0.0);
  EXPECT_DOUBLE_EQ(score.strict_precision, 1.0);
  EXPECT_DOUBLE_EQ(score.false_mm, 0.0);
}

TEST(Score, AnglesAreTakenFromTheScanDirection) {
  Truth truth = two_creases();
  truth.direction_deg = 80.0;
  const Score score = judge(truth, {});
  EXPECT_NEAR(score.angle_mm[0], 40.0, 0.2);
  EXPECT_DOUBLE_EQ(score.angle_found_mm[0], 0.0);
}

TEST(Score, ClosedCurvesAreWholeLoops) {
  Truth truth = two_creases();
  truth.curves = {curve(FeatureType::convex, {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {0, 10, 0}})};
  truth.curves[0].closed = true;
  EXPECT_NEAR(judge(truth, {}).true_mm, 40.0, 0.2);
}

TEST(RandIndex, KnownValues) {
  EXPECT_DOUBLE_EQ(adjusted_rand_index({1, 1, 2, 2}, {7, 7, 3, 3}), 1.0);
  EXPECT_DOUBLE_EQ(adjusted_rand_index({1, 1, 1, 1}, {2, 2, 2, 2}), 1.0);
  EXPECT_DOUBLE_EQ(adjusted_rand_index({1, 1, 2, 2}, {1, 2, 1, 2}), -0.5);
  EXPECT_NEAR(adjusted_rand_index({0, 0, 1, 1}, {0, 0, 1, 2}), 0.571428571, 1e-9);
}

TEST(Score, PatchesAndForms) {
  Truth truth = two_creases();
  truth.patches = {{FormKind::face, 6}, {FormKind::slot, 4}};
  truth.forms = {{FormKind::slot, 0, {1}}};
  truth.lines = {{{3, 0}, {2, 1}}, {{3, 0}, {2, 1}}};
  Found found;
  found.patches = {{9, 9, 9, 4, 4}, {9, 9, 9, 4, 4}};
  found.forms = {{FormKind::slot, {4}, 1.0}};
  Score score = judge(truth, found);
  EXPECT_DOUBLE_EQ(score.rand_index, 1.0);
  const auto slots = [&] { return score.forms[static_cast<std::size_t>(FormKind::slot)]; };
  EXPECT_EQ(slots().there, 1U);
  EXPECT_EQ(slots().named, 1U);
  EXPECT_EQ(slots().right, 1U);
  found.forms[0].kind = FormKind::pocket;
  found.patches[1] = {9, 9};
  score = judge(truth, found);
  EXPECT_LT(score.rand_index, 1.0);
  EXPECT_EQ(slots().named, 0U);
  EXPECT_EQ(score.forms[static_cast<std::size_t>(FormKind::pocket)].said, 1U);
  EXPECT_EQ(score.forms[static_cast<std::size_t>(FormKind::pocket)].right, 0U);
}

TEST(Score, AFormSaidInPiecesIsNamedOnce) {
  Truth truth = two_creases();
  truth.patches = {{FormKind::face, 6}, {FormKind::slot, 4}};
  truth.forms = {{FormKind::slot, 0, {1}}};
  truth.lines = {{{3, 0}, {2, 1}}};
  Found found;
  found.patches = {{9, 9, 9, 4, 4}};
  found.forms = {{FormKind::slot, {4}, 1.0}, {FormKind::slot, {4}, 1.0}};
  const FormCount all = sum_of(judge(truth, found).forms);
  EXPECT_EQ(all.said, 2U);
  EXPECT_EQ(all.right, 2U);
  EXPECT_EQ(all.there, 1U);
  EXPECT_EQ(all.named, 1U);
}

TEST(Score, AStepNeedsBothItsLevels) {
  Truth truth = two_creases();
  truth.patches = {{FormKind::face, 6}, {FormKind::face, 4}};
  truth.forms = {{FormKind::step, 0, {0, 1}}};
  truth.lines = {{{3, 0}, {2, 1}}};
  Found found;
  found.patches = {{9, 9, 9, 4, 4}};
  found.forms = {{FormKind::step, {9}, 1.0}};
  EXPECT_EQ(sum_of(judge(truth, found).forms).named, 0U);
  found.forms = {{FormKind::step, {4, 9}, 1.0}};
  EXPECT_EQ(sum_of(judge(truth, found).forms).named, 1U);
}

TEST(Score, AFormOnAPatchThatHoldsEverythingIsNotNamed) {
  Truth truth = two_creases();
  truth.patches = {{FormKind::face, 6}, {FormKind::slot, 4}};
  truth.forms = {{FormKind::slot, 0, {1}}};
  truth.lines = {{{3, 0}, {2, 1}}};
  Found found;
  found.patches = {{9, 9, 9, 9, 9}};
  found.forms = {{FormKind::slot, {9}, 1.0}};
  EXPECT_EQ(sum_of(judge(truth, found).forms).named, 0U);
}

TEST(Score, AHoleIsNamedInItsPlaceAndSize) {
  Truth truth = two_creases();
  truth.pitch_mm = truth.spacing_mm = 0.1;
  truth.patches = {{FormKind::face, 10}};
  truth.forms = {{FormKind::hole, 0, {0}, TrueHole{{5.0, 5.0, 1.0}, 3.1416}}};
  truth.lines = {{{5, 0}}};
  Found found;
  found.patches = {{9, 9, 9, 9, 9}};
  found.forms = {{FormKind::hole, {9}, 1.0, HoleSize{{5.1, 5.0, 1.0}, 2.0, 2.0, 3.3, 7}}};
  EXPECT_EQ(sum_of(judge(truth, found).forms).named, 1U);
  EXPECT_EQ(sum_of(judge(truth, found).forms).right, 1U);
  found.forms[0].hole->middle[0] = 5.2;
  EXPECT_EQ(sum_of(judge(truth, found).forms).named, 0U);
  found.forms[0].hole->middle[0] = 5.0;
  found.forms[0].hole->area_mm2 = 4.2;
  EXPECT_EQ(sum_of(judge(truth, found).forms).right, 0U);
}

TEST(FoundFile, ReadsTheTextForms) {
  const auto lines = parse_lines_text("# id=3 type=step-top level=1 state=closed length=2\n1 2 3 4 5\n1 3 3 5 5\n\n"
                                      "# id=4 type=concave level=0 state=open length=0\n-1.5 0 2e-1 0 0\n");
  ASSERT_TRUE(lines) << lines.error().context;
  ASSERT_EQ(lines.value().size(), 2U);
  EXPECT_EQ(lines.value()[0].type, FeatureType::step_top);
  EXPECT_EQ(lines.value()[0].points.size(), 2U);
  EXPECT_EQ(lines.value()[1].points[0], (std::array{-1.5, 0.0, 0.2}));
  EXPECT_FALSE(parse_lines_text("# id=3 type=crack\n"));
  EXPECT_FALSE(parse_lines_text("1 2 3\n"));
  EXPECT_FALSE(parse_lines_text("# id=3 type=ridge\n1 2\n"));
  Truth truth;
  truth.lines = {{{2, 0}}, {{1, 0}}};
  const auto patches = parse_patches_text("0 0 0 7\n1 0 0 7\n\n0 1 0 -1\n", truth);
  ASSERT_TRUE(patches);
  EXPECT_EQ(patches.value(), (std::vector<std::vector<std::uint32_t>>{{7, 7}, {kNoPatch}}));
  EXPECT_FALSE(parse_patches_text("0 0 0 7\n0 0 0 7\n0 0 0 7\n0 0 0 7\n", truth));
}

} // namespace
} // namespace scansion::score
