// The loops over all samples: against their definitions, and both versions against each other.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/passes/column_passes.hpp"
#include "pipeline/feature/passes/fastest.hpp"
#include "pipeline/feature/passes/passes.hpp"

#include "pipeline/feature/fit/steps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace scansion {
namespace {

// Lengths around those of vectors and blocks.
constexpr std::size_t kMost = 133;

template <typename T>
std::vector<T> values(std::size_t n, unsigned seed) {
  constexpr T kFar = std::numeric_limits<T>::infinity(), kNone = std::numeric_limits<T>::quiet_NaN();
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> step(-3, 3), rare(0, 40);
  std::vector<T> out(n);
  for (T& value : out) {
    value = static_cast<T>(step(random));
    const int which = rare(random);
    if (which < 3) value = which == 0 ? kFar : which == 1 ? -kFar : kNone;
  }
  return out;
}

template <typename T>
void expect_apart(T limit) {
  for (std::size_t n = 0; n < kMost; ++n) {
    const auto a = values<T>(n, 1), b = values<T>(n, 2);
    std::vector<std::uint32_t> expected, found(n), portable(n);
    for (std::size_t k = 0; k < n; ++k)
      if (std::abs(a[k] - b[k]) > limit) expected.push_back(static_cast<std::uint32_t>(k));
    found.resize(passes::apart(a.data(), b.data(), limit, found.data(), n));
    portable.resize(passes::portable::apart(a.data(), b.data(), limit, portable.data(), n));
    EXPECT_EQ(found, expected) << n;
    EXPECT_EQ(portable, expected) << n;
  }
}

TEST(Passes, FindWhatIsApart) {
  for (const double limit : {0.0, 1.0, 2.5, 100.0}) expect_apart<double>(limit);
  for (const float limit : {0.0F, 1.0F, 2.5F, 100.0F}) expect_apart<float>(limit);
}

TEST(Passes, FindWhereColumnsBendMost) {
  constexpr float kLeast = 2.0F;
  for (std::size_t n = 0; n < kMost; ++n) {
    std::vector<std::vector<float>> rows;
    rows.reserve(5);
    for (int k = 0; k < 5; ++k) rows.push_back(values<float>(n, 7 + static_cast<unsigned>(k)));
    for (auto& row : rows)
      for (std::size_t k = 0; k < n; k += 5) row[k] = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t own = 0; own < rows.size(); ++own) {
      std::vector<const float*> before, after;
      for (std::size_t k = 0; k < rows.size(); ++k)
        if (k != own) (k < own ? before : after).push_back(rows[k].data());
      std::vector<std::uint32_t> expected, found(n), portable(n);
      for (std::size_t k = 0; k < n; ++k) {
        const float bend = rows[own][k];
        bool most = std::abs(bend) >= kLeast;
        for (std::size_t other = 0; other < rows.size(); ++other) {
          const float same_way = bend < 0.0F ? -rows[other][k] : rows[other][k];
          if (other < own && same_way >= std::abs(bend)) most = false;
          if (other > own && same_way > std::abs(bend)) most = false;
        }
        if (most) expected.push_back(static_cast<std::uint32_t>(k));
      }
      // As weigh() has them of a single row: few blocks bend.
      std::vector<float> same(n), peaks(passes::peaks_of(n));
      const float* const row = rows[own].data();
      constexpr float kOnce = 1.0F;
      passes::weigh(&row, &kOnce, 1, same.data(), peaks.data(), n);
      const passes::BendRows look{row, peaks.data(), before, after};
      found.resize(passes::most_bent(look, kLeast, found.data(), n));
      portable.resize(passes::portable::most_bent(look, kLeast, portable.data(), n));
      EXPECT_EQ(found, expected) << n;
      EXPECT_EQ(portable, expected) << n;
    }
  }
}

TEST(Passes, MarkEveryColumnWhereAWallMayStart) {
  const WallTest test(0.005, FeatureLimits{}.least_step);
  constexpr double kSpacing = 0.2;
  const passes::WallLimits limits{static_cast<float>(test.least_rise(kSpacing)), static_cast<float>(test.steep_rise(kSpacing)),
                                  static_cast<float>(WallTest::kLonely)};
  std::mt19937 random(5);
  std::uniform_int_distribution<int> size(0, 9), rare(0, 30);
  std::size_t walls = 0, clear = 0;
  for (std::size_t n = 0; n < kMost; ++n) {
    std::array<std::vector<float>, 4> rows;
    for (auto& row : rows)
      for (std::size_t k = 0; k < n; ++k)
        row.push_back(rare(random) == 0 ? std::numeric_limits<float>::quiet_NaN() : 0.125F * static_cast<float>(size(random)));
    std::vector<std::uint32_t> marks(n, 7);
    const bool any =
        passes::mark_walls({rows[0].data(), rows[1].data(), rows[2].data(), rows[3].data()}, limits, 9, marks.data(), n);
    EXPECT_EQ(any, std::find(marks.begin(), marks.end(), 9U) != marks.end()) << n;
    for (std::size_t k = 0; k < n; ++k) {
      const auto rise = [&](std::size_t row) {
        return static_cast<double>(rows[row + 1][k]) - static_cast<double>(rows[row][k]);
      };
      const bool may =
          !(std::abs(rise(1)) <= test.least_rise(kSpacing)) && test.stands_out(kSpacing, rise(1), rise(0), rise(2));
      EXPECT_EQ(marks[k] == 9, may || std::isnan(rise(1))) << n << ' ' << k;
      ++(marks[k] == 9 ? walls : clear);
    }
  }
  EXPECT_GT(walls, 1000U);
  EXPECT_GT(clear, 1000U);
}

TEST(Passes, FindWhatReachesALimit) {
  for (std::size_t n = 0; n < kMost; ++n) {
    const auto all = values<double>(n, 3);
    std::vector<std::uint32_t> expected, found(n), portable(n);
    for (std::size_t k = 0; k < n; ++k)
      if (all[k] >= 1.0) expected.push_back(static_cast<std::uint32_t>(k));
    found.resize(passes::reaching(all.data(), 1.0, found.data(), n));
    portable.resize(passes::portable::reaching(all.data(), 1.0, portable.data(), n));
    EXPECT_EQ(found, expected) << n;
    EXPECT_EQ(portable, expected) << n;
  }
}

TEST(Passes, ProjectStraightAsAnyOther) {
  std::mt19937 random(8);
  std::uniform_int_distribution<std::int32_t> count(-2'000'000'000, 2'000'000'000);
  constexpr std::array<passes::Projection, 3> kStraight{{{0.001, {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}},
                                                         {0.0254, {0.0, -1.0, 0.0}, {0.0, 0.0, 1.0}},
                                                         {0.001, {1.0, 0.0, 0.0}, {0.0, 0.0, 0.75}}}};
  for (std::size_t n = 0; n < kMost; ++n) {
    std::array<std::vector<std::int32_t>, 3> xyz;
    for (auto& axis : xyz) {
      axis.resize(n);
      for (std::int32_t& value : axis) value = count(random);
    }
    for (const passes::Projection& straight : kStraight) {
      std::vector<double> s(n), w(n);
      passes::project({xyz[0].data(), xyz[1].data(), xyz[2].data()}, straight, s.data(), w.data(), n);
      const auto& [unit, along, up] = straight;
      for (std::size_t k = 0; k < n; ++k) {
        EXPECT_EQ(s[k], xyz[0][k] * unit * along[0] + xyz[1][k] * unit * along[1]);
        EXPECT_EQ(w[k], xyz[2][k] * unit * up[2]);
      }
    }
  }
}

TEST(Passes, ProjectAndSumCounts) {
  std::mt19937 random(4);
  std::uniform_int_distribution<std::int32_t> count(-2'000'000'000, 2'000'000'000);
  const passes::Projection projection{0.001, {0.6, 0.8, 0.0}, {0.16, -0.12, 0.98}};
  for (std::size_t n = 0; n < kMost; ++n) {
    std::array<std::vector<std::int32_t>, 3> xyz;
    for (auto& axis : xyz) {
      axis.resize(n);
      for (std::int32_t& value : axis) value = count(random);
    }
    std::vector<double> s(n), w(n);
    passes::project({xyz[0].data(), xyz[1].data(), xyz[2].data()}, projection, s.data(), w.data(), n);
    std::int64_t total = 0;
    for (std::size_t k = 0; k < n; ++k) {
      const double x = xyz[0][k] * 0.001, y = xyz[1][k] * 0.001, z = xyz[2][k] * 0.001;
      EXPECT_EQ(s[k], x * 0.6 + y * 0.8);
      EXPECT_EQ(w[k], x * 0.16 + y * -0.12 + z * 0.98);
      total += xyz[0][k];
    }
    EXPECT_EQ(passes::sum(xyz[0].data(), n), total);
  }
}

TEST(Passes, WeighRowsInTheirOrder) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> any(-1.0F, 1.0F);
  for (std::size_t n = 0; n < kMost; ++n) {
    std::vector<std::vector<float>> rows(5, std::vector<float>(n));
    std::vector<const float*> at;
    std::vector<float> weights, sum(n, 7.0F), peaks(passes::peaks_of(n), 7.0F);
    for (auto& row : rows) {
      for (float& value : row) value = any(random);
      at.push_back(row.data());
      weights.push_back(any(random));
    }
    if (n > 3) rows[0][3] = std::numeric_limits<float>::quiet_NaN();
    passes::weigh(at.data(), weights.data(), at.size(), sum.data(), peaks.data(), n);
    for (std::size_t i = 0; i < n; ++i) {
      float expected = 0.0F;
      for (std::size_t k = 0; k < rows.size(); ++k) expected += weights[k] * rows[k][i];
      if (std::isnan(expected))
        EXPECT_TRUE(std::isnan(sum[i]));
      else
        EXPECT_EQ(sum[i], expected);
    }
    for (std::size_t block = 0; block < n / passes::kPeakBlock; ++block) {
      float expected = 0.0F;
      for (std::size_t i = block * passes::kPeakBlock; i < (block + 1) * passes::kPeakBlock; ++i)
        expected = std::max(expected, std::isnan(sum[i]) ? 0.0F : std::abs(sum[i]));
      const auto first = peaks.begin() + static_cast<std::ptrdiff_t>(block * passes::kPeakLanes);
      EXPECT_EQ(*std::max_element(first, first + passes::kPeakLanes), expected);
    }
  }
}

TEST(Passes, CountStepsBack) {
  for (std::size_t n = 0; n < kMost; ++n) {
    const auto all = values<double>(n, 5);
    std::size_t expected = 0;
    for (std::size_t k = 1; k < n; ++k) expected += static_cast<std::size_t>(all[k] <= all[k - 1]);
    EXPECT_EQ(passes::count_back(all.data(), n), expected) << n;
  }
}

TEST(Passes, TellHowSamplesStand) {
  for (std::size_t n = 1; n < kMost; ++n) {
    std::vector<double> s(n), w(n);
    for (std::size_t k = 0; k < n; ++k) {
      s[k] = 3.0 + 0.1 * static_cast<double>(k);
      w[k] = 7.0 - static_cast<double>(k);
    }
    const auto middle = static_cast<std::ptrdiff_t>(n / 2);
    if (n > 1) s[n / 2] += 0.03; // the first one is where the row begins
    if (n > 2) s[n - 1] -= 0.04;
    std::vector<float> shift(n), height(n);
    const passes::Shifts shifts = passes::stand(s.data(), w.data(), {10.0, 2.0}, shift.data(), height.data(), n);
    for (std::size_t k = 0; k < n; ++k) {
      EXPECT_EQ(shift[k], static_cast<float>(s[k] * 10.0 - s[0] * 10.0 - static_cast<double>(k))) << n << ' ' << k;
      EXPECT_EQ(height[k], static_cast<float>(w[k] - 2.0)) << n << ' ' << k;
    }
    EXPECT_NEAR(shifts.largest, n > 1 ? shift[static_cast<std::size_t>(middle)] : 0.0F, 1e-5F) << n;
    EXPECT_NEAR(shifts.least, n > 2 ? shift[n - 1] : 0.0F, 1e-5F) << n;
    EXPECT_NEAR(shifts.largest, n > 1 ? 0.3F : 0.0F, 1e-5F) << n;
    EXPECT_NEAR(shifts.least, n > 2 ? -0.4F : 0.0F, 1e-5F) << n;
  }
}

TEST(Passes, ProjectAlongOneAxisAsAlongAll) {
  constexpr std::array<std::array<double, 3>, 4> kAlong{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}}};
  std::mt19937 random(12);
  std::uniform_int_distribution<std::int32_t> count(-2'000'000'000, 2'000'000'000);
  for (const auto& along : kAlong)
    for (std::size_t n = 0; n < kMost; ++n) {
      std::array<std::vector<std::int32_t>, 3> xyz;
      for (auto& axis : xyz)
        for (std::size_t k = 0; k < n; ++k) axis.push_back(count(random));
      std::vector<double> s(n), w(n);
      passes::project({xyz[0].data(), xyz[1].data(), xyz[2].data()}, {0.001, along, {0.0, 0.0, 1.0}}, s.data(), w.data(), n);
      for (std::size_t k = 0; k < n; ++k) {
        EXPECT_EQ(s[k], xyz[0][k] * 0.001 * along[0] + xyz[1][k] * 0.001 * along[1]);
        EXPECT_EQ(w[k], xyz[2][k] * 0.001);
      }
      std::size_t back = 0;
      for (std::size_t k = 1; k < n; ++k) back += static_cast<std::size_t>(xyz[0][k] <= xyz[0][k - 1]);
      EXPECT_EQ(passes::count_back(xyz[0].data(), n), back);
    }
}

double product_and_sum(const std::vector<double>& x, double factor) {
  double sum = 0.0;
  for (const double value : x) sum += value * factor;
  return sum;
}

// Fused, the product would not be rounded before it is added.
TEST(Fastest, roundsAsEverywhere) {
  std::vector<double> x(101);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = 1.0 / (3.0 + static_cast<double>(i));
  double sum = 0.0;
  for (const double value : x) {
    const volatile double product = value * 0.7;
    sum += product;
  }
  EXPECT_EQ(passes::fastest<product_and_sum>(x, 0.7), sum);
}

} // namespace
} // namespace scansion
