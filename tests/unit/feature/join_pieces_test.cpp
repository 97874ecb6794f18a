// Pieces of feature lines put together, damaged ones too.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/join_pieces.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace scansion {
namespace {

/// Vertices stand on the scan lines from `first` to `last`, whichever is larger.
FeatureLine piece_of(std::uint64_t id, std::int32_t piece, std::uint64_t first, std::uint64_t last) {
  FeatureLine line;
  line.id = id;
  line.piece = piece;
  const std::uint64_t count = first < last ? last - first : first - last;
  for (std::uint64_t k = 0; k <= count; ++k) {
    FeatureVertex v;
    v.line = first < last ? first + k : first - k;
    v.position[1] = static_cast<double>(v.line);
    line.vertices.push_back(v);
  }
  line.length_mm = static_cast<double>(count);
  line.scan_lines = count;
  line.elements[1] = static_cast<std::uint32_t>(count);
  line.begins = line.ends = FeatureEnd::open;
  return line;
}

std::vector<std::uint64_t> rows(const FeatureLine& line) {
  std::vector<std::uint64_t> out;
  for (const FeatureVertex& v : line.vertices) out.push_back(v.line);
  return out;
}

TEST(JoinPieces, StandInTheOrderOfTheirNumbers) {
  FeatureLine first = piece_of(4, -1, 0, 2), middle = piece_of(4, 0, 2, 4), last = piece_of(4, 1, 4, 5);
  first.begins = FeatureEnd::border;
  last.ends = FeatureEnd::death;
  middle.turning = {30.0, 0.0};
  const auto whole = join_pieces({middle, last, first});
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_EQ(rows(whole[0]), (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(whole[0].length_mm, 5.0);
  EXPECT_EQ(whole[0].scan_lines, 5U);
  EXPECT_EQ(whole[0].begins, FeatureEnd::border);
  EXPECT_EQ(whole[0].ends, FeatureEnd::death);
  EXPECT_DOUBLE_EQ(whole[0].turning.mean, 12.0);
  EXPECT_NEAR(whole[0].turning.deviation, std::sqrt(1080.0 / 4.0), 1e-9); // of 30, 30, 0, 0, 0
}

TEST(JoinPieces, LinesThatMetAreOne) {
  FeatureLine a = piece_of(1, 0, 0, 3), b = piece_of(2, 0, 0, 2), bridge = piece_of(1, 1, 3, 4);
  bridge.ends_at = LineEnd{2, true}; // at the last vertex of b, which is turned
  b.vertices.back() = bridge.vertices.back();
  const auto whole = join_pieces({a, b, bridge, piece_of(3, 0, 7, 9)});
  ASSERT_EQ(whole.size(), 2U);
  EXPECT_EQ(whole[0].id, 1U);
  EXPECT_EQ(rows(whole[0]), (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 1, 0}));
  EXPECT_FALSE(whole[0].closed_loop);
  EXPECT_EQ(whole[1].id, 3U);
}

TEST(JoinPieces, RingsCloseAndNothingRunsForEver) {
  FeatureLine a = piece_of(1, 0, 0, 3), b = piece_of(2, 0, 3, 5);
  a.ends_at = LineEnd{2, false};
  b.ends_at = LineEnd{1, false};
  auto whole = join_pieces({a, b});
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_TRUE(whole[0].closed_loop);
  EXPECT_EQ(rows(whole[0]), (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5}));

  a.ends_at = LineEnd{1, false}; // in itself
  whole = join_pieces({a});
  ASSERT_EQ(whole.size(), 1U);
  EXPECT_TRUE(whole[0].closed_loop);

  a.ends_at = LineEnd{1, true}; // the same end; one that is taken; a line that is not there
  b.begins_at = b.ends_at = LineEnd{1, false};
  FeatureLine c = piece_of(3, 0, 8, 9);
  c.begins_at = LineEnd{1, false};
  c.ends_at = LineEnd{99, true};
  whole = join_pieces({a, b, c});
  ASSERT_EQ(whole.size(), 2U);
  EXPECT_FALSE(whole[0].closed_loop);
  EXPECT_EQ(whole[1].id, 3U);
}

TEST(JoinPieces, NoVerticesAndNothing) {
  EXPECT_TRUE(join_pieces({}).empty());
  EXPECT_EQ(join_pieces({FeatureLine{}, FeatureLine{}}).size(), 1U);
}

} // namespace
} // namespace scansion
