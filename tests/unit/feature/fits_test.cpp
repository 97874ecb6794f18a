// What fits are made of: turnings without angles, columns with holes, walls found row by row, edges of roundings.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/crosswise/column_rows.hpp"
#include "pipeline/feature/fit/rounding.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <random>

namespace scansion {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

Direction direction(double degrees) {
  return {std::cos(degrees * kDegree), std::sin(degrees * kDegree)};
}

TEST(Turning, comparesAsAnglesDo) {
  for (int before = -89; before <= 89; before += 8)
    for (int after = -89; after <= 89; after += 7) {
      const Turning turning = Turning::between(direction(before), direction(after));
      EXPECT_EQ(turning.clockwise(), after < before) << before << " " << after;
      for (const double limit : {0.5, 6.9, 40.3, 89.5, 120.2, 175.0})
        EXPECT_EQ(turning.exceeds(limit * kDegree), std::abs(after - before) > limit) << before << " " << after << " " << limit;
      EXPECT_NEAR(turning.tangent_of_half(), std::tan(0.5 * std::abs(after - before) * kDegree), 1e-9 / (turning.cosine + 1.0));
      const Turning wider = Turning::between(direction(-90), direction(after > before ? 90 : -90));
      if (after > before) {
        EXPECT_TRUE(turning.is_less_than(wider)) << before << " " << after;
        EXPECT_FALSE(wider.is_less_than(turning)) << before << " " << after;
      }
    }
}

TEST(Direction, ofSlopeHasItsAngle) {
  for (const double slope : {-1e6, -2.0, -0.1, 0.0, 0.3, 40.0})
    EXPECT_NEAR(Direction::of_slope(slope).angle(), std::atan(slope), 1e-12) << slope;
}

/// Rows of one column.
class OneColumn {
public:
  explicit OneColumn(std::vector<float> heights, const WallTest& test = WallTest(FitScale{})) : heights_(std::move(heights)) {
    rows_.set_test(test);
    for (std::size_t r = 0; r < heights_.size(); ++r) rows_.add({0.4 * static_cast<double>(r), &heights_[r], nullptr});
  }
  [[nodiscard]] const ColumnRows& rows() const { return rows_; }

private:
  std::vector<float> heights_;
  ColumnRows rows_;
};

TEST(Column, leavesOutHoles) {
  constexpr float kHole = std::numeric_limits<float>::quiet_NaN();
  const OneColumn one({1, 2, kHole, 4, kHole, kHole, 7, 8});
  Column column;
  column.take(one.rows(), 3, 3, 0, 10.0); // rows 0 to 6
  ASSERT_EQ(column.size(), 4U);
  EXPECT_EQ(column.heights().w[2], 14.0);
  EXPECT_EQ(column.heights().s[3], 0.4 * 6.0);
  EXPECT_EQ(column.index(3), 2U);
  EXPECT_EQ(column.index(4), 3U);        // the first one beyond
  column.take(one.rows(), 7, 1, 0, 0.0); // none there
  ASSERT_EQ(column.size(), 2U);
  EXPECT_EQ(column.index(7), 1U);
  EXPECT_EQ(column.heights().s[0], 0.4 * 6.0);
}

TEST(ColumnRows, findsTheWallsOfFindWalls) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> apart(6, 12), length(1, 10);
  std::uniform_real_distribution<double> rise(0.8, 3.0);
  FitScale scale = FitScale::of(0.005, 0.4, 0.4);
  int steps = 0;
  for (int round = 0; round < 200; ++round) {
    std::vector<float> heights(20, 0.0F);
    while (heights.size() < 60) {
      const double by = rise(random) * (round % 2 == 0 ? 1.0 : -1.0);
      for (int k = length(random); k-- > 0;) heights.push_back(heights.back() + static_cast<float>(by));
      heights.insert(heights.end(), static_cast<std::size_t>(apart(random)), heights.back());
    }
    heights.insert(heights.end(), 5, heights.back());
    const auto n = static_cast<std::int64_t>(heights.size());
    const OneColumn one(heights, WallTest(scale));
    Column column;
    column.take(one.rows(), n / 2, n, 0, 0.0);
    std::vector<WallRun> walls;
    find_walls(column.heights(), 0, column.size(), scale, walls);
    for (std::int64_t r = 0; r + 1 < n; ++r) {
      if (one.rows()[r].height[0] == one.rows()[r + 1].height[0]) continue;
      const auto starts = [&](const WallRun& w) { return w.step && w.first == r; };
      const auto holds = [&](const WallRun& w) { return w.step && w.first <= r && r < w.last; };
      EXPECT_EQ(one.rows().starts_step(r, 0), std::any_of(walls.begin(), walls.end(), starts)) << round << " " << r;
      const bool steep = one.rows().is_of_step(r, 0);
      if (!steep) continue;
      EXPECT_TRUE(std::any_of(walls.begin(), walls.end(), holds)) << round << " " << r;
      ++steps;
    }
  }
  EXPECT_GT(steps, 500);
}

/// From level to 45 degrees over an arc, at 0.1 mm; the two would meet at 0.
struct Fillet {
  std::vector<double> s, w;
  explicit Fillet(double radius) {
    const double tangent = radius * std::tan(22.5 * kDegree);
    for (int i = -120; i <= 120; ++i) {
      const double u = 0.1 * i;
      s.push_back(u);
      const bool arc = u > -tangent && u < tangent * std::cos(45.0 * kDegree);
      w.push_back(arc ? radius - std::sqrt(radius * radius - (u + tangent) * (u + tangent)) : std::max(0.0, u));
    }
  }
};

TEST(Rounding, edgeIsWhereItsFlanksMeet) {
  const FitScale scale = FitScale::of(0.002, 0.1, 0.1);
  const auto search = [&](double radius, RoundedEdge& edge) {
    const Fillet fillet(radius);
    const Turning corner = Turning::between(direction(10), direction(35));
    return find_rounding({fillet.s, fillet.w}, 120, 0, 240, 8, 0.05, corner, scale, edge);
  };
  for (const double radius : {0.8, 1.5, 2.5}) {
    RoundedEdge edge;
    ASSERT_EQ(search(radius, edge), RoundingSearch::edge) << radius;
    EXPECT_NEAR(edge.s, 0.0, 0.15) << radius;
    EXPECT_NEAR(edge.w, 0.0, 0.05) << radius;
    EXPECT_NEAR(edge.after.angle(), 45.0 * kDegree, 0.06) << radius;
    EXPECT_NEAR(edge.radius, radius, 0.4 * radius) << radius;
  }
  RoundedEdge edge;
  EXPECT_EQ(search(0.001, edge), RoundingSearch::none);
  EXPECT_EQ(search(4.5, edge), RoundingSearch::too_wide);
}

// A floor that meets a dome: a straight line through the dome's side would place the foot by its sagitta too far outside.
TEST(BentFlanks, footOfADomeIsWhereItStands) {
  constexpr double kNoise = 0.05, kPitch = 0.1, kRadius = 4.0;
  const FitScale scale = FitScale::of(kNoise, kPitch, kPitch);
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, kNoise);
  double bent = 0.0, straight = 0.0;
  constexpr int kRounds = 400;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> s, w, side;
    for (int i = -40; i <= 40; ++i) {
      const double u = kPitch * i; // the dome's middle lies at kRadius / sqrt(2), as deep below the floor
      const double x = u - kRadius * std::numbers::sqrt2 / 2.0;
      const double dome = std::sqrt(std::max(0.0, kRadius * kRadius - x * x)) - kRadius * std::numbers::sqrt2 / 2.0;
      s.push_back(u);
      w.push_back((u > 0.0 ? dome : 0.0) + noise(random));
    }
    // The same edge with its side straightened.
    side = w;
    for (std::size_t i = 41; i < s.size(); ++i) {
      const double x = s[i] - kRadius * std::numbers::sqrt2 / 2.0;
      side[i] += s[i] - (std::sqrt(kRadius * kRadius - x * x) - kRadius * std::numbers::sqrt2 / 2.0);
    }
    bent += fit_bend({s, w}, 40, 0, 80, scale.least_window, scale).s / kRounds;
    straight += fit_bend({s, side}, 40, 0, 80, scale.least_window, scale).s / kRounds;
  }
  EXPECT_NEAR(straight, 0.0, 0.02); // mm
  EXPECT_NEAR(bent, 0.0, 0.1);      // .20 by straight lines
}

// What bends as the edge turns is its rounding.
TEST(BentFlanks, roundingsMoveNoEdge) {
  const FitScale scale = FitScale::of(0.002, 0.1, 0.1);
  const Fillet fillet(0.3);
  EXPECT_NEAR(fit_bend({fillet.s, fillet.w}, 120, 0, 240, 12, scale).s, 0.0, 0.02);
}

constexpr Reach kWhole{0, 240, 0, 240};

// What a sharp edge is taken for without a search for flanks is what that search would leave of it.
TEST(SharpBend, isWhatFindBendFinds) {
  const FitScale scale = FitScale::of(0.002, 0.1, 0.1);
  const Fillet corner(0.0);
  const auto whole = find_bend({corner.s, corner.w}, 120, kWhole, scale);
  ASSERT_TRUE(whole);
  const Precedent precedent = Precedent::of(*whole, scale);
  EXPECT_TRUE(precedent.applies(false));
  EXPECT_FALSE(precedent.applies(true));
  const auto sharp = find_sharp_bend({corner.s, corner.w}, 120, {100, 140, 100, 140}, false, scale);
  ASSERT_TRUE(sharp);
  EXPECT_EQ(sharp->s, whole->s);
  EXPECT_EQ(sharp->w, whole->w);
  EXPECT_EQ(sharp->tau, whole->tau);
  EXPECT_EQ(sharp->sharpness, whole->sharpness);
  EXPECT_EQ(sharp->narrow_sharpness, whole->narrow_sharpness);
  EXPECT_EQ(sharp->window, whole->window);
}

TEST(SharpBend, isNoneWhereItTurnsTheOtherWayOrHardly) {
  const FitScale scale = FitScale::of(0.002, 0.1, 0.1);
  const Fillet corner(0.0);
  EXPECT_FALSE(find_sharp_bend({corner.s, corner.w}, 120, kWhole, true, scale));
  EXPECT_FALSE(find_sharp_bend({corner.s, corner.w}, 60, kWhole, false, scale));
  const Fillet wide(6.0);
  EXPECT_FALSE(find_sharp_bend({wide.s, wide.w}, 112, kWhole, false, scale));
}

// A rounding is no precedent, and a sharp edge is one for three more.
TEST(Precedent, endsAtTheFourth) {
  const FitScale scale = FitScale::of(0.002, 0.1, 0.1);
  const Fillet fillet(0.8);
  const auto rounded = find_bend({fillet.s, fillet.w}, 120, kWhole, scale);
  ASSERT_TRUE(rounded);
  EXPECT_GT(rounded->rounding, 0.0);
  EXPECT_FALSE(Precedent::of(*rounded, scale).applies(false));
  EXPECT_FALSE(Precedent().applies(false));
  Precedent precedent{true, false, 0};
  for (int times = 0; times < 3; ++times) {
    EXPECT_TRUE(precedent.applies(false));
    precedent = precedent.next();
  }
  EXPECT_FALSE(precedent.applies(false));
}

} // namespace
} // namespace scansion
