// What may be asked of a scan, and what follows from it.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/catalog.hpp"
#include "sim/scene/scan_command.hpp"
#include "sim/scene/scan_plan.hpp"

#include <gtest/gtest.h>
#include <limits>

namespace scansion {
namespace {

TEST(ScanPlans, PitchAndSpacingFollowOrLead) {
  const Scene scene = make_scene("part").value();
  ScanPlan plan;
  const ScanGeometry standard = plan_scan(scene, plan).value();
  EXPECT_EQ(standard.lines, 400U);
  EXPECT_EQ(standard.points, 1000U);
  EXPECT_EQ(standard.pitch, 100.0);
  EXPECT_EQ(standard.spacing, 200.0);
  plan.pitch_mm = 0.05;
  plan.spacing_mm = 0.5;
  const ScanGeometry finer = plan_scan(scene, plan).value();
  EXPECT_EQ(finer.points, 2000U);
  EXPECT_EQ(finer.lines, 160U);
  plan.points = 10;
  plan.lines = 7;
  const ScanGeometry both = plan_scan(scene, plan).value();
  EXPECT_EQ(both.points, 10U);
  EXPECT_EQ(both.lines, 7U);
  EXPECT_EQ(both.pitch, 50.0);
  ScanPlan many;
  many.lines = 50000;
  many.points = 1094;
  const ScanGeometry over = plan_scan(scene, many).value();
  EXPECT_EQ(over.pitch, 91.0);  // whole micrometres
  EXPECT_EQ(over.spacing, 1.6); // too fine to be rounded
  EXPECT_EQ(over.samples, 50000U * 1094U);
}

TEST(ScanPlans, WindowHoldsTheTurnedPart) {
  ScanPlan plan;
  plan.direction_deg = 90.0;
  const ScanGeometry geometry = plan_scan(make_scene("part").value(), plan).value();
  EXPECT_EQ(geometry.window, 80000.0);
  EXPECT_EQ(geometry.points, 800U);
  EXPECT_EQ(geometry.lines, 500U);
}

TEST(ScanPlans, BadRequestsNameTheOption) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  struct Bad {
    const char* option;
    void (*set)(ScanPlan&, double);
    double value;
  };
  const Bad bad[] = {
      {"--tilt", [](ScanPlan& p, double v) { p.tilt_deg = v; }, 46.0},
      {"--tilt", [](ScanPlan& p, double v) { p.tilt_deg = v; }, nan},
      {"--direction", [](ScanPlan& p, double v) { p.direction_deg = v; }, infinite},
      {"--noise", [](ScanPlan& p, double v) { p.noise_um = v; }, -1.0},
      {"--noise", [](ScanPlan& p, double v) { p.noise_um = v; }, 1e300},
      {"--correlated", [](ScanPlan& p, double v) { p.correlated_mm = v; }, -0.1},
      {"--jitter", [](ScanPlan& p, double v) { p.jitter = v; }, 1.5},
      {"--outliers", [](ScanPlan& p, double v) { p.outliers = v; }, -0.5},
      {"--dropouts", [](ScanPlan& p, double v) { p.dropouts = v; }, 1.01},
      {"--missing-lines", [](ScanPlan& p, double v) { p.missing_lines = v; }, nan},
      {"--pitch", [](ScanPlan& p, double v) { p.pitch_mm = v; }, 0.0},
      {"--spacing", [](ScanPlan& p, double v) { p.spacing_mm = v; }, -1.0},
      {"--pitch", [](ScanPlan& p, double v) { p.pitch_mm = v; }, 1e-6},      // too many samples
      {"--spacing", [](ScanPlan& p, double v) { p.spacing_mm = v; }, 600.0}, // with 4 lines: too long
      {"--lines", [](ScanPlan& p, double v) { p.lines = static_cast<std::uint32_t>(v); }, 0.0},
      {"--lines", [](ScanPlan& p, double v) { p.lines = static_cast<std::uint32_t>(v); }, 4e9},
      {"--points", [](ScanPlan& p, double v) { p.points = static_cast<std::uint32_t>(v); }, 0.0},
      {"--points", [](ScanPlan& p, double v) { p.points = static_cast<std::uint32_t>(v); }, 4e9},
  };
  for (const Bad& row : bad) {
    for (const char* name : {"part", "paper"}) {
      ScanPlan plan;
      plan.lines = 4;
      row.set(plan, row.value);
      const auto geometry = plan_scan(make_scene(name).value(), plan);
      ASSERT_FALSE(geometry) << name << ' ' << row.option << ' ' << row.value;
      EXPECT_EQ(geometry.error().code, Errc::usage);
      EXPECT_NE(geometry.error().context.find(row.option), std::string::npos) << geometry.error().context;
    }
  }
  ScanPlan endless;
  endless.lines = 10'000'000;
  endless.points = 4'000'000;
  const auto refused = plan_scan(make_scene("part").value(), endless);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::usage);
}

TEST(ScanPlans, CommandSaysWhatWasAsked) {
  const Scene scene = make_scene("part").value();
  ScanPlan plan;
  EXPECT_EQ(scan_command(scene, plan), "scansim scene part --seed 1 --noise 5");
  plan.lines = 20;
  plan.points = 30;
  plan.pitch_mm = 0.1;
  plan.spacing_mm = 2.0;
  plan.direction_deg = -12.5;
  plan.tilt_deg = 20.0;
  plan.seed = 18446744073709551615ULL;
  plan.noise_um = 0.3;
  plan.correlated_mm = 1.0;
  plan.jitter = 0.25;
  plan.outliers = 0.01;
  plan.dropouts = 0.02;
  plan.missing_lines = 0.03;
  plan.zigzag = true;
  EXPECT_EQ(scan_command(scene, plan),
            "scansim scene part --lines 20 --points 30 --pitch 0.1 --spacing 2 --direction -12.5 --tilt 20 "
            "--seed 18446744073709551615 --noise 0.3 --correlated 1 --jitter 0.25 --outliers 0.01 --dropouts 0.02 "
            "--missing-lines 0.03 --zigzag");
  plan.backlash_um = 50.0;
  EXPECT_TRUE(scan_command(scene, plan).ends_with("--zigzag --backlash 50"));
}

} // namespace
} // namespace scansion
