// Holes through parts, and what is missing without being one.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/join_pieces.hpp"
#include "pipeline/feature/patch/holes.hpp"
#include "tests/unit/feature/scan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace scansion {
namespace {

double flat(double, double) {
  return 0.0;
}
Nothing disc(double x0, double y0, double radius) {
  return [=](double x, double y) { return std::hypot(x - x0, y - y0) < radius; };
}
Nothing box(double x0, double x1, double y0, double y1) {
  return [=](double x, double y) { return x > x0 && x < x1 && y > y0 && y < y1; };
}

std::vector<Form> holes_in(const FeatureReport& report) {
  std::vector<Form> holes;
  for (const Form& form : report.forms)
    if (form.kind == FormKind::hole) holes.push_back(form);
  return holes;
}
/// A plate of 20 by 18 mm with nothing where `nothing` says so.
std::vector<Form> holes_of(const Nothing& nothing, const Surface& surface = flat) {
  return holes_in(Scan(surface, 5.0, 180).open(nothing).run(64));
}

TEST(Holes, HaveTheirPlaceAndSize) {
  const Surface slope = [](double x, double) { return 0.3 * x; };
  const FeatureReport report = Scan(slope, 5.0, 180).open(disc(8.03, 9.06, 3.0)).run(64);
  const std::vector<Form> holes = holes_in(report);
  ASSERT_EQ(holes.size(), 1U);
  ASSERT_TRUE(holes[0].hole);
  const HoleSize& size = *holes[0].hole;
  EXPECT_NEAR(size.middle[0], 8.03, 0.02);
  EXPECT_NEAR(size.middle[1], 9.06, 0.02);
  EXPECT_NEAR(size.middle[2], 0.3 * 8.03, 0.02);
  EXPECT_NEAR(size.diameter_mm(), 6.0, 0.03);
  EXPECT_NEAR(size.along_mm, 6.0, 0.11);
  EXPECT_NEAR(size.across_mm, 6.0, 0.11);
  EXPECT_GT(holes[0].confidence, 0.9);
  ASSERT_EQ(report.patches.size(), 1U);
  EXPECT_EQ(holes[0].patches, (std::vector<std::uint32_t>{report.patches[0].id}));
}

TEST(Holes, HaveARim) {
  const FeatureReport report = Scan(flat, 5.0, 180).open(disc(8.03, 9.06, 3.0)).run(64);
  const std::vector<Form> holes = holes_in(report);
  ASSERT_EQ(holes.size(), 1U);
  const auto rim = std::find_if(report.lines.begin(), report.lines.end(),
                                [&](const FeatureLine& line) { return line.id == holes[0].hole->rim; });
  ASSERT_NE(rim, report.lines.end());
  EXPECT_EQ(rim->type, FeatureType::step_top);
  EXPECT_TRUE(rim->closed_loop);
  EXPECT_EQ(rim->scan_lines, 60U);
  EXPECT_NEAR(rim->length_mm, 6.0 * 3.1416, 0.5);
  for (const FeatureVertex& v : rim->vertices) EXPECT_NEAR(std::hypot(v.position[0] - 8.03, v.position[1] - 9.06), 3.0, 0.1);
}

TEST(Holes, OfManyShapes) {
  const auto slanted = [](double x, double y) {
    const double a = 0.5 * (x - 10.0) + 0.866 * (y - 9.0), b = 0.5 * (y - 9.0) - 0.866 * (x - 10.0);
    return std::abs(a) < 5.0 && std::abs(b) < 0.6;
  };
  const auto angle = [](double x, double y) {
    return box(4.05, 14.05, 4.05, 6.05)(x, y) || box(12.05, 14.05, 4.05, 14.05)(x, y);
  };
  const auto bracket = [](double x, double y) {
    return box(4.05, 6.05, 4.05, 12.05)(x, y) || box(14.05, 16.05, 6.05, 12.05)(x, y) || box(4.05, 16.05, 10.05, 12.05)(x, y);
  };
  const std::vector<std::pair<Nothing, double>> shapes{
      {slanted, 12.0}, {angle, 36.0}, {bracket, 44.0}, {box(5.05, 5.55, 3.05, 12.05), 4.5}, {disc(6.0, 6.0, 0.4), 0.503}};
  for (const auto& [shape, area] : shapes) {
    const std::vector<Form> holes = holes_of(shape);
    ASSERT_EQ(holes.size(), 1U) << area;
    EXPECT_NEAR(holes[0].hole->area_mm2, area, 0.04 * area + 0.05);
  }
}

TEST(Holes, InCurvedSurfacesAndInTops) {
  const Surface dome = [](double x, double y) { return -0.02 * ((x - 10.0) * (x - 10.0) + (y - 9.0) * (y - 9.0)); };
  EXPECT_EQ(holes_of(disc(7.0, 8.0, 2.0), dome).size(), 1U);
  const Surface boss = [](double x, double y) { return std::hypot(x - 10.0, y - 9.0) < 6.0 ? 2.0 : 0.0; };
  const FeatureReport report = Scan(boss, 5.0, 180).open(disc(10.0, 9.0, 3.0)).run(64);
  EXPECT_EQ(holes_in(report).size(), 1U);
  EXPECT_EQ(std::count_if(report.forms.begin(), report.forms.end(), [](const Form& f) { return f.kind == FormKind::boss; }), 1);
}

TEST(Holes, AreNotWhatIsOpenToTheBorder) {
  EXPECT_TRUE(holes_of(box(5.0, 9.0, -1.0, 6.0)).empty());
  EXPECT_TRUE(holes_of(box(5.0, 9.0, 12.0, 99.0)).empty());
  EXPECT_TRUE(holes_of(box(-1.0, 9.0, 5.0, 9.0)).empty());
  EXPECT_TRUE(holes_of(box(5.0, 9.0, -1.0, 99.0)).empty());
}

TEST(Holes, AreNotShadows) {
  const Surface block = [](double x, double y) { return x < 9.0 && y > 4.0 && y < 14.0 ? 3.0 : 0.0; };
  EXPECT_TRUE(holes_of(box(8.9, 11.0, 4.0, 14.0), block).empty());
  const Surface ramp = [](double x, double y) { return x < 9.0 ? std::clamp(1.5 - 0.4 * std::abs(y - 9.0), 0.0, 1.5) : 0.0; };
  EXPECT_TRUE(holes_of(box(8.9, 10.5, 6.0, 12.0), ramp).empty());
}

TEST(Holes, AreNotRingsAroundAPin) {
  const auto ring = [](double x, double y) { return std::abs(std::hypot(x - 10.0, y - 9.0) - 3.0) < 0.8; };
  const auto island = [](double height) {
    return [height](double x, double y) { return std::hypot(x - 10.0, y - 9.0) < 3.0 ? height : 0.0; };
  };
  EXPECT_TRUE(holes_of(ring, island(4.0)).empty());
  EXPECT_EQ(holes_of(ring, island(-4.0)).size(), 1U); // a bore whose bottom is seen
}

TEST(Holes, AreNotSamplesThatAreLost) {
  for (const std::uint32_t seed : {1U, 2U, 3U, 4U})
    EXPECT_TRUE(holes_in(Scan(flat, 20.0, 180).seed(seed).lose(0.3).run(64)).empty());
  const auto bursts = [](double x, double y) { // 20 samples at random on each other line
    const double start = 43758.5453 * std::sin(12.9898 * std::round(10.0 * y));
    const double from = 18.0 * (start - std::floor(start));
    return x > from && x < from + 2.0;
  };
  EXPECT_TRUE(holes_of(bursts).empty());
  EXPECT_TRUE(holes_of([](double, double y) { return y > 5.0 && y < 5.4; }).empty()); // lines that are missing
}

TEST(Holes, AreFoundBetweenLostSamples) {
  const FeatureReport report = Scan(flat, 20.0, 180).lose(0.05).open(disc(8.0, 9.0, 3.0)).run(64);
  const std::vector<Form> holes = holes_in(report);
  ASSERT_EQ(holes.size(), 1U);
  EXPECT_NEAR(holes[0].hole->diameter_mm(), 6.0, 0.15);
}

TEST(Holes, AreTheSameForAnyGroupsAndLinesToAndFro) {
  const auto two = [](double x, double y) { return disc(6.0, 5.0, 2.0)(x, y) || disc(13.0, 8.0, 3.0)(x, y); };
  Scan scan(flat, 5.0, 180);
  scan.open(two);
  const FeatureReport whole = scan.run(64);
  ASSERT_EQ(holes_in(whole).size(), 2U);
  for (const std::uint32_t per_group : {1U, 7U, 40U}) EXPECT_EQ(holes_in(scan.run(per_group)), holes_in(whole)) << per_group;
  EXPECT_EQ(holes_in(scan.run(64, {}, true)).size(), 2U);
}

TEST(Holes, ARegionWithoutEndIsNone) {
  // Two endless slits need more than may be held; the hole after they ended is found.
  HoleFinder finder;
  PatchGraph graph;
  Sampling sampling;
  sampling.pitch = sampling.spacing = 0.1;
  sampling.noise = 0.005;
  const std::uint32_t patch = graph.create(0);
  graph.node(patch).real = true;
  constexpr std::int64_t kSlit = static_cast<std::int64_t>(HoleFinder::kMostSlabs) * 5 / 4;
  PatchRow above, now;
  std::vector<FoundHole> found;
  const std::vector<PatchSpan> spans{{1000, patch}};
  for (std::int64_t row = 0; row < kSlit + 100; ++row) {
    Profile profile;
    profile.c = 0.1 * static_cast<double>(row);
    for (std::uint32_t k = 0; k < 60; ++k) {
      const bool slit = row > 0 && row < kSlit && (k / 6 == 2 || k / 6 == 5);
      const bool hole = row > kSlit + 20 && row < kSlit + 30 && k / 8 == 2;
      if (slit || hole) continue;
      profile.s.push_back(0.1 * k);
      profile.w.push_back(0.0);
      profile.source.push_back(k);
    }
    profile.ends = {static_cast<std::uint32_t>(profile.s.size())};
    stand(profile, {0.1, 0.0});
    ASSERT_TRUE(now.take(profile));
    if (finder.wants(now)) finder.add({row > 0 ? &above : nullptr, spans}, {&now, spans}, row, 0.1, sampling);
    std::swap(above, now);
  }
  finder.tell(graph, 0, true, sampling, found);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].lines, 9U);
}

} // namespace
} // namespace scansion
