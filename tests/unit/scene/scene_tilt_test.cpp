// A leaning scan plane: points lie on the plane and on the surface, and nothing hides them.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/catalog.hpp"
#include "sim/scene/scanner.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace scansion {
namespace {

struct Case {
  const char* scene;
  double tilt, direction;
};

class Tilt : public testing::TestWithParam<Case> {
protected:
  SceneScanner make(double noise) const {
    ScanPlan plan;
    plan.lines = 12;
    plan.points = 230;
    plan.noise_um = noise;
    plan.tilt_deg = GetParam().tilt;
    plan.direction_deg = GetParam().direction;
    auto scanner = SceneScanner::create(make_scene(GetParam().scene).value(), plan);
    EXPECT_TRUE(scanner);
    return std::move(scanner).value();
  }
};

TEST_P(Tilt, PointsLieOnThePlaneAlsoWithNoise) {
  SceneScanner scanner = make(40.0);
  const SinCos turn = scanner.geometry().direction;
  const SinCos lean = scanner.geometry().tilt;
  SceneLine line;
  double last = 0.0;
  while (scanner.next(line)) {
    const auto offset = [&](const ScenePoint& p) {
      return turn.sin * lean.cos * p.x - turn.cos * lean.cos * p.y + lean.sin * p.z;
    };
    double low = 1e300;
    double high = -1e300;
    for (const ScenePoint& point : line.points) {
      low = std::min(low, offset(point));
      high = std::max(high, offset(point));
    }
    EXPECT_LE(high - low, 1.74); // rounding of three coordinates to 1 um
    if (line.index > 0) {
      EXPECT_NEAR(last - low, scanner.geometry().spacing * lean.cos, 2.0);
    }
    last = low;
  }
}

TEST_P(Tilt, PointsLieOnTheSurface) {
  SceneScanner scanner = make(0.0);
  const Scene& scene = scanner.scene();
  SceneLine line;
  int points = 0;
  while (scanner.next(line)) {
    for (const ScenePoint& point : line.points) {
      // On a vertical wall any height between top and foot is on the surface: look at the place and around it.
      double low = 1e300;
      double high = -1e300;
      for (const double dx : {-0.0015, 0.0, 0.0015}) {
        for (const double dy : {-0.0015, 0.0, 0.0015}) {
          const double z = scene.height(point.x / 1000.0 + dx, point.y / 1000.0 + dy);
          low = std::min(low, z);
          high = std::max(high, z);
        }
      }
      ASSERT_GE(point.z / 1000.0, low - 0.001) << point.x << ' ' << point.y;
      ASSERT_LE(point.z / 1000.0, high + 0.001) << point.x << ' ' << point.y;
      ++points;
    }
  }
  EXPECT_EQ(points, 12 * 230);
}

TEST_P(Tilt, NothingHidesAPoint) {
  SceneScanner scanner = make(0.0);
  const Scene& scene = scanner.scene();
  const double dx = -scanner.geometry().tilt.sin * scanner.geometry().direction.sin;
  const double dy = scanner.geometry().tilt.sin * scanner.geometry().direction.cos;
  SceneLine line;
  while (scanner.next(line)) {
    for (std::size_t k = line.index % 5; k < line.points.size(); k += 5) {
      const ScenePoint& point = line.points[k];
      // Up the ray from just above the point; what hides it may be at most one trace step (0.05 mm in plan) thick.
      double hidden = 0.0;
      for (double h = 0.02; h < 25.0; h += 0.02) {
        const double z = point.z / 1000.0 + h * scanner.geometry().tilt.cos;
        if (scene.height(point.x / 1000.0 + h * dx, point.y / 1000.0 + h * dy) > z + 0.002) hidden += 0.02;
      }
      ASSERT_LE(hidden * std::fabs(scanner.geometry().tilt.sin), 0.06) << point.x << ' ' << point.y;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Tilt,
                         testing::Values(Case{"freeform", 20.0, 0.0}, Case{"part", 20.0, 0.0}, Case{"part", -30.0, 35.0},
                                         Case{"pocket", 30.0, 90.0}, Case{"boss", 1.0, 0.0}, Case{"ribs", 45.0, 60.0},
                                         Case{"plane", -45.0, 200.0}, Case{"paper", 15.0, 0.0}));

} // namespace
} // namespace scansion
