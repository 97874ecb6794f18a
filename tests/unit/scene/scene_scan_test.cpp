// Scans: the same for the same seed, as many points as asked for, noise and faults as asked for.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/catalog.hpp"
#include "sim/scene/scanner.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numeric>

namespace scansion {
namespace {

SceneScanner scan(const char* name, const ScanPlan& plan) {
  auto scanner = SceneScanner::create(make_scene(name).value(), plan);
  EXPECT_TRUE(scanner) << scanner.error().context;
  return std::move(scanner).value();
}

std::vector<SceneLine> all_lines(const char* name, const ScanPlan& plan) {
  SceneScanner scanner = scan(name, plan);
  std::vector<SceneLine> lines;
  SceneLine line;
  while (scanner.next(line)) lines.push_back(line);
  return lines;
}

ScanPlan small(std::uint32_t lines, std::uint32_t points) {
  ScanPlan plan;
  plan.lines = lines;
  plan.points = points;
  return plan;
}

bool same(const std::vector<SceneLine>& a, const std::vector<SceneLine>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const SceneLine& l, const SceneLine& r) { return l.index == r.index && l.points == r.points; });
}

TEST(SceneScan, EverySceneGivesTheAskedCountTwiceTheSame) {
  for (const CatalogEntry& entry : scene_catalog()) {
    const std::string name(entry.name);
    ScanPlan plan = small(9, 57);
    plan.outliers = 0.05;
    plan.dropouts = 0.1;
    plan.jitter = 0.5;
    plan.noise_um = 3.0;
    const auto lines = all_lines(name.c_str(), plan);
    ASSERT_EQ(lines.size(), 9U);
    std::size_t samples = 0;
    for (const SceneLine& line : lines) samples += line.points.size();
    EXPECT_EQ(samples, 9U * 57U) << name;
    EXPECT_TRUE(same(lines, all_lines(name.c_str(), plan))) << name;
    plan.seed = 2;
    EXPECT_FALSE(same(lines, all_lines(name.c_str(), plan))) << name;
  }
}

TEST(SceneScan, PaperHasExactlyItsPoints) {
  const std::pair<std::uint64_t, double> cases[] = {{1, 5.0}, {2, 0.0}, {0xffffffffffffffffULL, 50.0}};
  for (const auto& [seed, noise] : cases) {
    ScanPlan plan;
    plan.seed = seed;
    plan.noise_um = noise;
    SceneScanner scanner = scan("paper", plan);
    EXPECT_EQ(scanner.geometry().pitch, 100.0);
    std::uint64_t points = 0;
    std::uint32_t lines = 0;
    std::size_t shortest = SIZE_MAX;
    std::size_t longest = 0;
    SceneLine line;
    while (scanner.next(line)) {
      ++lines;
      points += line.points.size();
      shortest = std::min(shortest, line.points.size());
      longest = std::max(longest, line.points.size());
    }
    EXPECT_EQ(lines, 1214U);
    EXPECT_EQ(points, 1'328'531U);
    EXPECT_EQ(scanner.counts().points, 1'328'531U);
    EXPECT_EQ(scanner.counts().lines, 1214U);
    EXPECT_GT(shortest, 700U);
    EXPECT_LT(longest, 1300U);
    EXPECT_GT(longest, shortest + 100U);
  }
}

TEST(SceneScan, PaperScalesToTheAskedSize) {
  const std::pair<ScanPlan, std::uint64_t> cases[] = {{small(100, 50), 5000}, {small(1, 1), 1}, {small(1214, 1), 1214}};
  for (const auto& [plan, want] : cases) {
    SceneScanner scanner = scan("paper", plan);
    SceneLine line;
    while (scanner.next(line)) {
    }
    EXPECT_EQ(scanner.counts().points, want);
  }
  ScanPlan half;
  half.lines = 607;
  EXPECT_EQ(scan("paper", half).geometry().samples, 1'328'531U / 2U);
}

TEST(SceneScan, RegularLinesStayRegular) {
  ScanPlan plan = small(5, 100);
  plan.noise_um = 0.0;
  const auto lines = all_lines("part", plan);
  for (const SceneLine& line : lines) {
    for (std::size_t k = 1; k < line.points.size(); ++k) {
      ASSERT_EQ(line.points[k].x - line.points[k - 1].x, 1000);
      ASSERT_EQ(line.points[k].y, line.points[0].y);
    }
  }
  EXPECT_EQ(lines[1].points[0].y - lines[0].points[0].y, 16000);
  EXPECT_EQ(lines.front().points.front().x, 500);
  EXPECT_EQ(lines.back().points.back().x, 99500);
}

TEST(SceneScan, DirectionTurnsTheLines) {
  ScanPlan plan = small(4, 11);
  plan.noise_um = 0.0;
  plan.direction_deg = 90.0;
  const auto lines = all_lines("plane", plan);
  for (const SceneLine& line : lines) {
    for (const ScenePoint& point : line.points) {
      EXPECT_EQ(point.x, line.points[0].x);
      EXPECT_EQ(point.z, std::lround(0.03 * point.x + 0.01 * point.y));
    }
    EXPECT_GT(line.points[1].y, line.points[0].y);
  }
  plan.direction_deg = 30.0;
  const auto oblique = all_lines("plane", plan);
  const ScenePoint& from = oblique[2].points.front();
  const ScenePoint& to = oblique[2].points.back();
  EXPECT_NEAR(static_cast<double>(to.y - from.y) / (to.x - from.x), std::tan(30.0 * 3.14159265358979 / 180.0), 1e-4);
}

TEST(SceneScan, NoiseHasItsSigmaAndCorrelation) {
  for (const double correlated : {0.0, 0.5, 3.0}) {
    ScanPlan plan = small(200, 1000);
    plan.noise_um = 20.0;
    plan.correlated_mm = correlated;
    const auto lines = all_lines("flat", plan);
    double squares = 0.0;
    double products = 0.0;
    double sum = 0.0;
    for (const SceneLine& line : lines) {
      for (std::size_t k = 0; k < line.points.size(); ++k) {
        sum += line.points[k].z;
        squares += static_cast<double>(line.points[k].z) * line.points[k].z;
        if (k > 0) products += static_cast<double>(line.points[k].z) * line.points[k - 1].z;
      }
    }
    EXPECT_NEAR(sum / 200000.0, 0.0, 1.5);
    EXPECT_NEAR(std::sqrt(squares / 200000.0), 20.0, 0.4) << correlated;
    const double want = correlated > 0.0 ? std::exp(-0.102 / correlated) : 0.0;
    EXPECT_NEAR(products / 199800.0 / (squares / 200000.0), want, 0.02) << correlated;
  }
}

TEST(SceneScan, DropoutsHaveTheirShareSinglyAndInBursts) {
  for (const double share : {0.02, 0.1, 0.4, 1.0}) {
    ScanPlan plan = small(100, 4000);
    plan.dropouts = share;
    SceneScanner scanner = scan("flat", plan);
    std::uint64_t singles = 0;
    std::uint64_t bursts = 0;
    SceneLine line;
    while (scanner.next(line)) {
      std::size_t length = 0;
      for (const ScenePoint& point : line.points) {
        if (point.state == SampleState::missing) {
          ++length;
          continue;
        }
        singles += length == 1 ? 1U : 0U;
        bursts += length > 1 ? 1U : 0U;
        length = 0;
      }
    }
    EXPECT_NEAR(static_cast<double>(scanner.counts().dropouts) / 400000.0, share, 0.05 * share + 1e-9) << share;
    EXPECT_EQ(scanner.counts().dropouts + scanner.counts().points, 400000U);
    if (share > 0.2) continue; // neighbours merge
    EXPECT_NEAR(static_cast<double>(singles) / (400000.0 * share), 0.5, 0.1) << share;
    EXPECT_GT(bursts, 100U);
  }
}

TEST(SceneScan, AFaultChangesNothingElse) {
  ScanPlan clean = small(20, 500);
  ScanPlan dirty = clean;
  dirty.outliers = 0.05;
  dirty.dropouts = 0.2;
  dirty.missing_lines = 0.3;
  const auto want = all_lines("part", clean);
  const auto got = all_lines("part", dirty);
  ASSERT_EQ(want.size(), got.size());
  std::size_t lost = 0;
  std::size_t outliers = 0;
  for (std::size_t i = 0; i < want.size(); ++i) {
    EXPECT_EQ(want[i].index, got[i].index);
    if (got[i].missing) {
      ++lost;
      EXPECT_TRUE(got[i].points.empty());
      continue;
    }
    ASSERT_EQ(want[i].points.size(), got[i].points.size());
    for (std::size_t k = 0; k < want[i].points.size(); ++k) {
      const ScenePoint& point = got[i].points[k];
      if (point.state == SampleState::measured) {
        ASSERT_EQ(point, want[i].points[k]);
      } else if (point.state == SampleState::outlier) {
        ++outliers;
        ASSERT_GE(std::abs(point.z - want[i].points[k].z), 299);
        ASSERT_LE(std::abs(point.z - want[i].points[k].z), 5001);
      }
    }
  }
  EXPECT_GT(lost, 1U);
  EXPECT_LT(lost, 14U);
  const double seen = static_cast<double>((want.size() - lost) * 500) * 0.8;
  EXPECT_NEAR(static_cast<double>(outliers) / seen, 0.05, 0.015);
}

TEST(SceneScan, JitterStaysWithinItsShareOfThePitch) {
  ScanPlan plan = small(20, 400);
  const auto regular = all_lines("plane", plan);
  plan.jitter = 0.6;
  const auto moved = all_lines("plane", plan);
  int most = 0;
  for (std::size_t i = 0; i < regular.size(); ++i) {
    for (std::size_t k = 0; k < regular[i].points.size(); ++k) {
      most = std::max(most, std::abs(moved[i].points[k].x - regular[i].points[k].x));
      if (k > 0) {
        ASSERT_GT(moved[i].points[k].x, moved[i].points[k - 1].x);
      }
    }
  }
  EXPECT_LE(most, 76); // pitch 250 um, half of 0.6
  EXPECT_GT(most, 70);
}

TEST(SceneScan, ZigzagTurnsOddLinesRound) {
  ScanPlan plan = small(6, 40);
  auto want = all_lines("part", plan);
  plan.zigzag = true;
  for (SceneLine& line : want) {
    if (line.index % 2 == 1) std::reverse(line.points.begin(), line.points.end());
  }
  EXPECT_TRUE(same(want, all_lines("part", plan)));
}

TEST(SceneScan, BacklashMovesWhatOddLinesTell) {
  ScanPlan plan = small(6, 40);
  plan.pitch_mm = 0.1;
  plan.noise_um = 0.0;
  const auto straight = all_lines("part", plan);
  plan.zigzag = true;
  plan.backlash_um = 200.0; // two samples
  const auto late = all_lines("part", plan);
  ASSERT_EQ(late.size(), straight.size());
  for (std::size_t i = 0; i < late.size(); ++i) {
    const auto& want = straight[i].points;
    auto got = late[i].points;
    if (i % 2 == 0) {
      EXPECT_EQ(got, want) << i;
      continue;
    }
    std::reverse(got.begin(), got.end());
    for (std::size_t k = 2; k < want.size(); ++k) {
      EXPECT_EQ(got[k].x, want[k].x);
      EXPECT_EQ(got[k].y, want[k].y);
      EXPECT_EQ(got[k].z, want[k - 2].z) << "line " << i << " sample " << k;
    }
  }
  plan.zigzag = false;
  const auto refused = SceneScanner::create(make_scene("part").value(), plan);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::usage);
}

TEST(SceneScan, AdversarialLinesAreWhatTheySay) {
  const ScanPlan plan = small(3, 1000);
  for (const SceneLine& line : all_lines("flat", plan)) {
    for (const ScenePoint& point : line.points) ASSERT_EQ(point.z, 0);
  }
  for (const SceneLine& line : all_lines("zigzag", plan)) {
    for (std::size_t k = 0; k < line.points.size(); ++k) ASSERT_EQ(line.points[k].z, k % 2 == 1 ? 1000 : 0);
  }
  for (const SceneLine& line : all_lines("two-step", plan)) {
    const auto up = std::count_if(line.points.begin(), line.points.end(), [](const ScenePoint& p) { return p.z == 5; });
    const auto down = std::count_if(line.points.begin(), line.points.end(), [](const ScenePoint& p) { return p.z == 0; });
    EXPECT_EQ(up + down, 1000);
    EXPECT_NEAR(static_cast<double>(up), 500.0, 70.0);
  }
}

} // namespace
} // namespace scansion
