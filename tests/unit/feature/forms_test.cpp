// Form features of small parts whose forms are known, whole and in the ways that scans spoil them.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/feature/scan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace scansion {
namespace {

struct Faults {
  double noise_um = 5.0;
  double missing = 0.0; ///< share of the points
};

/// A part of 24 by 20 mm.
FeatureReport scan(const Surface& surface, const Faults& faults = {}) {
  return Scan(surface, faults.noise_um, 200, 240).seed(11).lose(faults.missing).run(64);
}

std::map<FormKind, int> kinds_in(const FeatureReport& report) {
  std::map<FormKind, int> counts;
  for (const Form& form : report.forms) ++counts[form.kind];
  return counts;
}
using Kinds = std::map<FormKind, int>;

/// Distance to a box about (12, 10) with half sides a and b, below 0 inside.
double box(double x, double y, double a, double b) {
  return std::max(std::abs(x - 12.0) - a, std::abs(y - 10.0) - b);
}
/// A wall from `height` inside to 0 outside, `draft` mm wide.
double wall(double d, double height, double draft) {
  return height * std::clamp(-d / draft, 0.0, 1.0);
}

TEST(Forms, PocketAndBossWithUprightWalls) {
  EXPECT_EQ(kinds_in(scan([](double x, double y) { return box(x, y, 5.0, 4.0) < 0.0 ? -1.0 : 0.0; })),
            (Kinds{{FormKind::pocket, 1}}));
  EXPECT_EQ(kinds_in(scan([](double x, double y) { return box(x, y, 5.0, 4.0) < 0.0 ? 1.0 : 0.0; })),
            (Kinds{{FormKind::boss, 1}}));
}

TEST(Forms, WallsBelongToTheirPocket) {
  const FeatureReport report = scan([](double x, double y) { return wall(box(x, y, 6.0, 5.0), -2.0, 2.0); });
  ASSERT_EQ(kinds_in(report), (Kinds{{FormKind::pocket, 1}}));
  EXPECT_GE(report.forms[0].patches.size(), 2U);
}

TEST(Forms, AnIslandInAPocketIsABoss) {
  const auto part = [](double x, double y) {
    return box(x, y, 9.0, 8.0) < 0.0 ? box(x, y, 3.0, 3.0) < 0.0 ? -1.0 : -2.0 : 0.0;
  };
  EXPECT_EQ(kinds_in(scan(part)), (Kinds{{FormKind::pocket, 1}, {FormKind::boss, 1}}));
}

TEST(Forms, SlotAndRibAreLong) {
  EXPECT_EQ(kinds_in(scan([](double x, double y) { return box(x, y, 9.0, 1.5) < 0.0 ? -1.0 : 0.0; })),
            (Kinds{{FormKind::slot, 1}}));
  EXPECT_EQ(kinds_in(scan([](double x, double y) { return box(x, y, 1.5, 8.0) < 0.0 ? 1.0 : 0.0; })),
            (Kinds{{FormKind::rib, 1}}));
  EXPECT_EQ(kinds_in(scan([](double x, double) { return std::abs(x - 12.0) < 1.5 ? -1.0 : 0.0; })),
            (Kinds{{FormKind::slot, 1}}));
}

TEST(Forms, TwoFlanksAreAGrooveOrASharpRib) {
  const auto vee = [](double depth) {
    return [depth](double x, double) { return -depth * std::max(0.0, 1.0 - std::abs(x - 12.0) / 2.0); };
  };
  FeatureReport report = scan(vee(1.0));
  ASSERT_EQ(kinds_in(report), (Kinds{{FormKind::slot, 1}}));
  EXPECT_EQ(report.forms[0].patches.size(), 2U);
  report = scan(vee(-1.0));
  ASSERT_EQ(kinds_in(report), (Kinds{{FormKind::rib, 1}}));
  EXPECT_EQ(report.forms[0].patches.size(), 2U);
}

TEST(Forms, ARoundBottomIsASlotToo) {
  const auto part = [](double x, double) {
    const double d = std::abs(x - 12.0);
    return d < 2.0 ? 3.0 - std::sqrt(25.0 - d * d) + std::sqrt(21.0) - 3.0 : 0.0;
  };
  EXPECT_EQ(kinds_in(scan(part)), (Kinds{{FormKind::slot, 1}}));
}

TEST(Forms, TheLandBetweenTwoGroovesIsNone) {
  const auto part = [](double x, double) {
    return -std::max(0.0, 1.0 - std::abs(x - 8.0) / 1.5) - std::max(0.0, 1.0 - std::abs(x - 14.0) / 1.5);
  };
  EXPECT_EQ(kinds_in(scan(part)), (Kinds{{FormKind::slot, 2}}));
}

TEST(Forms, LevelsMakeSteps) {
  EXPECT_EQ(kinds_in(scan([](double x, double) { return x < 12.0 ? 0.0 : 1.0; })), (Kinds{{FormKind::step, 1}}));
  const FeatureReport report = scan([](double x, double) { return wall(x - 12.0, 2.0, 2.0); });
  ASSERT_EQ(kinds_in(report), (Kinds{{FormKind::step, 1}}));
  ASSERT_EQ(report.forms[0].patches.size(), 3U); // upper level, wall, lower level
  const auto height = [&](std::uint32_t id) {
    for (const Patch& patch : report.patches)
      if (patch.id == id) return patch.centroid[2];
    return 0.0;
  };
  EXPECT_GT(height(report.forms[0].patches.front()), height(report.forms[0].patches.back()) + 1.5);
}

// 3 mm between a face and a steep one, beside the face in a crease of 20 degrees: straight, or bent by 21 degrees more.
TEST(Forms, AStripThatBendsIsAFillet) {
  constexpr double kBegin = 16.0, kEnd = 19.0, kSlope = 0.364, kSteep = 1.5;
  const auto label = [&](double bend) {
    const auto part = [=](double x, double) {
      const double u = std::clamp(x, kBegin, kEnd) - kBegin;
      return -kSlope * u - 0.5 * bend * u * u - kSteep * std::max(0.0, x - kEnd);
    };
    for (const Patch& patch : scan(part, {20.0, 0.0}).patches)
      if (patch.centroid[0] > kBegin && patch.centroid[0] < kEnd) return patch.label;
    return FormKind::hole;
  };
  EXPECT_EQ(label(0.0), FormKind::chamfer);
  EXPECT_EQ(label(0.171), FormKind::fillet);
}

TEST(Forms, MissingPointsChangeNothing) {
  const Faults faults{20.0, 0.03};
  EXPECT_EQ(kinds_in(scan([](double x, double y) { return box(x, y, 5.0, 4.0) < 0.0 ? -1.0 : 0.0; }, faults)),
            (Kinds{{FormKind::pocket, 1}}));
}

TEST(Forms, ASmoothPartHasNone) {
  const FeatureReport report =
      scan([](double x, double y) { return 1.5 * std::sin(0.2 * x) * std::cos(0.15 * y); }, {20.0, 0.0});
  EXPECT_TRUE(report.forms.empty());
}

TEST(Forms, EachPatchIsPublishedOnce) {
  const FeatureReport report = scan([](double x, double y) { return box(x, y, 5.0, 4.0) < 0.0 ? -1.0 : 0.0; }, {50.0, 0.02});
  std::map<std::uint32_t, int> times;
  for (const Patch& patch : report.patches) ++times[patch.id];
  std::uint64_t samples = 0;
  for (const auto& [id, n] : times) EXPECT_EQ(n, 1) << id;
  for (const Patch& patch : report.patches) samples += patch.samples;
  std::uint64_t in_runs = 0;
  for (const PatchRun& run : report.runs) in_runs += run.count;
  EXPECT_EQ(samples, in_runs);
  for (const PatchMerge& merge : report.merges) EXPECT_FALSE(times.contains(merge.from));
}

} // namespace
} // namespace scansion
