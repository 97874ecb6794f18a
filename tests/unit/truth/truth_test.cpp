// The ground truth of scenes against what is known of them otherwise.
// SPDX-License-Identifier: Apache-2.0
#include "sim/truth/truth_json.hpp"

#include "sim/scene/catalog.hpp"
#include "sim/scene/scenes.hpp"
#include "sim/truth/curves.hpp"
#include "sim/truth/scan_truth.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <map>

namespace scansion {
namespace {

constexpr double kPi = 3.14159265358979323846;

double length(const TrueCurve& curve) {
  double sum = 0.0;
  for (std::size_t k = 1; k < curve.points.size(); ++k) {
    const auto& a = curve.points[k - 1];
    const auto& b = curve.points[k];
    sum += std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
  }
  return sum;
}

Truth truth_of(Scene scene, const ScanPlan& plan) {
  auto truth = ScanTruth::create(scene, plan);
  auto scanner = SceneScanner::create(std::move(scene), plan);
  EXPECT_TRUE(truth && scanner);
  for (SceneLine line; scanner.value().next(line);) truth.value().add(line);
  return truth.value().finish();
}

Truth truth_of(const char* name, const ScanPlan& plan = {}) {
  return truth_of(make_scene(name).value(), plan);
}

Scene plate() {
  Scene scene;
  scene.length_x = scene.length_y = 20.0;
  scene.lines = scene.points = 100;
  return scene;
}

TEST(TrueCurves, ADiscHasTopAndBottomCircles) {
  Scene scene = plate();
  scene.features.emplace_back(Footprint::disc(10.0, 10.0, 4.0), Profile::wall(2.0, 0.5));
  const Truth truth = truth_of(scene, {});
  ASSERT_EQ(truth.curves.size(), 2U);
  EXPECT_EQ(truth.curves[0].type, FeatureType::step_top); // 2 over 0.5 is steeper than 70 degrees
  EXPECT_EQ(truth.curves[1].type, FeatureType::step_bottom);
  EXPECT_TRUE(truth.curves[0].closed && truth.curves[1].closed);
  EXPECT_NEAR(length(truth.curves[0]), 2.0 * kPi * 3.5, 0.06);
  EXPECT_NEAR(length(truth.curves[1]), 2.0 * kPi * 4.0, 0.06);
  for (const auto& p : truth.curves[0].points) {
    EXPECT_NEAR(std::hypot(p[0] - 10.0, p[1] - 10.0), 3.5, 1e-9);
    EXPECT_NEAR(p[2], 2.0, 1e-9);
  }
}

TEST(TrueCurves, AVGrooveHasThreeLinesAndTheyEndAtTheWindow) {
  Scene scene = plate();
  scene.features.emplace_back(Footprint::strip(10.0, 10.0, 90.0, 1.0), Profile{{-1.0, -1.0}, {0.0, 0.0}});
  const Truth truth = truth_of(scene, {});
  std::map<FeatureType, int> types;
  for (const TrueCurve& curve : truth.curves) {
    ++types[curve.type];
    EXPECT_NEAR(length(curve), 99 * 0.2, 0.11);
  }
  EXPECT_EQ(types[FeatureType::convex], 2);
  EXPECT_EQ(types[FeatureType::concave], 1);
}

TEST(TrueCurves, FaintBendsAreLeftOutAndWideArcsAreOptional) {
  Scene scene = plate();
  scene.features.emplace_back(Footprint::half_plane(5.0, 0.0, 90.0),
                              Profile{{0.0, 0.0}, {2.0, 0.2}, {4.0, 0.2}}); // 5.7 degrees
  scene.features.emplace_back(Footprint::half_plane(12.0, 0.0, 90.0),
                              Profile{{-2.0, 0.0}, {0.0, 0.0, 5.0}, {4.0, 2.0}, {6.0, 2.0}});
  const Truth truth = truth_of(scene, {});
  ASSERT_EQ(truth.curves.size(), 2U);
  EXPECT_TRUE(truth.curves[0].optional);
  EXPECT_EQ(truth.curves[0].type, FeatureType::concave);
  EXPECT_FALSE(truth.curves[1].optional);
}

TEST(TrueCurves, AWallOfAnotherFeatureCutsACurve) {
  Scene scene = plate();
  scene.features.emplace_back(Footprint::half_plane(0.0, 10.0, 0.0), Profile{{-2.0, 0.0}, {0.0, 0.0}, {4.0, 2.0}, {6.0, 2.0}});
  scene.features.emplace_back(Footprint::half_plane(10.0, 0.0, 90.0), Profile::wall(-3.0));
  const Truth truth = truth_of(scene, {});
  std::map<FeatureType, int> types;
  for (const TrueCurve& curve : truth.curves) ++types[curve.type];
  EXPECT_EQ(types[FeatureType::concave], 2);
  EXPECT_EQ(types[FeatureType::convex], 2);
}

TEST(TrueCurves, ALeaningSheetDoesNotSeeTheFootOfAWallBehindIt) {
  Scene scene = plate();
  scene.relief_low = -3.0;
  scene.features.emplace_back(Footprint::strip(10.0, 10.0, 0.0, 4.0), Profile::wall(-3.0));
  ScanPlan plan;
  plan.tilt_deg = 20.0;
  std::map<FeatureType, int> types;
  for (const TrueCurve& curve : truth_of(scene, plan).curves) ++types[curve.type];
  EXPECT_EQ(types[FeatureType::step_top], 2);
  EXPECT_EQ(types[FeatureType::step_bottom], 1);
}

// Every curve of every scene lies on its surface, up to the fillet that rounds it.
TEST(TrueCurves, LieOnTheSurface) {
  std::vector<Scene> scenes;
  for (const CatalogEntry& entry : scene_catalog()) scenes.push_back(entry.make());
  for (std::uint64_t part = 0; part < 12; ++part) scenes.push_back(make_random(part));
  for (const Scene& scene : scenes) {
    ScanPlan plan;
    plan.lines = 40;
    plan.points = 40;
    const auto geometry = plan_scan(scene, plan);
    ASSERT_TRUE(geometry);
    for (const TrueCurve& curve : true_curves(scene, geometry.value())) {
      ASSERT_FALSE(curve.points.empty());
      for (const auto& p : curve.points) {
        double low = scene.height(p[0], p[1]);
        double high = low;
        for (const double dx : {-1e-3, 0.0, 1e-3}) {
          for (const double dy : {-1e-3, 0.0, 1e-3}) {
            low = std::min(low, scene.height(p[0] + dx, p[1] + dy));
            high = std::max(high, scene.height(p[0] + dx, p[1] + dy));
          }
        }
        ASSERT_GE(p[2], low - 0.01 - curve.radius_mm) << scene.name;
        ASSERT_LE(p[2], high + 0.01 + curve.radius_mm) << scene.name;
      }
    }
  }
}

TEST(TruePatches, AStepPartsThePlate) {
  Scene scene = plate();
  scene.features.emplace_back(Footprint::half_plane(10.05, 0.0, 90.0), Profile::wall(-1.0));
  const Truth truth = truth_of(scene, {});
  ASSERT_EQ(truth.patches.size(), 2U);
  EXPECT_EQ(truth.patches[0].samples + truth.patches[1].samples, 10000U);
  ASSERT_EQ(truth.forms.size(), 1U);
  EXPECT_EQ(truth.forms[0].kind, FormKind::step);
  EXPECT_EQ(truth.forms[0].patches, (std::vector<std::uint32_t>{0, 1}));
}

TEST(TruePatches, KindsOfTheSmallParts) {
  const std::map<std::string, FormKind> wanted{{"channels", FormKind::slot}, {"cavity", FormKind::pocket},
                                               {"posts", FormKind::boss},    {"rails", FormKind::rib},
                                               {"terraces", FormKind::step}, {"grooves", FormKind::slot}};
  for (const auto& [name, kind] : wanted) {
    ScanPlan plan;
    plan.pitch_mm = plan.spacing_mm = 0.2;
    const Truth truth = truth_of(name.c_str(), plan);
    EXPECT_TRUE(std::ranges::any_of(truth.forms, [&](const TrueForm& form) { return form.kind == kind; })) << name;
    std::uint64_t samples = 0;
    for (const TruePatch& patch : truth.patches) samples += patch.samples;
    std::uint64_t in_lines = 0;
    for (const auto& line : truth.lines) {
      for (const TrueRun& run : line) in_lines += run.count;
    }
    EXPECT_EQ(samples, in_lines);
  }
}

TEST(TrueForms, AHoleHasAnOutlineAndNoSamples) {
  Scene scene = plate();
  scene.holes.push_back({Footprint::disc(8.0, 9.0, 3.0)});
  scene.holes.push_back({Footprint::disc(19.0, 9.0, 3.0)}); // the border of the scan cuts it
  const Truth truth = truth_of(scene, {});
  ASSERT_EQ(truth.forms.size(), 1U);
  EXPECT_EQ(truth.forms[0].kind, FormKind::hole);
  EXPECT_EQ(truth.forms[0].patches, (std::vector<std::uint32_t>{0}));
  ASSERT_TRUE(truth.forms[0].hole);
  EXPECT_NEAR(truth.forms[0].hole->area_mm2, 9.0 * kPi, 1e-9);
  ASSERT_EQ(truth.curves.size(), 2U);
  EXPECT_EQ(truth.curves[0].type, FeatureType::step_top);
  EXPECT_TRUE(truth.curves[0].closed);
  EXPECT_EQ(truth.curves[0].feature, truth.forms[0].feature);
  EXPECT_NEAR(length(truth.curves[0]), 6.0 * kPi, 0.1);
  EXPECT_FALSE(truth.curves[1].closed);
  auto scanner = SceneScanner::create(scene, {});
  ASSERT_TRUE(scanner);
  SceneLine line;
  while (scanner.value().next(line)) {
    for (const ScenePoint& p : line.points)
      EXPECT_EQ(p.is_there(),
                std::hypot(p.x - 8000.0, p.y - 9000.0) >= 3000.0 && std::hypot(p.x - 19000.0, p.y - 9000.0) >= 3000.0);
  }
  EXPECT_EQ(scanner.value().counts().dropouts, 0U);
  EXPECT_EQ(scanner.value().counts().points + scanner.value().counts().in_holes, 10000U);
  EXPECT_EQ(truth.patches[0].samples, scanner.value().counts().points);
}

TEST(TruePatches, FaultsTakeSamplesAwayAndNothingElse) {
  ScanPlan plan;
  plan.pitch_mm = plan.spacing_mm = 0.2;
  const Truth clean = truth_of("channels", plan);
  plan.zigzag = true;
  plan.dropouts = 0.05;
  plan.missing_lines = 0.1;
  const Truth dirty = truth_of("channels", plan);
  const auto large = [](const Truth& truth) {
    return std::ranges::count_if(truth.patches, [](const TruePatch& patch) { return patch.samples > 400; });
  };
  EXPECT_EQ(large(clean), large(dirty));
  EXPECT_GE(large(clean), 5);
  EXPECT_EQ(clean.curves.size(), dirty.curves.size());
  EXPECT_LT(dirty.lines.size(), clean.lines.size());
}

TEST(TruePatches, BacklashMovesNoTruth) {
  ScanPlan plan;
  plan.pitch_mm = plan.spacing_mm = 0.2;
  plan.zigzag = true;
  const Truth still = truth_of("channels", plan);
  plan.backlash_um = 400.0;
  const Truth moved = truth_of("channels", plan);
  EXPECT_EQ(still.curves.size(), moved.curves.size());
  const auto large = [](const Truth& truth) {
    return std::ranges::count_if(truth.patches, [](const TruePatch& patch) { return patch.samples > 400; });
  };
  EXPECT_EQ(large(still), large(moved));
  EXPECT_LT(moved.patches.size(), 2 * still.patches.size());
  EXPECT_NE(still.lines, moved.lines); // the samples of odd lines stand on other places
}

TEST(TruthJson, GoesThereAndBack) {
  ScanPlan plan;
  plan.pitch_mm = plan.spacing_mm = 0.5;
  Scene scene = make_scene("bracket").value();
  scene.holes.push_back({Footprint::round_box(22.0, 30.0, 4.0, 3.0, 0.5), 4.0});
  const Truth truth = truth_of(scene, plan);
  const std::string json = truth_json(truth);
  const auto read = parse_truth(json);
  ASSERT_TRUE(read) << read.error().context;
  EXPECT_EQ(truth_json(read.value()), json);
  EXPECT_EQ(read.value().patches, truth.patches);
  EXPECT_EQ(read.value().forms, truth.forms);
  EXPECT_EQ(read.value().lines, truth.lines);
  EXPECT_FALSE(parse_truth("{}"));
  EXPECT_FALSE(parse_truth("nonsense"));
}

} // namespace
} // namespace scansion
