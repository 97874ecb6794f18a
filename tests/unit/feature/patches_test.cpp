// What is told about patches: runs, merges, neighbours and forms fit together, and torn scans give no heap of slivers.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/feature/scan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace scansion {
namespace {

double slanted_pocket(double x, double y) {
  const double a = 0.8 * (x - 10.0) + 0.6 * (y - 9.0), b = 0.8 * (y - 9.0) - 0.6 * (x - 10.0);
  return std::abs(a) < 5.0 && std::abs(b) < 4.0 ? -1.5 : 0.0;
}
/// Echoes from anywhere: heights of neighbours have nothing to do with each other.
double torn(double x, double y) {
  const double mixed = 43758.5453 * std::sin(12.9898 * x + 78.233 * y);
  return 20.0 * (mixed - std::floor(mixed));
}
/// The same beside a sheet.
double half_torn(double x, double y) {
  return x < 10.0 ? 0.02 * x : torn(x, y);
}

/// The patch that the samples of `id` are in at the end.
std::uint32_t root_of(const FeatureReport& report, std::uint32_t id) {
  for (const PatchMerge& merge : report.merges)
    if (merge.from == id) id = merge.into; // merges come in the order in which they happen
  return id;
}

std::map<std::uint32_t, std::uint64_t> samples_told(const FeatureReport& report) {
  std::map<std::uint32_t, std::uint64_t> samples;
  for (const PatchRun& run : report.runs) samples[root_of(report, run.patch)] += run.count;
  return samples;
}

TEST(Patches, WhatIsToldFitsTogether) {
  for (const Surface& surface : {Surface(slanted_pocket), Surface(half_torn)}) {
    const FeatureReport report = Scan(surface, 20.0, 180).run(64);
    std::set<std::uint32_t> patches, told;
    for (const PatchRun& run : report.runs) told.insert(run.patch);
    for (const Patch& patch : report.patches) EXPECT_TRUE(patches.insert(patch.id).second) << patch.id;
    for (const PatchMerge& merge : report.merges) EXPECT_TRUE(told.contains(merge.from)) << merge.from;
    for (const auto& [id, samples] : samples_told(report)) EXPECT_TRUE(patches.contains(id)) << id;
    for (const Patch& patch : report.patches)
      for (const std::uint32_t other : patch.neighbours) EXPECT_TRUE(patches.contains(root_of(report, other))) << other;
    for (const Form& form : report.forms)
      for (const std::uint32_t part : form.patches) EXPECT_TRUE(patches.contains(root_of(report, part))) << part;
  }
}

TEST(Patches, SliversOfAPartGoToTheirNeighbours) {
  const FeatureReport report = Scan(slanted_pocket, 20.0, 180).run(64);
  EXPECT_EQ(report.patches.size(), 2U);
  std::uint64_t all = 0;
  for (const auto& [id, samples] : samples_told(report)) all += samples;
  EXPECT_EQ(all, 180U * 200U);
}

// Where a round corner lies along the scan lines its border goes from one pass to the other: the first lines of the pocket
// touch the plate over a few columns beside it.
TEST(Patches, PocketsWithRoundCornersDoNotLeak) {
  constexpr double kRadius = 1.0, kWall = 0.3, kDepth = 1.5;
  for (int turned = 26; turned < 64; turned += 2) {
    const double angle = turned / 57.29577951308232, cosine = std::cos(angle), sine = std::sin(angle);
    const auto pocket = [=](double x, double y) {
      const double a = std::abs(cosine * (x - 10.0) + sine * (y - 9.0)) - 4.0 + kRadius;
      const double b = std::abs(cosine * (y - 9.0) - sine * (x - 10.0)) - 3.0 + kRadius;
      const double inside = kRadius - std::hypot(std::max(a, 0.0), std::max(b, 0.0)) - std::min(0.0, std::max(a, b));
      return -std::clamp(inside * kDepth / kWall, 0.0, kDepth);
    };
    const FeatureReport report = Scan(pocket, 5.0, 180).run(64);
    std::uint64_t floor = 36'000; // all there are
    for (const auto& [id, samples] : samples_told(report))
      if (samples > 1000) floor = std::min(floor, samples);
    EXPECT_GT(floor, 3600U) << turned; // the floor itself: about 4,000
    EXPECT_LT(floor, 5000U) << turned;
  }
}

// Where the wall of a round boss lies along the scan lines, a line may run on the wall a little below the top all the way
// across: the top's edge cuts the lines apart there, though the wall's own steep intervals are already behind.
TEST(Patches, TheTopOfARoundBossDoesNotLeak) {
  constexpr double kRadius = 5.6, kWall = 0.4, kHeight = 2.0; // mm
  for (int shift = 0; shift < 10; ++shift) {
    const auto boss = [=](double x, double y) {
      const double outside = std::hypot(x - 10.0, y - 9.0 - 0.01 * shift) - kRadius;
      return kHeight * (1.0 - std::clamp(outside / kWall, 0.0, 1.0)) + 0.1 * x;
    };
    std::uint64_t most = 0;
    for (const auto& [id, samples] : samples_told(Scan(boss, 5.0, 180).run(64))) most = std::max(most, samples);
    EXPECT_LT(most, 27'000U) << shift; // the plate has 24,700, the top 9,850
  }
}

// A groove that ends shortly before the scan does parts nothing: both sides lie on one surface. Beside a step of the same
// length they do not.
TEST(Patches, OneSurfaceAroundTheEndOfAGroove) {
  constexpr double kEnd = 16.0; // mm, of 18
  const auto largest = [](const Surface& surface) {
    std::uint64_t most = 0;
    for (const auto& [id, samples] : samples_told(Scan(surface, 5.0, 180).run(64))) most = std::max(most, samples);
    return most;
  };
  const auto groove = [](double x, double y) {
    const double depth = 0.4 * std::min(1.0, kEnd - y), half = 0.12; // mm: a sample or two of it on each line
    return -std::max(0.0, depth - 0.4 / half * std::abs(x - 9.0 - 0.03 * y));
  };
  EXPECT_GT(largest(groove), 34'000U); // of 36,000
  const auto step = [](double x, double y) { return x > 9.0 && y < kEnd ? 1.0 : 0.0; };
  EXPECT_LT(largest(step), 25'000U);
}

// A block takes most of the width: what passes it on both sides is the base behind it.
TEST(Patches, TheBaseGoesOnBehindAWideBlock) {
  constexpr double kWall = 0.3; // mm in plan
  const auto block = [](double x, double y) {
    const double inside = std::min(8.0 - std::abs(x - 10.0), 4.0 - std::abs(y - 8.0));
    return std::clamp(inside / kWall, 0.0, 1.0);
  };
  std::uint64_t most = 0;
  for (const auto& [id, samples] : samples_told(Scan(block, 5.0, 180).run(64))) most = std::max(most, samples);
  EXPECT_GT(most, 22'000U); // the base has 23,200; what lies behind the block 12,000
  EXPECT_LT(most, 24'000U);
}

TEST(Patches, ATornScanHasNone) {
  const FeatureReport report = Scan(torn, 5.0, 300).run(64);
  EXPECT_LE(report.patches.size(), 3U);
  EXPECT_LE(report.runs.size(), 300U); // of 60,000 samples
}

TEST(Patches, ASheetBesideEchoesFromAnywhereIsFound) {
  const FeatureReport report = Scan(half_torn, 5.0, 300).run(64);
  std::map<std::uint32_t, std::uint32_t> votes; // of the middle of the sheet, line by line
  for (const PatchRun& run : report.runs)
    if (run.first <= 50 && run.first + run.count > 50) ++votes[root_of(report, run.patch)];
  ASSERT_EQ(votes.size(), 1U);
  EXPECT_EQ(votes.begin()->second, 300U);
}

TEST(Patches, ALineThatReachesTooFarIsNoPartOfOne) {
  Feed feed;
  FeatureReport report;
  for (std::int32_t i = 0; i < 60; ++i) {
    LineBuffer line;
    for (std::int32_t k = 0; k < 200; ++k) {
      line.xyz[0].push_back(k < 199 || i != 30 ? 100 * k : 900'000'000); // one point 900 m away
      line.xyz[1].push_back(100 * i);
      line.xyz[2].push_back((k * 7919 + i * 104'729) % 11);
    }
    line.runs.push_back({0, 200, 0});
    feed.add(line, report);
  }
  feed.finish(report);
  ASSERT_EQ(report.patches.size(), 1U);
  EXPECT_EQ(report.patches.front().samples, 59U * 200U);
}

} // namespace
} // namespace scansion
