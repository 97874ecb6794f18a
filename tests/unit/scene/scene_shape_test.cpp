// Outlines, cross-sections and the scenes made of them.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/catalog.hpp"
#include "sim/scene/footprint.hpp"
#include "sim/scene/profile.hpp"
#include "sim/scene/random.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <set>

namespace scansion {
namespace {

TEST(Footprints, DistancesAreExact) {
  const Footprint plane = Footprint::half_plane(10.0, 0.0, 90.0);
  EXPECT_DOUBLE_EQ(plane.distance(7.0, 55.0), 3.0);
  EXPECT_DOUBLE_EQ(plane.distance(14.0, -5.0), -4.0);
  const Footprint strip = Footprint::strip(0.0, 5.0, 0.0, 2.0);
  EXPECT_DOUBLE_EQ(strip.distance(100.0, 5.0), -2.0);
  EXPECT_DOUBLE_EQ(strip.distance(-3.0, 10.0), 3.0);
  const Footprint disc = Footprint::disc(3.0, 4.0, 1.0);
  EXPECT_DOUBLE_EQ(disc.distance(0.0, 0.0), 4.0);
  EXPECT_DOUBLE_EQ(disc.distance(3.0, 4.0), -1.0);
  const Footprint box = Footprint::round_box(0.0, 0.0, 20.0, 10.0, 2.0);
  EXPECT_DOUBLE_EQ(box.distance(0.0, 0.0), -5.0);
  EXPECT_DOUBLE_EQ(box.distance(10.0, 0.0), 0.0);
  EXPECT_DOUBLE_EQ(box.distance(8.0 + 3.0, 3.0 + 4.0), 3.0); // 5 from the centre of a corner of radius 2
  const Footprint turned = Footprint::round_box(0.0, 0.0, 20.0, 10.0, 2.0, 90.0);
  EXPECT_NEAR(turned.distance(-7.0, 11.0), 3.0, 1e-12);
}

// |grad d| = 1: between any two places the distance changes by at most their separation, and the box keeps its promise.
TEST(Footprints, AreDistancesAndFitTheirBox) {
  const Footprint shapes[] = {Footprint::half_plane(1.0, 2.0, 33.0), Footprint::strip(1.0, 2.0, -70.0, 1.5),
                              Footprint::disc(1.0, 2.0, 4.0), Footprint::round_box(1.0, 2.0, 9.0, 4.0, 2.0, 30.0),
                              Footprint::round_box(1.0, 2.0, 9.0, 4.0, 0.0, 110.0)};
  Random random(3, 0, 0);
  for (const Footprint& shape : shapes) {
    const Box box = shape.box(0.7);
    int within = 0;
    for (int k = 0; k < 20000; ++k) {
      const double x = -10.0 + 20.0 * random.uniform();
      const double y = -10.0 + 20.0 * random.uniform();
      const double dx = random.uniform() - 0.5;
      const double dy = random.uniform() - 0.5;
      const double d = shape.distance(x, y);
      ASSERT_LE(std::fabs(shape.distance(x + dx, y + dy) - d), std::sqrt(dx * dx + dy * dy) + 1e-12);
      if (d > 0.7) continue;
      ++within;
      ASSERT_TRUE(box.holds(x, y)) << x << ' ' << y;
    }
    EXPECT_GT(within, 100);
  }
}

TEST(Profiles, WallsJumpAndKeepTheirEnds) {
  const Profile wall = Profile::wall(-3.0);
  EXPECT_EQ(wall.height(-1e9), -3.0);
  EXPECT_EQ(wall.height(-1e-9), -3.0);
  EXPECT_EQ(wall.height(0.0), 0.0);
  EXPECT_EQ(wall.height(1e9), 0.0);
  EXPECT_EQ(wall.reach(), 0.0);
  const Profile draft = Profile::wall(2.0, 0.5);
  EXPECT_NEAR(draft.height(-0.25), 1.0, 1e-12);
  EXPECT_EQ(Profile{}.height(1.0), 0.0);
}

TEST(Profiles, FilletsAreTangentArcs) {
  // A right-angled foot of radius 2 at a vertical wall 5 high: a quarter circle.
  const Profile foot = Profile::wall(-5.0, 0.0, 0.0, 2.0);
  for (double d = -2.0; d < 0.0; d += 0.01) {
    EXPECT_NEAR(foot.height(d), -3.0 - std::sqrt(4.0 - (d + 2.0) * (d + 2.0)), 1e-12) << d;
  }
  EXPECT_EQ(foot.height(-2.5), -5.0);
  // A drafted wall with both edges rounded has neither a jump nor a crease.
  const Profile smooth = Profile::wall(-3.0, 3.0, 1.0, 2.0);
  constexpr double kStep = 1e-4;
  double slope = 0.0;
  for (double d = -6.0; d < 3.0; d += kStep) {
    const double next = (smooth.height(d + kStep) - smooth.height(d)) / kStep;
    ASSERT_NEAR(next, slope, 5e-4) << d;
    ASSERT_GE(next, -1e-9);
    slope = next;
  }
  EXPECT_EQ(smooth.height(smooth.reach()), 0.0);
  EXPECT_LT(smooth.height(smooth.reach() - 1e-3), 0.0);
}

TEST(Catalog, NamesAreUniqueAndFound) {
  std::set<std::string_view> names;
  for (const CatalogEntry& entry : scene_catalog()) {
    EXPECT_TRUE(names.insert(entry.name).second) << entry.name;
    const auto scene = make_scene(entry.name);
    ASSERT_TRUE(scene) << scene.error().context;
    EXPECT_EQ(scene.value().name, entry.name);
    EXPECT_FALSE(scene.value().summary.empty());
    EXPECT_EQ(scene.value().summary.find('\n'), std::string::npos);
  }
  for (const char* name : {"plane", "steps", "slots", "pocket", "boss", "ribs", "fillets", "freeform", "part", "paper", "flat",
                           "zigzag", "two-step"}) {
    EXPECT_TRUE(names.contains(name)) << name;
  }
  const auto unknown = make_scene("teapot");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, Errc::usage);
  EXPECT_NE(unknown.error().context.find("teapot"), std::string::npos);
  EXPECT_NE(unknown.error().context.find("freeform"), std::string::npos);
}

TEST(Catalog, RandomPartsAreMadeOfTheirNumber) {
  std::set<std::size_t> sizes;
  for (int part = 0; part < 40; ++part) {
    const std::string name = "random:" + std::to_string(part);
    const auto scene = make_scene(name), again = make_scene(name);
    ASSERT_TRUE(scene) << scene.error().context;
    EXPECT_EQ(scene.value().name, name);
    const Scene &a = scene.value(), &b = again.value();
    ASSERT_GE(a.features.size(), 3U) << name;
    ASSERT_EQ(a.features.size(), b.features.size());
    sizes.insert(a.features.size());
    for (int i = -16; i < 150; ++i) {
      for (int j = -16; j < 180; ++j) {
        const double x = 0.31 * j, y = 0.31 * i;
        const double z = a.relief(x, y);
        ASSERT_EQ(z, b.relief(x, y));
        ASSERT_GE(z, a.relief_low) << name << ' ' << x << ' ' << y;
        ASSERT_LE(z, a.relief_high) << name << ' ' << x << ' ' << y;
        // Forms touch no other one; one may stand on another's even middle.
        std::size_t sloping = 0;
        for (const Feature& feature : a.features)
          if (feature.box().holds(x, y))
            sloping += feature.profile().slope(feature.footprint().distance(x, y)) != 0.0 ? 1U : 0U;
        ASSERT_LE(sloping, 1U) << name << ' ' << x << ' ' << y;
      }
    }
  }
  for (int part = 0; part < 40; ++part) {
    const std::string name = "smooth:" + std::to_string(part);
    const auto scene = make_scene(name);
    ASSERT_TRUE(scene) << scene.error().context;
    const Scene& a = scene.value();
    EXPECT_EQ(a.name, name);
    EXPECT_TRUE(a.features.empty());
    EXPECT_EQ(a.length_x * a.length_y, 1200.0);
    for (int i = 0; i < 100; ++i) {
      for (int j = 0; j < 130; ++j) {
        // A curve of 6 mm radius lies 0.0075 mm off its chord of 0.6 mm.
        const double x = 0.31 * j, y = 0.31 * i, z = a.relief(x, y);
        ASSERT_LT(std::abs(a.relief(x - 0.3, y) + a.relief(x + 0.3, y) - 2.0 * z), 0.09 / 3.0) << name << ' ' << x << ' ' << y;
        ASSERT_GE(z, a.relief_low) << name;
        ASSERT_LE(z, a.relief_high) << name;
      }
    }
  }
  EXPECT_GT(sizes.size(), 3U);
  for (const char* wrong : {"random:", "random:-1", "random:1x", "random:99999999999999999999", "smooth:"}) {
    const auto none = make_scene(wrong);
    ASSERT_FALSE(none) << wrong;
    EXPECT_EQ(none.error().code, Errc::usage);
  }
}

// The ray of a leaning scan plane starts at the upper bound and stops at the lower one, so they must hold, and not by far.
TEST(Catalog, HeightsAreFiniteAndWithinTheirBounds) {
  for (const CatalogEntry& entry : scene_catalog()) {
    const Scene scene = entry.make();
    double low = 1e9;
    double high = -1e9;
    for (double y = -30.0; y < scene.length_y + 30.0; y += 0.37) {
      for (double x = -30.0; x < scene.length_x + 30.0; x += 0.37) {
        const double z = scene.relief(x, y);
        ASSERT_TRUE(std::isfinite(z)) << entry.name << ' ' << x << ' ' << y;
        low = std::min(low, z);
        high = std::max(high, z);
      }
    }
    EXPECT_GE(low, scene.relief_low) << entry.name;
    EXPECT_LE(high, scene.relief_high) << entry.name;
    EXPECT_LT(scene.relief_high - scene.relief_low, 2.0 * (high - low) + 1e-9) << entry.name << ' ' << low << ' ' << high;
  }
}

} // namespace
} // namespace scansion
