// Feature lines that never end: bounded memory, pieces that make one line, the same for any grouping.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/join_pieces.hpp"
#include "tests/unit/feature/scan.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <malloc.h>
#include <map>

namespace scansion {
namespace {

double groove(double x, double) {
  return std::min(0.0, std::abs(x - 2.0) - 1.0);
}
/// A channel that begins at y = 3, winds and never ends: one edge with two endless legs.
double channel(double x, double y) {
  const double middle = 5.0 + 1.5 * std::sin(0.1 * y);
  return y > 3.0 && std::abs(x - middle) < 2.0 ? -1.0 : 0.0;
}
/// The same with an end: one closed edge.
double long_pocket(double x, double y) {
  return y < 160.0 ? channel(x, y) : 0.0;
}

std::vector<FeatureLine> longest(std::vector<FeatureLine> lines, double least_mm) {
  std::erase_if(lines, [&](const FeatureLine& line) { return line.length_mm < least_mm; });
  return lines;
}

TEST(EndlessScan, MemoryDoesNotGrow) {
  const bool full = std::getenv("SCANSION_LONG") != nullptr; // NOLINT(concurrency-mt-unsafe): no other thread
  const std::uint32_t lines = full ? 200'000 : 20'000, settled = 4'000;
  FeatureReport report;
  std::vector<FeatureLine> pieces;
  std::size_t early = 0, late = 0;
  Scan(groove, 5.0, lines, 40).run(50, {}, false, report, [&](std::uint32_t line) {
    for (FeatureLine& piece : report.lines) {
      EXPECT_LT(piece.vertices.size(), 4096U);
      pieces.push_back(std::move(piece));
    }
    report.clear();
    const std::size_t held = mallinfo2().uordblks;
    (line < settled ? early : late) = std::max(line < settled ? early : late, held);
  });
  for (FeatureLine& piece : report.lines) pieces.push_back(std::move(piece));
  EXPECT_GT(pieces.size(), lines / 1000);
  // What the test itself keeps: the pieces.
  std::size_t kept = pieces.capacity() * sizeof(FeatureLine);
  for (const FeatureLine& piece : pieces) kept += piece.vertices.capacity() * sizeof(FeatureVertex) + 64;
  // A point of a track takes 200 bytes, and three lines get one each on every scan line; patches keep some as well.
  EXPECT_LT(late, early + kept + std::size_t{200} * lines);

  const std::vector<FeatureLine> whole = join_pieces(std::move(pieces));
  std::map<FeatureType, std::size_t> types;
  for (const FeatureLine& line : longest(whole, 1.0)) {
    ++types[line.type];
    EXPECT_NEAR(line.length_mm, 0.1 * lines, 3.0 + 1e-4 * lines); // noise makes it longer
    EXPECT_NEAR(static_cast<double>(line.scan_lines), lines, 20.0);
    std::uint64_t before = line.vertices.front().line;
    for (const FeatureVertex& v : line.vertices) {
      EXPECT_GE(v.line, before);
      before = v.line;
    }
  }
  EXPECT_EQ(types, (std::map<FeatureType, std::size_t>{{FeatureType::convex, 2}, {FeatureType::concave, 1}}));
}

TEST(EndlessScan, BothLegsOfAnEdgeAreOneLine) {
  const FeatureReport report = Scan(channel, 5.0, 4'000, 100).run(64);
  EXPECT_TRUE(std::any_of(report.lines.begin(), report.lines.end(), [](const FeatureLine& line) { return line.piece < 0; }));
  const auto whole = longest(join_pieces(report.lines), 10.0);
  ASSERT_EQ(whole.size(), 2U);
  for (const FeatureLine& line : whole) EXPECT_GT(line.length_mm, 790.0);
}

TEST(EndlessScan, ALongEdgeCloses) {
  const FeatureReport report = Scan(long_pocket, 5.0, 1'700, 100).run(64);
  const auto whole = longest(join_pieces(report.lines), 10.0);
  ASSERT_EQ(whole.size(), 2U);
  for (const FeatureLine& line : whole) {
    EXPECT_TRUE(line.closed_loop);
    const auto &a = line.vertices.front().position, &b = line.vertices.back().position;
    EXPECT_NEAR(std::hypot(a[0] - b[0], a[1] - b[1]), 0.0, 1e-3);
  }
}

TEST(EndlessScan, GroupsDoNotChangePieces) {
  const FeatureReport whole = Scan(channel, 20.0, 3'000, 100).run(64);
  for (const std::uint32_t per_group : {1U, 100U, 3'000U})
    EXPECT_EQ(Scan(channel, 20.0, 3'000, 100).run(per_group).lines, whole.lines) << per_group;
}

TEST(EndlessScan, LinesWithoutPointsAndATableAtRestCostNothing) {
  Feed feed;
  FeatureReport report;
  std::size_t early = 0, late = 0;
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    LineBuffer line;
    if (i >= 5'000) { // at rest from here on: it creeps by 1 um a hundred lines
      for (std::int32_t k = 0; k < 60; ++k) {
        line.xyz[0].push_back(100 * k);
        line.xyz[1].push_back(static_cast<std::int32_t>(i < 6'000 ? 100 * i : 600'000 + i / 100));
        line.xyz[2].push_back(k < 30 ? 0 : 1000);
      }
      line.runs.push_back({0, 60, 0});
    }
    feed.add(line, report);
    if ((i + 1) % 50 != 0) continue;
    feed.close(report);
    report.clear();
    const std::size_t held = mallinfo2().uordblks;
    (i < 7'000 ? early : late) = std::max(i < 7'000 ? early : late, held);
  }
  EXPECT_LT(late, early + 500'000U); // a line takes 5,000 bytes
}

} // namespace
} // namespace scansion
