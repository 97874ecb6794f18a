// Backlash of scans whose lines run to and fro: found, told, taken off, and left alone where nothing is sure.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/join_pieces.hpp"
#include "tests/unit/feature/scan.hpp"

#include <algorithm>
#include <gtest/gtest.h>

namespace scansion {
namespace {

/// Waves of flat faces that turn by 40 degrees, every edge slanted by 17 degrees from the way across.
double folded(double x, double y) {
  const double u = x - 0.3 * y;
  const double phase = u - 3.7 * std::floor(u / 3.7);
  return 0.36 * (phase < 1.9 ? phase : 3.8 - phase);
}

/// A pocket with upright slanted walls.
double pocket(double x, double y) {
  const double u = x - 0.2 * y;
  return u > 4.0 && u < 9.0 && y > 2.0 && y < 13.0 ? -1.0 : 0.36 * std::abs(std::remainder(u + 1.7, 6.0));
}

double plane(double x, double y) {
  return 0.1 * x + 0.05 * y;
}

const FeatureSettings kCorrect = [] {
  FeatureSettings settings;
  settings.backlash = BacklashUse::correct;
  return settings;
}();

double total(const FeatureReport& report) {
  double mm = 0.0;
  for (const FeatureLine& line : join_pieces(report.lines)) mm += line.length_mm;
  return mm;
}

TEST(Backlash, IsFoundToATenthOfAPitch) {
  for (const double mm : {0.0, 0.02, 0.05, 0.2, 0.5, -0.2}) {
    for (const auto& surface : {Surface(folded), Surface(pocket)}) {
      const auto found = Scan(surface, 10.0, 150).backlash(mm).run(64, {}, true).backlash;
      ASSERT_TRUE(found) << mm;
      EXPECT_NEAR(found->mm, mm, 0.01);
      EXPECT_GT(found->deviation_mm, 0.0);
      EXPECT_LT(found->deviation_mm, 0.03);
      EXPECT_EQ(found->taken_off_mm, 0.0) << "a report alone moves nothing";
    }
  }
}

TEST(Backlash, IsTakenOffAndLinesAreWhereTheyAre) {
  const double whole = total(Scan(folded, 10.0, 150).run(64, {}, true));
  const FeatureReport torn = Scan(folded, 10.0, 150).backlash(0.4).run(64, {}, true);
  const FeatureReport mended = Scan(folded, 10.0, 150).backlash(0.4).run(64, kCorrect, true);
  ASSERT_TRUE(mended.backlash);
  EXPECT_NEAR(mended.backlash->taken_off_mm, 0.4, 0.02);
  EXPECT_GT(total(torn), 1.5 * whole) << "every edge is there once for each direction";
  EXPECT_NEAR(total(mended), whole, 0.03 * whole);
  for (const FeatureLine& line : mended.lines) {
    for (const FeatureVertex& v : line.vertices) {
      const double u = v.position[0] - 0.3 * v.position[1];
      const double off = std::min(std::abs(std::remainder(u, 3.7)), std::abs(std::remainder(u - 1.9, 3.7)));
      EXPECT_LT(off, 0.1) << v.position[0] << ' ' << v.position[1]; // lines of the first direction stay
    }
  }
}

TEST(Backlash, ThatIsNotThereChangesNothing) {
  for (const auto& surface : {Surface(folded), Surface(pocket)}) {
    const FeatureReport told = Scan(surface, 20.0, 150).run(64, {}, true);
    const FeatureReport corrected = Scan(surface, 20.0, 150).run(64, kCorrect, true);
    EXPECT_EQ(told, corrected);
  }
}

TEST(Backlash, NeedsLinesToAndFro) {
  EXPECT_FALSE(Scan(folded, 10.0, 150).run(64).backlash);
  EXPECT_FALSE(Scan(folded, 10.0, 150).backlash(0.2).run(64, kCorrect, false).backlash);
}

TEST(Backlash, NeedsFeaturesThatCrossTheLines) {
  EXPECT_FALSE(Scan(plane, 20.0, 150).backlash(0.2).run(64, kCorrect, true).backlash);
  const auto along = [](double, double y) { return 0.36 * std::abs(std::remainder(y, 5.0)); };
  EXPECT_FALSE(Scan(along, 20.0, 150).backlash(0.2).run(64, kCorrect, true).backlash);
}

TEST(Backlash, IsTheSameForAnyGroups) {
  const FeatureReport whole = Scan(pocket, 20.0, 130).backlash(0.25).run(64, kCorrect, true);
  for (const std::uint32_t per_group : {1U, 7U}) {
    const FeatureReport parts = Scan(pocket, 20.0, 130).backlash(0.25).run(per_group, kCorrect, true);
    EXPECT_EQ(parts.lines, whole.lines) << per_group;
    EXPECT_EQ(parts.runs, whole.runs) << per_group;
    EXPECT_EQ(parts.backlash, whole.backlash) << per_group;
  }
}

} // namespace
} // namespace scansion
