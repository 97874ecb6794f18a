// Feature lines of two crossed scans: the better half of each, once, at the mean of both.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/crossed.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace scansion {
namespace {

constexpr double kStep = 0.1; // mm

FeatureLine line_of(std::uint64_t id, std::vector<std::array<double, 2>> places, FeatureType type = FeatureType::convex) {
  FeatureLine line;
  line.id = id;
  line.type = type;
  line.per_mm = 1000;
  line.elements[1] = 10;
  for (const auto& [x, y] : places) {
    line.vertices.push_back({{x, y, 0.0}, id, static_cast<std::uint32_t>(line.vertices.size())});
    const auto& v = line.vertices;
    if (v.size() > 1) line.length_mm += std::hypot(x - v[v.size() - 2].position[0], y - v[v.size() - 2].position[1]);
  }
  line.persistence = line.length_mm / (5.0 * kStep);
  return line;
}

/// A scan of 30 by 30 mm.
FoundByScan scan(std::array<double, 2> along, std::vector<FeatureLine> lines) {
  FoundByScan out{std::move(lines), along, kStep, {}};
  const double low = along[0] > 0.5 ? 0.0 : -30.0;
  for (int i = 0; i <= 300; ++i) out.scanned.push_back({low + 0.1 * i, 0.0, 30.0});
  return out;
}
FoundByScan along_x(std::vector<FeatureLine> lines) {
  return scan({1.0, 0.0}, std::move(lines));
}
FoundByScan along_y(std::vector<FeatureLine> lines) {
  return scan({0.0, 1.0}, std::move(lines));
}

double total(const CrossedLines& merged) {
  double mm = 0.0;
  for (const FeatureLine& line : merged.lines) mm += line.length_mm;
  return mm;
}

TEST(Crossed, ALineOfBothIsThereOnceAtTheirMean) {
  const CrossedLines merged =
      merge_crossed(along_x({line_of(7, {{5, 5}, {5, 25}})}), along_y({line_of(3, {{5.06, 25}, {5.06, 5}})}));
  ASSERT_EQ(merged.lines.size(), 1U);
  EXPECT_NEAR(merged.common_mm, 20.0, 0.2);
  EXPECT_NEAR(merged.lines[0].length_mm, 20.0, 0.2);
  for (const FeatureVertex& v : merged.lines[0].vertices) {
    EXPECT_NEAR(v.position[0], 5.03, 0.002);
    EXPECT_EQ(v.line, 7U) << "it crosses the lines of the first scan";
  }
}

TEST(Crossed, ACornerComesFromBothAndIsOneLine) {
  // Each scan has its half well, and the other one 0.1 mm off.
  const CrossedLines merged =
      merge_crossed(along_x({line_of(7, {{5, 5}, {5, 15}, {15, 15.1}})}), along_y({line_of(3, {{5.1, 5}, {5, 15}, {15, 15}})}));
  ASSERT_EQ(merged.lines.size(), 1U);
  EXPECT_NEAR(total(merged), 20.0, 0.4);
  const auto& v = merged.lines[0].vertices;
  EXPECT_TRUE(std::any_of(v.begin(), v.end(), [](const FeatureVertex& p) { return p.line == 7; }));
  EXPECT_TRUE(std::any_of(v.begin(), v.end(), [](const FeatureVertex& p) { return p.line == 3; }));
}

TEST(Crossed, PolaritiesAndHeightsStayApart) {
  FeatureLine high = line_of(4, {{5.05, 5}, {5.05, 25}});
  for (FeatureVertex& v : high.vertices) v.position[2] = 1.0;
  const CrossedLines merged = merge_crossed(along_x({line_of(1, {{5, 5}, {5, 25}})}),
                                            along_y({line_of(2, {{5, 5}, {5, 25}}, FeatureType::concave), high}));
  EXPECT_EQ(merged.common_mm, 0.0);
  EXPECT_EQ(merged.lines.size(), 1U + 2U);
}

TEST(Crossed, WhatTheOtherScanDeniesGoesUnlessItIsLong) {
  const std::vector<FeatureLine> doubtful{line_of(1, {{5, 5}, {5, 6.5}}), line_of(2, {{10, 5}, {10, 25}})};
  FoundByScan elsewhere{{line_of(9, {{100, 100}, {110, 100}})}, {0.0, 1.0}, kStep, {}};
  EXPECT_EQ(merge_crossed(along_x(doubtful), elsewhere).lines.size(), 3U) << "it did not look there";
  const CrossedLines merged = merge_crossed(along_x(doubtful), along_y({}));
  ASSERT_EQ(merged.lines.size(), 1U);
  EXPECT_NEAR(merged.lines[0].length_mm, 20.0, 0.01);
}

TEST(Crossed, ACoarseScanDeniesNothing) {
  FoundByScan coarse = along_y({});
  coarse.step_mm = 0.3;
  EXPECT_EQ(merge_crossed(along_x({line_of(1, {{5, 5}, {5, 6.5}})}), coarse).lines.size(), 1U);
}

TEST(Crossed, ClosedLinesAndNumbersStayRight) {
  FeatureLine ring = line_of(5, {{5, 5}, {15, 5}, {15, 15}, {5, 15}});
  ring.closed_loop = true;
  ring.partner = 8;
  FeatureLine inner = line_of(8, {{6, 6}, {14, 6}, {14, 14}, {6, 14}}, FeatureType::concave);
  inner.closed_loop = true;
  inner.partner = 5;
  const CrossedLines alone = merge_crossed(along_x({ring, inner}), FoundByScan{});
  ASSERT_EQ(alone.lines.size(), 2U);
  EXPECT_EQ(alone.lines[0].partner, alone.lines[1].id);
  EXPECT_EQ(alone.lines[1].partner, alone.lines[0].id);
  const CrossedLines both = merge_crossed(along_x({ring}), along_y({ring}));
  ASSERT_EQ(both.lines.size(), 1U) << "four sides, two of each scan";
  EXPECT_TRUE(both.lines[0].closed_loop);
}

TEST(Crossed, NothingAndNoise) {
  EXPECT_TRUE(merge_crossed({}, {}).lines.empty());
  FeatureLine point = line_of(1, {{5, 5}});
  FeatureLine same = line_of(2, {{7, 7}, {7, 7}, {7, 7}});
  FeatureLine none = line_of(3, {});
  const CrossedLines merged =
      merge_crossed(along_x({point, same, none, line_of(4, {{9, 5}, {9, 25}})}), along_y({point, same, none}));
  EXPECT_GE(merged.lines.size(), 1U);
}

} // namespace
} // namespace scansion
