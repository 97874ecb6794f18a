// Scenes of one kind of feature each.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/scenes.hpp"

namespace scansion {
namespace {

Scene named(const char* name, const char* summary, double relief_low, double relief_high) {
  Scene scene;
  scene.name = name;
  scene.summary = summary;
  scene.relief_low = relief_low;
  scene.relief_high = relief_high;
  return scene;
}

/// A V of `depth` (negative: a sharp rib) in a footprint of half width `half`.
Profile vee(double depth, double half) {
  return Profile{{-half, -depth}, {0.0, 0.0}};
}

} // namespace

Scene make_plane() {
  Scene scene = named("plane", "inclined plane, 3 and 1 percent", 0.0, 0.0);
  scene.base.slope_x = 0.03;
  scene.base.slope_y = 0.01;
  return scene;
}

Scene make_steps() {
  Scene scene = named("steps", "stairs of 0.05 to 5 mm across the scan, one oblique and one along it", -6.3, 1.0);
  // Outside of a half plane in direction 90 is towards -x: each step falls from there on.
  const double heights[] = {0.05, 0.1, 0.2, 0.5, 1.0, 2.0};
  double x = 12.0;
  for (const double height : heights) {
    scene.features.emplace_back(Footprint::half_plane(x, 0.0, 90.0), Profile::wall(-height));
    x += 11.0;
  }
  scene.features.emplace_back(Footprint::half_plane(88.0, 40.0, 75.0), Profile::wall(-2.0, 1.0));
  scene.features.emplace_back(Footprint::half_plane(50.0, 52.0, 0.0), Profile{{-1.0, 0.0}, {0.0, 0.0}, {0.0, 1.0}, {1.0, 1.0}});
  scene.features.emplace_back(Footprint::half_plane(50.0, 64.0, 20.0),
                              Profile{{-1.0, 0.0}, {0.0, 0.0}, {0.0, -0.4}, {1.0, -0.4}});
  return scene;
}

Scene make_slots() {
  Scene scene = named("slots", "slots of 0.5 to 8 mm with square and round ends, V grooves", -6.0, 0.0);
  scene.features.emplace_back(Footprint::strip(8.0, 0.0, 90.0, 0.25), Profile::wall(-1.0));
  scene.features.emplace_back(Footprint::strip(16.0, 0.0, 90.0, 0.5), Profile::wall(-2.0));
  scene.features.emplace_back(Footprint::strip(27.0, 0.0, 90.0, 1.5), Profile::wall(-3.0, 0.0, 0.0, 0.5));
  scene.features.emplace_back(Footprint::round_box(40.0, 40.0, 60.0, 8.0, 4.0, 90.0), Profile::wall(-4.0, 0.5, 0.3));
  scene.features.emplace_back(Footprint::round_box(57.0, 58.0, 24.0, 5.0, 0.0, 30.0), Profile::wall(-3.0));
  scene.features.emplace_back(Footprint::round_box(57.0, 22.0, 24.0, 5.0, 2.5, -30.0), Profile::wall(-6.0, 0.2));
  scene.features.emplace_back(Footprint::strip(78.0, 0.0, 90.0, 1.0), vee(1.5, 1.0));
  scene.features.emplace_back(Footprint::strip(88.0, 40.0, 84.0, 2.0), vee(0.8, 2.0));
  scene.features.emplace_back(Footprint::strip(96.0, 0.0, 90.0, 1.0), Profile::wall(-0.1));
  return scene;
}

Scene make_pocket() {
  Scene scene =
      named("pocket", "round-cornered pocket with drafted walls, floor fillet, an island and a lower hole", -11.0, 0.0);
  scene.features.emplace_back(Footprint::round_box(50.0, 40.0, 70.0, 50.0, 10.0), Profile::wall(-8.0, 0.8, 0.3, 2.0));
  scene.features.emplace_back(Footprint::round_box(38.0, 44.0, 16.0, 10.0, 3.0, 25.0), Profile::wall(5.0, 0.3, 1.0, 0.0));
  scene.features.emplace_back(Footprint::disc(66.0, 34.0, 7.0), Profile::wall(-3.0));
  return scene;
}

Scene make_boss() {
  Scene scene = named("boss", "round, rectangular and conical bosses, one with a hole, one with a rounded edge", 0.0, 12.0);
  scene.features.emplace_back(Footprint::disc(25.0, 52.0, 14.0), Profile::wall(8.0, 0.5, 1.5, 0.5));
  scene.features.emplace_back(Footprint::disc(25.0, 52.0, 6.0), Profile::wall(-6.0));
  scene.features.emplace_back(Footprint::round_box(68.0, 56.0, 34.0, 20.0, 3.0, 15.0), Profile::wall(5.0, 0.0, 0.0, 1.0));
  scene.features.emplace_back(Footprint::disc(30.0, 19.0, 12.0),
                              Profile{{-12.0, 10.0}, {-10.0, 10.0, 2.0}, {0.0, 0.0, 1.0}, {3.0, 0.0}});
  scene.features.emplace_back(Footprint::round_box(72.0, 20.0, 30.0, 12.0, 6.0), Profile::wall(2.0, 2.0));
  return scene;
}

Scene make_ribs() {
  Scene scene = named("ribs", "ribs of 0.3 to 6 mm with flat, rounded and sharp tops, straight and oblique", 0.0, 7.0);
  scene.features.emplace_back(Footprint::strip(10.0, 0.0, 90.0, 0.4), Profile::wall(1.0));
  scene.features.emplace_back(Footprint::strip(20.0, 0.0, 90.0, 1.0), Profile::wall(0.3));
  scene.features.emplace_back(Footprint::strip(32.0, 0.0, 90.0, 2.0), Profile::wall(4.0, 0.2, 0.8, 0.5));
  scene.features.emplace_back(Footprint::strip(46.0, 0.0, 90.0, 3.0), vee(-4.0, 3.0));
  scene.features.emplace_back(Footprint::strip(58.0, 40.0, 80.0, 1.5), Profile::wall(3.0, 0.5));
  scene.features.emplace_back(Footprint::round_box(82.0, 60.0, 26.0, 3.0, 1.5, 45.0), Profile::wall(6.0, 0.4, 0.5, 0.4));
  scene.features.emplace_back(Footprint::round_box(84.0, 22.0, 24.0, 2.0, 0.0, 0.0), Profile::wall(2.0));
  scene.features.emplace_back(Footprint::round_box(84.0, 10.0, 24.0, 4.0, 2.0, 10.0), vee(-2.5, 2.0));
  return scene;
}

Scene make_fillets() {
  Scene scene = named("fillets", "steps and ramps rounded with radii of 0.5 to 8 mm, chamfers", -13.0, 0.0);
  scene.features.emplace_back(Footprint::half_plane(10.0, 0.0, 90.0), Profile::wall(-2.0, 0.0, 0.5, 0.5));
  scene.features.emplace_back(Footprint::half_plane(25.0, 0.0, 90.0), Profile::wall(-4.0, 0.0, 1.0, 2.0));
  scene.features.emplace_back(Footprint::half_plane(42.0, 0.0, 90.0), Profile::wall(-3.0, 3.0, 4.0, 4.0));
  scene.features.emplace_back(Footprint::half_plane(62.0, 40.0, 80.0), Profile::wall(-2.0, 6.0, 8.0, 8.0));
  scene.features.emplace_back(Footprint::half_plane(86.0, 40.0, 85.0),
                              Profile{{-5.0, -2.0}, {-2.0, -2.0, 0.5}, {-1.0, -1.0}, {0.0, 0.0}, {1.0, 0.0}}); // chamfer
  return scene;
}

Scene make_freeform() {
  Scene scene = named("freeform", "smooth free-form surface without a feature: domes, dents and waves", -3.0, 10.0);
  scene.base.slope_x = 0.02;
  scene.base.slope_y = -0.015;
  scene.base.add(Bump{38.0, 44.0, 46.0, 34.0, 20.0, 9.0});
  scene.base.add(Bump{72.0, 30.0, 26.0, 20.0, -35.0, 4.0});
  scene.base.add(Bump{24.0, 24.0, 18.0, 14.0, 0.0, -3.0});
  scene.base.add(Bump{64.0, 58.0, 14.0, 12.0, 0.0, -2.5});
  scene.base.add(Wave{0.0, 0.0, 15.0, 60.0, 0.8});
  scene.base.add(Wave{10.0, 0.0, 100.0, 37.0, 0.4});
  return scene;
}

} // namespace scansion
