// Scenes of many features: a machined part, and a sculpted part as large as the paper's data set.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/scenes.hpp"

#include "sim/scene/portable_math.hpp"

namespace scansion {
namespace {

/// The silhouette of the sculpted part: rounded, wider below its middle, slightly bent.
LineSpan paper_span(double t) noexcept {
  constexpr double kPi = 3.14159265358979323846;
  const double swell = portable_sin(kPi * t);
  return {0.03 * portable_sin(2.0 * kPi * t),
          0.72 + 0.26 * swell * (0.8 + 0.4 * (1.0 - t)) - 0.03 * portable_sin(6.0 * kPi * t)};
}

/// A rosette on a round medallion with two rings around it.
void add_medallion(Scene& scene, double x, double y, double radius) {
  scene.features.emplace_back(Footprint::disc(x, y, radius), Profile::wall(1.6, 0.6, 0.8, 0.6));
  scene.features.emplace_back(Footprint::disc(x, y, radius - 2.5),
                              Profile{{-1.6, 0.0}, {-1.2, 0.0}, {-0.6, -0.7}, {0.0, 0.0}, {0.4, 0.0}}); // V ring
  scene.features.emplace_back(Footprint::disc(x, y, radius - 5.0), Profile::wall(-0.5, 0.2, 0.2));
  scene.base.add(Rosette{x, y, radius - 5.5, 1.2, 6});
}

/// Letters of grooves with round ends, as an engraving cutter leaves them.
void add_engraving(Scene& scene, double x, double y) {
  const Profile groove{{-0.6, -0.5}, {-0.4, -0.5, 0.3}, {0.0, 0.0}};
  const double strokes[][4] = {{0.0, 0.0, 9.0, 90.0},  {5.0, 0.0, 9.0, 70.0}, {9.0, 0.0, 9.0, 110.0},
                               {14.0, 0.0, 9.0, 90.0}, {18.0, 3.8, 6.0, 0.0}, {18.0, -3.8, 6.0, 0.0}};
  for (const auto& stroke : strokes) {
    scene.features.emplace_back(Footprint::round_box(x + stroke[0], y + stroke[1], stroke[2], 1.2, 0.6, stroke[3]), groove);
  }
}

} // namespace

Scene make_part() {
  Scene scene;
  scene.name = "part";
  scene.summary = "machined part: pocket with island, bosses, holes, slots, rib, steps, chamfer and fillets on a curved base";
  scene.relief_low = -12.0;
  scene.relief_high = 9.0;
  scene.base.slope_x = 0.004;
  scene.base.slope_y = -0.002;
  scene.base.add(Bump{50.0, 40.0, 90.0, 75.0, 10.0, 1.5});
  auto& features = scene.features;
  features.emplace_back(Footprint::round_box(32.0, 48.0, 42.0, 34.0, 6.0), Profile::wall(-6.0, 0.4, 0.3, 1.5)); // pocket
  features.emplace_back(Footprint::round_box(27.0, 50.0, 12.0, 9.0, 2.0, 30.0), Profile::wall(4.0, 0.2, 0.6));  // its island
  features.emplace_back(Footprint::disc(43.0, 40.0, 4.0), Profile::wall(-4.0));                // hole in its floor
  features.emplace_back(Footprint::disc(74.0, 54.0, 13.0), Profile::wall(6.0, 0.3, 1.2, 0.5)); // boss
  features.emplace_back(Footprint::disc(74.0, 54.0, 6.0),
                        Profile{{-6.0, -5.0}, {-0.7, -5.0}, {-0.7, -0.7}, {0.0, 0.0}});                             // bore
  features.emplace_back(Footprint::round_box(70.0, 26.0, 34.0, 6.0, 3.0, 12.0), Profile::wall(-3.0, 0.0, 0.2));     // slot
  features.emplace_back(Footprint::round_box(30.0, 20.0, 40.0, 3.0, 0.0, -5.0), Profile::wall(2.5, 0.3, 0.5, 0.3)); // rib
  features.emplace_back(Footprint::strip(0.0, 10.0, 3.0, 0.8), Profile{{-0.8, -0.9}, {0.0, 0.0}});                  // V groove
  features.emplace_back(Footprint::half_plane(94.0, 40.0, 88.0),
                        Profile::wall(-3.0, 2.0, 0.0, 1.0));                         // lowered ledge, chamfered
  features.emplace_back(Footprint::half_plane(50.0, 4.0, 0.0), Profile::wall(-1.0)); // step along the scan
  for (const double x : {58.0, 70.0, 82.0}) {
    features.emplace_back(Footprint::disc(x, 72.0, 2.0), Profile::wall(-2.0)); // row of holes
  }
  return scene;
}

Scene make_paper() {
  Scene scene;
  scene.name = "paper";
  scene.summary = "sculpted part with relief, as large as the paper's data set: 1,214 lines, 1,328,531 points";
  scene.length_x = 120.0;
  scene.length_y = 121.4;
  scene.lines = 1214;
  scene.points = 1200; // across the whole window: a pitch of 0.1 mm
  scene.total_points = 1'328'531;
  scene.relief_low = -5.0;
  scene.relief_high = 22.0;
  scene.span = paper_span;
  scene.base.add(Bump{60.0, 58.0, 95.0, 88.0, 0.0, 14.0});
  scene.base.add(Bump{40.0, 84.0, 20.0, 13.0, -20.0, -2.0});
  scene.base.add(Bump{80.0, 84.0, 20.0, 13.0, 20.0, -2.0});
  scene.base.add(Bump{60.0, 70.0, 9.0, 20.0, 0.0, 3.5});
  scene.base.add(Bump{60.0, 104.0, 44.0, 14.0, 0.0, 2.0});
  scene.base.add(Wave{60.0, 0.0, 8.0, 31.0, 0.25});
  scene.base.add(Wave{0.0, 60.0, 97.0, 19.0, 0.12});
  add_medallion(scene, 60.0, 32.0, 17.0);
  add_engraving(scene, 27.0, 56.0);
  add_engraving(scene, 75.0, 56.0);
  auto& features = scene.features;
  features.emplace_back(Footprint::round_box(60.0, 60.0, 128.0, 108.0, 30.0),
                        Profile::wall(1.0, 1.2, 0.5, 0.8)); // raised field
  features.emplace_back(Footprint::round_box(28.0, 32.0, 16.0, 12.0, 3.0, 40.0), Profile::wall(-2.0, 0.3, 0.2, 0.8));
  features.emplace_back(Footprint::round_box(92.0, 32.0, 16.0, 12.0, 3.0, -40.0), Profile::wall(-2.0, 0.3, 0.2, 0.8));
  features.emplace_back(Footprint::disc(40.0, 84.0, 6.0), Profile::wall(1.5, 0.4, 1.0, 0.4));
  features.emplace_back(Footprint::disc(80.0, 84.0, 6.0), Profile::wall(1.5, 0.4, 1.0, 0.4));
  features.emplace_back(Footprint::round_box(60.0, 98.0, 46.0, 3.0, 1.5, 0.0), Profile{{-1.5, 0.9}, {0.0, 0.0}}); // sharp ridge
  features.emplace_back(Footprint::round_box(60.0, 104.0, 40.0, 2.4, 1.2, 0.0), Profile::wall(-0.8, 0.3, 0.2));
  return scene;
}

} // namespace scansion
