// The feature stage from ranked groups to feature lines and patches.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/feature/scan.hpp"

#include <array>
#include <gtest/gtest.h>
#include <map>
#include <set>

namespace scansion {
namespace {

double roof(double x, double) {
  return -0.5 * std::abs(x - 10.0);
}
double step(double x, double y) {
  return x + 0.3 * y < 12.0 ? 0.0 : 1.0;
}
double pocket(double x, double y) {
  return x > 5.0 && x < 14.0 && y > 6.0 && y < 13.0 ? -1.0 : 0.0;
}

TEST(FeatureStage, FindsARidgeWhereItIs) {
  const FeatureReport report = Scan(roof, 5.0, 120).run(64);
  ASSERT_EQ(report.lines.size(), 1U);
  const FeatureLine& line = report.lines[0];
  EXPECT_EQ(line.type, FeatureType::convex);
  EXPECT_NEAR(line.turning.mean, -2.0 * std::atan(0.5) * 57.29578, 2.0);
  EXPECT_GT(line.length_mm, 11.0);
  for (const FeatureVertex& v : line.vertices) {
    EXPECT_NEAR(v.position[0], 10.0, 0.1);
    EXPECT_NEAR(v.position[2], 0.0, 0.05);
    EXPECT_NEAR(v.position[1], 0.1 * static_cast<double>(v.line), 1e-9);
    EXPECT_NEAR(0.1 * v.index, v.position[0], 0.25);
  }
}

TEST(FeatureStage, AStepHasBothEdgesAndPartsTwoPatches) {
  const FeatureReport report = Scan(step, 5.0, 120).run(64);
  std::multiset<FeatureType> types;
  for (const FeatureLine& line : report.lines)
    if (line.length_mm > 10.0) types.insert(line.type);
  EXPECT_EQ(types, (std::multiset<FeatureType>{FeatureType::step_top, FeatureType::step_bottom}));
  std::set<std::uint32_t> gone;
  for (const PatchMerge& merge : report.merges) gone.insert(merge.from);
  std::uint64_t samples = 0;
  std::size_t patches = 0;
  for (const Patch& patch : report.patches) {
    if (gone.contains(patch.id)) continue;
    ++patches;
    samples += patch.samples;
    EXPECT_EQ(patch.shape, PatchShape::plane);
    EXPECT_NEAR(patch.normal[2], 1.0, 1e-3);
  }
  EXPECT_EQ(patches, 2U);
  EXPECT_EQ(samples, 120U * 200U);
}

TEST(FeatureStage, EverySampleBelongsToOnePatch) {
  const FeatureReport report = Scan(pocket, 5.0, 180).run(64);
  std::vector<int> seen(std::size_t{180} * 200, 0);
  for (const PatchRun& run : report.runs)
    for (std::uint32_t k = run.first; k < run.first + run.count; ++k) ++seen[run.line * 200 + k];
  for (const int times : seen) ASSERT_EQ(times, 1);
  const auto named =
      std::count_if(report.forms.begin(), report.forms.end(), [](const Form& form) { return form.kind == FormKind::pocket; });
  EXPECT_EQ(named, 1);
}

TEST(FeatureStage, FindsEdgesAlongTheLinesToo) {
  const FeatureReport report = Scan(pocket, 5.0, 180).run(64);
  double along = 0.0, total = 0.0;
  for (const FeatureLine& line : report.lines) {
    for (std::size_t i = 1; i < line.vertices.size(); ++i) {
      const auto &a = line.vertices[i - 1].position, &b = line.vertices[i].position;
      const double dx = std::abs(b[0] - a[0]), dy = std::abs(b[1] - a[1]);
      (dx > dy ? along : total) += std::hypot(dx, dy);
    }
  }
  EXPECT_NEAR(along, 2.0 * 18.0, 4.0); // two edges of 9 mm, each with top and bottom
  EXPECT_NEAR(total, 2.0 * 14.0, 4.0);
}

// Under noise a bend of 17 degrees shows over wide windows only, and rows give its points in no order of columns: what comes
// late takes its place between its neighbours. Found in pieces, or in half of the columns, it would not be published.
TEST(FeatureStage, FindsWeakEdgesThatRunAslantAlongTheLines) {
  const Surface kink = [](double x, double y) { return 0.3 * std::max(0.0, y - 6.0 - 0.25 * x); };
  for (const double noise : {5.0, 20.0}) {
    const FeatureReport report = Scan(kink, noise, 180).run(16);
    double length = 0.0;
    for (const FeatureLine& line : report.lines) {
      EXPECT_EQ(line.type, FeatureType::concave);
      for (const FeatureVertex& v : line.vertices) EXPECT_NEAR(v.position[1], 6.0 + 0.25 * v.position[0], 0.3);
      length = std::max(length, line.length_mm);
    }
    EXPECT_GT(length, 0.9 * 20.6) << noise; // mm: of one line, of 20.6 in all
    EXPECT_LE(report.lines.size(), 2U) << noise;
  }
}

// Beside the border of a scan nothing is found; what runs out over it parts what lies on its sides all the same, along the scan
// lines and across them.
TEST(FeatureStage, EdgesPartPatchesUpToTheBorder) {
  const Surface flat = [](double x, double y) { return 0.5 * std::max(0.0, y - 0.2 * (x - 6.0)); };
  const Surface steep = [](double x, double y) { return 0.5 * std::max(0.0, x - 0.5 * (y - 3.0)); };
  struct Case {
    Surface surface;
    std::array<std::uint32_t, 2> a, b; // line and sample on either side
  };
  for (const Case& one : {Case{flat, {0, 20}, {0, 150}}, Case{steep, {0, 0}, {100, 0}}}) {
    const FeatureReport report = Scan(one.surface, 5.0, 120).run(16);
    std::map<std::uint32_t, std::uint32_t> into;
    for (const PatchMerge& merge : report.merges) into[merge.from] = merge.into;
    const auto patch = [&](const std::array<std::uint32_t, 2>& at) {
      std::uint32_t found = 0;
      for (const PatchRun& run : report.runs)
        if (run.line == at[0] && run.first <= at[1] && at[1] < run.first + run.count) found = run.patch;
      for (auto next = into.find(found); next != into.end(); next = into.find(found)) found = next->second;
      return found;
    };
    EXPECT_NE(patch(one.a), patch(one.b));
  }
}

TEST(FeatureStage, GroupsDoNotChangeWhatIsFound) {
  Scan scan(pocket, 20.0, 150);
  FeatureReport whole = scan.run(64);
  for (const std::uint32_t per_group : {1U, 7U, 150U}) {
    const FeatureReport parts = Scan(pocket, 20.0, 150).run(per_group);
    EXPECT_EQ(parts.lines, whole.lines) << per_group;
    EXPECT_EQ(parts.runs, whole.runs) << per_group;
    EXPECT_EQ(parts.merges, whole.merges) << per_group;
    EXPECT_EQ(parts.patches, whole.patches) << per_group;
    EXPECT_EQ(parts.forms, whole.forms) << per_group;
  }
}

TEST(FeatureStage, LinesScannedBackwardsAreTurnedRound) {
  const FeatureReport forth = Scan(roof, 0.0, 100).run(64), zigzag = Scan(roof, 0.0, 100).run(64, {}, true);
  ASSERT_EQ(forth.lines.size(), zigzag.lines.size());
  for (std::size_t i = 0; i < forth.lines.size(); ++i) EXPECT_NEAR(forth.lines[i].length_mm, zigzag.lines[i].length_mm, 0.2);
}

TEST(FeatureStage, APlaneHasNoFeatures) {
  const FeatureReport report = Scan([](double x, double y) { return 0.1 * x - 0.05 * y; }, 20.0, 200).run(64);
  EXPECT_TRUE(report.lines.empty());
}

TEST(FeatureStage, ThePapersRulesCanBeAskedFor) {
  FeatureSettings paper;
  paper.linking = Linking::paper;
  const auto ring = [](double x, double y) { return 0.8 * std::max(0.0, 6.0 - std::hypot(x - 10.0, y - 9.0)); };
  const auto longest = [](const FeatureReport& report) {
    double most = 0.0;
    for (const FeatureLine& line : report.lines) most = std::max(most, line.length_mm);
    return most;
  };
  const double by_paper = longest(Scan(ring, 20.0, 180).run(64, paper));
  EXPECT_GT(by_paper, 1.0);
  EXPECT_NE(Scan(ring, 20.0, 180).run(64, paper).lines, Scan(ring, 20.0, 180).run(64).lines);
}

TEST(FeatureStage, OddLinesAreNoTrouble) {
  Lattice lattice;
  lattice.resolution = Rational{1, 1000};
  FeatureStage stage(lattice, {});
  FeatureReport report;
  LineGroup group;
  stage.add(group, {}, report);
  std::mt19937 random(3);
  Ranker ranker(Rational{1, 1000});
  GroupRanks ranks;
  GroupBuilder builder;
  for (int i = 0; i < 400; ++i) {
    LineBuffer line;
    const auto below = [&](std::uint32_t limit) { return static_cast<std::uint32_t>(random() % limit); };
    const std::uint32_t runs = below(3);
    for (std::uint32_t r = 0; r < runs; ++r) {
      const scansion::Run run{static_cast<std::uint32_t>(line.points()), 1 + below(40), below(4)};
      for (std::uint32_t k = 0; k < run.count; ++k)
        for (auto& axis : line.xyz)
          axis.push_back(below(5) == 0 ? static_cast<std::int32_t>(random()) : static_cast<std::int32_t>(below(9)));
      line.runs.push_back(run);
    }
    if (builder.must_close_before(line)) {
      builder.take(group);
      rank_group(ranker, group, ranks);
      stage.add(group, ranks.distance, report);
    }
    builder.add(line);
  }
  stage.finish(report);
  SUCCEED();
}

} // namespace
} // namespace scansion
