// Small parts, 30 to 44 mm, for judging feature lines: a scan of 0.1 mm has about 100,000 points.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/scenes.hpp"

#include "sim/scene/portable_math.hpp"

namespace scansion {
namespace {

Scene small(const char* name, const char* summary, double length_x, double length_y, double relief_low, double relief_high) {
  Scene scene;
  scene.name = name;
  scene.summary = summary;
  scene.length_x = length_x;
  scene.length_y = length_y;
  scene.points = static_cast<std::uint32_t>(round_half_up(length_x * 10.0));
  scene.lines = static_cast<std::uint32_t>(round_half_up(length_y * 10.0));
  scene.relief_low = relief_low;
  scene.relief_high = relief_high;
  return scene;
}

/// A V of `depth` (negative: a sharp ridge) in a footprint of half width `half`.
Profile vee(double depth, double half) {
  return Profile{{-half, -depth}, {0.0, 0.0}};
}

} // namespace

Scene make_terraces() {
  Scene scene = small("terraces", "steps of 0.3 to 2 mm: straight, oblique, along the scan and round", 36.0, 32.0, -5.0, 2.0);
  auto& features = scene.features;
  features.emplace_back(Footprint::half_plane(6.0, 0.0, 90.0), Profile::wall(-0.3));
  features.emplace_back(Footprint::half_plane(13.0, 0.0, 90.0), Profile::wall(-0.8));
  features.emplace_back(Footprint::half_plane(29.0, 16.0, 72.0), Profile::wall(-2.0, 0.2));
  features.emplace_back(Footprint::half_plane(18.0, 26.0, 0.0), Profile::wall(-1.0));
  features.emplace_back(Footprint::disc(20.5, 12.0, 4.5), Profile::wall(1.2));
  return scene;
}

Scene make_channels() {
  Scene scene =
      small("channels", "slots with square and round ends across, oblique to and along the scan", 38.0, 32.0, -3.0, 0.0);
  auto& features = scene.features;
  features.emplace_back(Footprint::strip(5.0, 0.0, 90.0, 1.2), Profile::wall(-1.0));
  features.emplace_back(Footprint::round_box(13.0, 16.0, 24.0, 4.0, 2.0, 90.0), Profile::wall(-2.0, 0.2));
  features.emplace_back(Footprint::round_box(27.0, 23.0, 15.0, 3.0, 0.0, 35.0), Profile::wall(-1.5));
  features.emplace_back(Footprint::round_box(27.0, 7.0, 15.0, 3.0, 1.5), Profile::wall(-1.0, 0.3));
  return scene;
}

Scene make_cavity() {
  Scene scene =
      small("cavity", "pocket with drafted walls and a floor fillet, in it an island and a round pit", 36.0, 32.0, -6.0, 0.0);
  auto& features = scene.features;
  features.emplace_back(Footprint::round_box(18.0, 16.0, 28.0, 23.0, 5.0), Profile::wall(-4.0, 0.4, 0.0, 0.8));
  features.emplace_back(Footprint::round_box(13.0, 17.5, 9.0, 7.0, 1.5, 25.0), Profile::wall(2.5, 0.2));
  features.emplace_back(Footprint::disc(24.5, 13.5, 3.5), Profile::wall(-1.5));
  return scene;
}

Scene make_posts() {
  Scene scene = small("posts", "round, rectangular and conical bosses, one with a bore, one chamfered", 36.0, 32.0, -1.0, 5.0);
  auto& features = scene.features;
  features.emplace_back(Footprint::disc(10.0, 22.5, 6.0), Profile::wall(3.0, 0.3, 0.5));
  features.emplace_back(Footprint::disc(10.0, 22.5, 2.8), Profile::wall(-2.0));
  features.emplace_back(Footprint::round_box(25.5, 23.0, 13.0, 9.0, 2.0, 15.0), Profile::wall(2.0, 0.0, 0.0, 0.4));
  features.emplace_back(Footprint::disc(10.0, 8.0, 5.5), Profile{{-5.5, 3.0}, {-2.5, 3.0}, {0.0, 0.0}});
  features.emplace_back(Footprint::round_box(25.5, 8.0, 14.0, 8.0, 4.0),
                        Profile{{-4.0, 1.5}, {-0.8, 1.5}, {0.0, 0.7}, {0.0, 0.0}, {0.5, 0.0}});
  return scene;
}

Scene make_rails() {
  Scene scene =
      small("rails", "ribs with flat, sharp and rounded tops, straight, oblique and along the scan", 44.0, 32.0, -1.0, 5.0);
  auto& features = scene.features;
  features.emplace_back(Footprint::strip(5.0, 0.0, 90.0, 1.2), Profile::wall(1.2));
  features.emplace_back(Footprint::strip(13.0, 0.0, 90.0, 2.5), vee(-2.0, 2.5));
  features.emplace_back(Footprint::strip(21.0, 16.0, 75.0, 1.3), Profile::wall(2.0, 0.3));
  features.emplace_back(Footprint::half_plane(30.0, 0.0, 90.0), Profile{{-2.5, 0.0}, {0.0, 2.0, 1.0}, {2.5, 0.0}});
  features.emplace_back(Footprint::round_box(38.5, 24.0, 9.0, 2.2, 0.0), Profile::wall(1.5));
  features.emplace_back(Footprint::round_box(38.5, 10.0, 13.0, 3.0, 1.5, 60.0), Profile::wall(1.0, 0.2));
  return scene;
}

Scene make_grooves() {
  Scene scene =
      small("grooves", "V grooves: straight, oblique, along the scan, in a ring, and a rounded one", 42.0, 32.0, -5.0, 0.0);
  auto& features = scene.features;
  features.emplace_back(Footprint::strip(5.0, 0.0, 90.0, 1.2), vee(1.2, 1.2));
  features.emplace_back(Footprint::strip(13.0, 16.0, 80.0, 2.0), vee(0.8, 2.0));
  features.emplace_back(Footprint::half_plane(22.0, 0.0, 90.0), Profile{{-2.5, 0.0}, {0.0, -2.0, 1.0}, {2.5, 0.0}});
  features.emplace_back(Footprint::disc(33.0, 19.0, 5.0), Profile{{-1.2, 0.0}, {0.0, -0.9}, {1.2, 0.0}});
  features.emplace_back(Footprint::strip(0.0, 5.0, 0.0, 1.5), vee(1.0, 1.5));
  return scene;
}

Scene make_edges() {
  Scene scene = small("edges", "edges with fillets of 0.5 to 6 mm and chamfers", 44.0, 30.0, -10.0, 0.0);
  auto& features = scene.features;
  features.emplace_back(Footprint::half_plane(6.0, 0.0, 90.0), Profile::wall(-1.5, 0.0, 0.5, 0.5));
  features.emplace_back(Footprint::half_plane(14.0, 0.0, 90.0), Profile::wall(-2.0, 1.5, 1.0, 1.0));
  features.emplace_back(Footprint::half_plane(24.0, 15.0, 80.0),
                        Profile{{-2.0, -2.0}, {0.0, -2.0}, {0.0, -1.2}, {1.2, 0.0}, {2.0, 0.0}});
  features.emplace_back(Footprint::half_plane(34.0, 15.0, 86.0), Profile::wall(-2.5, 4.0, 6.0, 6.0));
  return scene;
}

Scene make_dome() {
  Scene scene = small("dome", "curved surface that carries a pocket, a boss, a rib and a V groove", 38.0, 34.0, -5.0, 8.0);
  scene.base.add(Bump{19.0, 17.0, 30.0, 27.0, 15.0, 5.0});
  scene.base.add(Wave{0.0, 0.0, 30.0, 40.0, 0.3});
  auto& features = scene.features;
  features.emplace_back(Footprint::round_box(12.0, 24.0, 10.0, 8.0, 2.5, 20.0), Profile::wall(-1.5, 0.2));
  features.emplace_back(Footprint::disc(27.0, 23.0, 4.5), Profile::wall(1.5, 0.3));
  features.emplace_back(Footprint::round_box(10.0, 10.0, 13.0, 2.4, 1.2, 50.0), Profile::wall(1.2));
  features.emplace_back(Footprint::strip(25.0, 9.0, 20.0, 1.5), vee(1.1, 1.5));
  return scene;
}

Scene make_bracket() {
  Scene scene =
      small("bracket", "machined part with a step, pocket, boss, slot, rib, groove and chamfer", 44.0, 36.0, -7.0, 4.0);
  auto& features = scene.features;
  scene.base.slope_x = 0.01;
  scene.base.slope_y = -0.02;
  features.emplace_back(Footprint::round_box(13.0, 24.0, 17.0, 15.0, 3.0), Profile::wall(-3.0, 0.3, 0.0, 0.6));
  features.emplace_back(Footprint::disc(13.0, 24.0, 3.5), Profile::wall(2.0, 0.3));
  features.emplace_back(Footprint::disc(31.0, 25.0, 5.5), Profile::wall(2.5, 0.4, 0.6));
  features.emplace_back(Footprint::disc(31.0, 25.0, 2.5), Profile::wall(-3.0));
  features.emplace_back(Footprint::round_box(13.0, 9.5, 18.0, 3.0, 1.5, 10.0), Profile::wall(-1.5));
  features.emplace_back(Footprint::round_box(31.0, 12.0, 11.0, 2.4, 0.0, -35.0), Profile::wall(1.5, 0.2));
  features.emplace_back(Footprint::strip(0.0, 2.5, 4.0, 1.2), vee(0.8, 1.2));
  features.emplace_back(Footprint::half_plane(40.5, 18.0, 88.0),
                        Profile{{-1.0, -1.5}, {0.0, -1.5}, {0.0, -1.0}, {1.0, 0.0}, {2.0, 0.0}});
  return scene;
}

Scene make_star() {
  Scene scene = small("star", "spokes: grooves and ridges in twelve directions, 15 degrees apart", 40.0, 40.0, -1.2, 1.2);
  for (int k = 0; k < 12; ++k) {
    const double degrees = 30.0 * k + (k < 6 ? 0.0 : 15.0);
    const SinCos turn = portable_sincos_degrees(degrees);
    const double depth = k % 2 == 0 ? 1.0 : -1.0;
    scene.features.emplace_back(Footprint::round_box(20.0 + 13.0 * turn.cos, 20.0 + 13.0 * turn.sin, 11.0, 2.4, 1.2, degrees),
                                vee(depth, 1.2));
  }
  return scene;
}

Scene make_holes() {
  Scene scene = small("holes", "through holes: round, square and long ones, one in a pocket, one in a boss, one in a slope",
                      44.0, 36.0, -4.0, 4.0);
  scene.base.slope_x = 0.02;
  scene.base.add(Bump{37.0, 9.0, 14.0, 14.0, 0.0, 2.0});
  auto& features = scene.features;
  features.emplace_back(Footprint::round_box(11.0, 26.0, 14.0, 12.0, 2.0), Profile::wall(-2.0, 0.3));
  features.emplace_back(Footprint::disc(31.0, 26.0, 6.0), Profile::wall(2.5, 0.3));
  auto& holes = scene.holes;
  holes.push_back({Footprint::disc(11.0, 26.0, 2.5)});
  holes.push_back({Footprint::disc(31.0, 26.0, 3.0)});
  holes.push_back({Footprint::disc(6.0, 12.0, 1.5)});
  holes.push_back({Footprint::round_box(14.0, 12.0, 5.0, 5.0, 0.0)});
  holes.push_back({Footprint::round_box(22.0, 12.5, 4.0, 4.0, 0.0, 40.0)});
  holes.push_back({Footprint::round_box(12.0, 4.0, 14.0, 3.0, 1.5, 6.0)});
  holes.push_back({Footprint::round_box(28.0, 8.0, 10.0, 2.6, 1.3, 65.0)});
  holes.push_back({Footprint::disc(37.0, 9.0, 2.0)});
  return scene;
}

Scene make_smooth() {
  Scene scene = small("smooth", "smooth part without a feature, 1,200 mm^2", 40.0, 30.0, -2.0, 5.0);
  scene.base.slope_x = 0.03;
  scene.base.add(Bump{16.0, 16.0, 24.0, 18.0, 25.0, 3.5});
  scene.base.add(Bump{30.0, 9.0, 13.0, 11.0, -30.0, -1.6});
  scene.base.add(Wave{0.0, 0.0, 60.0, 24.0, 0.25});
  return scene;
}

} // namespace scansion
