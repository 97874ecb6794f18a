// Edges of walls: upright between roundings, with a draft, long and short, along and across the scan lines.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/feature/scan.hpp"

#include "pipeline/feature/fit/steps.hpp"
#include "pipeline/feature/patch/jumps.hpp"
#include "pipeline/feature/profile/rises.hpp"
#include "pipeline/feature/profile/spikes.hpp"
#include "pipeline/feature/rise_limit.hpp"

#include <gtest/gtest.h>

namespace scansion {
namespace {

using Section = std::function<double(double)>;

/// An upright wall at `place` from 0 up to 4 mm, its foot rounded by 2 mm and its top by 1 mm.
double rounded_wall(double s, double place) {
  const double u = s - place;
  if (u < -2.0) return 0.0;
  if (u < 0.0) return 2.0 - std::sqrt(4.0 - (u + 2.0) * (u + 2.0));
  if (u < 1.0) return 3.0 + std::sqrt(1.0 - (1.0 - u) * (1.0 - u));
  return 4.0;
}

constexpr double kDegree = 1.0 / 57.29577951308232;

/// A wall that leans from 0 at `place` up to 8 mm, its foot rounded by 2 mm.
double drafted_wall(double s, double place, double degrees) {
  constexpr double kRadius = 2.0;
  const double angle = degrees * kDegree, u = s - place, tangent = kRadius * std::tan(0.5 * angle);
  if (u < -tangent) return 0.0;
  if (u < tangent * std::cos(angle)) return kRadius - std::sqrt(kRadius * kRadius - (u + tangent) * (u + tangent));
  return std::min(8.0, std::tan(angle) * u);
}

struct Found {
  std::vector<FeaturePoint> edges;
  std::vector<WallRun> walls;
};

Found steps_of(const Section& surface, double pitch, double noise_mm) {
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0.0, noise_mm);
  std::vector<double> s, w;
  for (int k = 0; k * pitch < 20.0; ++k) {
    s.push_back(k * pitch);
    w.push_back(surface(s.back()) + noise(random));
  }
  Profile profile;
  profile.s = s;
  profile.w = w;
  std::vector<std::uint32_t> scratch;
  note_rises(profile, least_rise({noise_mm, pitch, pitch}), scratch);
  Found found;
  find_steps({s, w}, 0, static_cast<std::uint32_t>(s.size()), profile.rises, FitScale::of(noise_mm, pitch, pitch), found.edges,
             found.walls);
  return found;
}

// What is looked for among them is found there, whatever the noise; none leads from one run into the next.
TEST(Walls, RisesHoldAllThatSpikesWallsAndJumpsLookAt) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> height(-0.5, 0.5);
  std::vector<std::uint32_t> scratch;
  for (const double noise : {0.001, 0.005, 0.02, 0.05})
    for (const double pitch : {0.05, 0.1, 0.5}) {
      Profile profile;
      for (std::uint32_t k = 0; k < 400; ++k) {
        profile.s.push_back(k * pitch);
        profile.w.push_back(height(random));
      }
      profile.ends = {50, 51, 400};
      const Sampling sampling{noise, pitch, pitch};
      note_rises(profile, least_rise(sampling), scratch);
      const double least =
          std::min({spike_limit(noise), WallTest(noise, kLeastStep).weak, Jumps::least_rise(sampling, 0.5 * pitch)});
      EXPECT_LE(profile.rises_above, least);
      std::uint32_t begin = 0;
      for (const std::uint32_t end : profile.ends) {
        std::vector<std::uint32_t> expected;
        for (std::uint32_t k = begin; k + 1 < end; ++k)
          if (std::abs(profile.w[k + 1] - profile.w[k]) > profile.rises_above) expected.push_back(k);
        const auto found = rises_of(profile.rises, begin, end);
        EXPECT_EQ(std::vector<std::uint32_t>(found.begin(), found.end()), expected) << begin;
        begin = end;
      }
    }
}

TEST(Walls, UprightOnesBetweenRoundingsStandWhereTheyAreSteepest) {
  for (const double pitch : {0.1, 0.2, 0.5})
    for (const double place : {10.02, 10.05, 10.09}) {
      const Found found = steps_of([&](double s) { return rounded_wall(s, place); }, pitch, 0.005);
      ASSERT_EQ(found.edges.size(), 2U) << pitch << ' ' << place;
      for (const FeaturePoint& edge : found.edges) EXPECT_NEAR(edge.s, place, 0.5 * pitch + 1e-9) << pitch << ' ' << place;
      EXPECT_NEAR(found.edges[0].w, 0.0, 0.03);
      EXPECT_NEAR(found.edges[1].w, 4.0, 0.03);
    }
}

TEST(Walls, WithADraftAndFewSamplesTheyAreNotUpright) {
  // Less than two intervals wide: taken for upright, the foot is put 0.4 to 0.65 mm off. The sharp top is known to a pitch.
  for (const double place : {9.8, 9.85, 10.1, 10.15}) {
    const Found found = steps_of([&](double s) { return drafted_wall(s, place, 83.4); }, 0.5, 0.005);
    ASSERT_EQ(found.edges.size(), 2U) << place;
    EXPECT_NEAR(found.edges[0].s, place, 0.35) << place;
    EXPECT_NEAR(found.edges[1].s, place + 8.0 / std::tan(83.4 * kDegree), 0.55) << place;
  }
}

TEST(Walls, LongOnesAlongTheScanLinesHaveBothEdges) {
  // Fourteen lines lie on the wall: too many for a step.
  const FeatureReport report = Scan([](double, double y) { return drafted_wall(y, 8.0, 80.0); }, 5.0, 180).run(64);
  double foot = 0.0, top = 0.0;
  for (const FeatureLine& line : report.lines) {
    const std::size_t middle = line.vertices.size() / 2;
    if (std::abs(line.vertices[middle].position[1] - 8.0) < 0.15) foot += line.length_mm;
    if (std::abs(line.vertices[middle].position[1] - 9.41) < 0.15) top += line.length_mm;
  }
  EXPECT_GT(foot, 15.0);
  EXPECT_GT(top, 15.0);
}

TEST(Walls, WhatRoundsAnEdgeIsNoLineOfItsOwn) {
  const FeatureReport report = Scan([](double x, double) { return rounded_wall(x, 10.03); }, 20.0, 120).run(64);
  double other = 0.0, wall = 0.0;
  for (const FeatureLine& line : report.lines) {
    const double x = line.vertices[line.vertices.size() / 2].position[0];
    (std::abs(x - 10.03) < 0.15 ? wall : other) += line.length_mm;
  }
  EXPECT_GT(wall, 22.0);
  EXPECT_LT(other, 1.0);
}

// The noise takes single intervals of the slope above 70 degrees, and others below 54, which breaks it up.
TEST(Walls, SteepSlopesUnderNoiseAreNoSteps) {
  for (const double degrees : {62.0, 64.0, 65.0, 66.0})
    for (const double place : {4.0, 6.0, 8.0, 10.0, 12.0}) {
      const auto slope = [&](double s) { return std::clamp(std::tan(degrees * kDegree) * (s - place), 0.0, 12.0); };
      EXPECT_EQ(steps_of(slope, 0.1, 0.05).edges.size(), 0U) << degrees << ' ' << place;
    }
}

// A point of it is steep or not by its noise.
TEST(Walls, AtAboutFortyDegreesToTheLinesTheyStayWhole) {
  for (const double degrees : {38.0, 39.0, 40.0, 41.0}) {
    const double angle = degrees * kDegree;
    const auto wall = [&](double x, double y) {
      return std::sin(angle) * (x - 10.0) - std::cos(angle) * (y - 6.0) > 0.0 ? 0.0 : 3.0;
    };
    double longest = 0.0;
    for (const FeatureLine& line : Scan(wall, 5.0, 120).run(64).lines) longest = std::max(longest, line.length_mm);
    EXPECT_GT(longest, 14.0) << degrees;
  }
}

} // namespace
} // namespace scansion
