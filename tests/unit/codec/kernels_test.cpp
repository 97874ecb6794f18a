// The vector versions give what the baseline gives, and contexts what their definition says.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/kernels.hpp"

#include "pipeline/codec/fit_kernels.hpp"
#include "pipeline/codec/rest_model.hpp"
#include "pipeline/codec/tokens.hpp"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace scansion {
namespace {

template <class T>
std::vector<T> noise(std::mt19937_64& random, std::size_t n) {
  std::vector<T> out(n);
  for (T& v : out) v = static_cast<T>(static_cast<T>(random()) >> (random() % (8 * sizeof(T) - 2)));
  return out;
}

TEST(Kernels, VectorUnitsChangeNothing) {
  std::mt19937_64 random(1);
  for (std::size_t n = 0; n < 300; ++n) {
    const auto weights = noise<std::int16_t>(random, 8);
    const auto deviation = noise<std::int32_t>(random, n + 16);
    const auto fast = noise<std::int32_t>(random, n);
    const auto slow = noise<std::int32_t>(random, n);
    const auto value = noise<std::int32_t>(random, n + 16);
    const auto chord = noise<std::int32_t>(random, n + 16);
    auto size = noise<std::int32_t>(random, n + 16);
    for (auto& s : size) s = size_of(s);
    const kernels::Above above{deviation.data() + 8, value.data() + 8, size.data() + 8};
    std::vector<std::int64_t> sum(n), sum2(n);
    std::vector<std::int32_t> beside(n), beside2(n), residual(n), residual2(n), sizes(n);
    std::vector<std::uint8_t> context(n), context2(n);
    kernels::weigh_beside(weights.data(), above, sum.data(), beside.data(), n);
    kernels::portable::weigh_beside(weights.data(), above, sum2.data(), beside2.data(), n);
    EXPECT_EQ(sum, sum2);
    kernels::weigh_chord(weights.data(), chord.data() + 8, sum.data(), n);
    kernels::portable::weigh_chord(weights.data(), chord.data() + 8, sum2.data(), n);
    EXPECT_EQ(sum, sum2);
    EXPECT_EQ(beside, beside2);
    const kernels::Left left{deviation.data() + 8, fast.data(), slow.data(), 2048 + static_cast<std::int64_t>(n)};
    for (const std::int64_t* above_sum :
         {static_cast<const std::int64_t*>(nullptr), static_cast<const std::int64_t*>(sum.data())}) {
      kernels::residuals(weights.data(), left, above_sum, residual.data(), n);
      kernels::portable::residuals(weights.data(), left, above_sum, residual2.data(), n);
      EXPECT_EQ(residual, residual2);
    }
    kernels::sizes(residual.data(), kLargestSize, sizes.data(), n);
    for (std::size_t i = 0; i < n; ++i) ASSERT_EQ(sizes[i], size_of(residual[i]));
    for (const bool has_above : {false, true}) {
      const std::int32_t* above_size = has_above ? beside.data() : nullptr;
      kernels::contexts(size.data() + 8, above_size, context.data(), n);
      kernels::portable::contexts(size.data() + 8, above_size, context2.data(), n);
      EXPECT_EQ(context, context2);
      for (std::size_t i = 0; i < n; ++i) {
        ASSERT_EQ(context[i], rest_context(rest_doubt(size[i + 6], size[i + 5], beside[i], has_above)));
        ASSERT_LT(context[i], 48);
      }
    }
  }
}

// Lines that follow another one for a while, and any numbers.
TEST(Kernels, PointsInStepAreThoseThatWalkingFinds) {
  std::mt19937_64 random(5);
  const auto far = [](std::int32_t a, std::int32_t b) { return std::abs(std::int64_t{a} - b); };
  for (std::size_t n = 0; n < 200; ++n) {
    auto above = noise<std::int32_t>(random, n + 2);
    auto here = noise<std::int32_t>(random, n);
    for (std::size_t i = 0; i < n && n % 3 != 0; ++i) {
      above[i] = static_cast<std::int32_t>(10 * i + random() % 3);
      here[i] = static_cast<std::int32_t>(10 * (i + 1) + random() % (i + 30 > n ? 9 : 5));
    }
    std::size_t expected = 0;
    for (; expected < n; ++expected) {
      const std::int32_t* at = above.data() + expected;
      const auto beside = far(here[expected], at[1]);
      if (beside > far(here[expected], at[0]) || beside >= far(here[expected], at[2])) break;
    }
    EXPECT_EQ(kernels::in_step(here.data(), above.data(), n), expected);
  }
}

TEST(Kernels, AStepIsSharedWhenAllDifferencesAreMultiplesOfIt) {
  std::mt19937_64 random(6);
  for (const std::uint32_t step : {1U, 2U, 3U, 5U, 8U, 12U, 1000U, 65536U, 1000003U, 0x80000000U}) {
    for (std::size_t n = 1; n < 40; ++n) {
      const auto most = static_cast<std::int64_t>(0xFFFF'FFFFU / step);
      std::vector<std::int32_t> values(n);
      for (auto& v : values)
        v = static_cast<std::int32_t>(std::numeric_limits<std::int32_t>::min() +
                                      static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(most + 1)) * step);
      EXPECT_TRUE(kernels::share_step(values.data(), step, n));
      if (step == 1 || n < 2) continue;
      std::int32_t& odd = values[1 + random() % (n - 1)];
      odd = odd == std::numeric_limits<std::int32_t>::max() ? odd - 1 : odd + 1;
      EXPECT_FALSE(kernels::share_step(values.data(), step, n));
    }
  }
}

TEST(Kernels, LeftOverIsWhatWholeNumbersGive) {
  std::mt19937_64 random(4);
  constexpr std::size_t kRows = 500;
  const auto rows = noise<std::int32_t>(random, 16 * kRows);
  const auto weights = noise<std::int16_t>(random, kWeights);
  std::array<double, 16> wide{};
  std::ranges::copy(weights, wide.begin());
  std::vector<std::int32_t> left(kRows);
  kernels::left_over(rows.data(), wide.data(), left.data(), kRows);
  for (std::size_t r = 0; r < kRows; ++r) {
    std::int64_t sum = 1 << (kWeightBits - 1);
    for (std::size_t k = 0; k < kWeights; ++k) sum += std::int64_t{weights[k]} * rows[16 * r + k];
    ASSERT_EQ(left[r], wrap(rows[16 * r + kWeights] - (sum >> kWeightBits)));
  }
}

// A row at a time, added in order: not a bit may differ.
TEST(Kernels, ProductsOfRowsAreAddedOneAfterTheOther) {
  std::mt19937_64 random(7);
  for (std::size_t n = 0; n < 9; ++n)
    for (const std::size_t stride : {1U, 2U}) {
      const auto rows = noise<std::int32_t>(random, 16 * (stride * n + 1));
      std::vector<double> factors(n);
      for (double& f : factors) f = 1.0 / (1.0 + static_cast<double>(random() % 1000));
      std::array<double, std::size_t{14} * 16> normal{}, expected{};
      for (std::size_t r = 0; r < n; ++r)
        for (std::size_t i = 0; i < 14; ++i)
          for (std::size_t j = 0; j < 16; ++j) {
            const double factor = rows[16 * stride * r + i] * factors[r];
            expected[16 * i + j] += rows[16 * stride * r + j] * factor;
          }
      kernels::add_products(rows.data(), stride, factors.data(), n, normal.data(), 14);
      for (std::size_t i = 0; i < 14; ++i)
        for (std::size_t j = 0; j < 16; ++j)
          if (j <= i || j >= 12) {
            EXPECT_EQ(normal[16 * i + j], expected[16 * i + j]);
          }
      std::vector<double> amounts(n);
      kernels::row_amounts(rows.data(), amounts.data(), n);
      for (std::size_t r = 0; r < n; ++r) {
        std::int64_t sum = 0;
        for (std::size_t k = 0; k < 16; ++k) sum += k == 6 || k == 7 ? 0 : std::abs(std::int64_t{rows[16 * r + k]});
        EXPECT_EQ(amounts[r], static_cast<double>(sum));
      }
    }
}

TEST(Kernels, ChordsAndWhatLiesOffThem) {
  std::mt19937_64 random(8);
  for (std::size_t n = 0; n < 70; ++n) {
    const auto values = noise<std::int32_t>(random, n);
    const auto from = static_cast<std::int32_t>(random());
    const std::int64_t step = static_cast<std::int64_t>(random()) >> (16 + random() % 40);
    std::vector<std::int32_t> chord(n), off(n), slope(n);
    kernels::slope(from, step, slope.data(), n);
    kernels::off_slope(from, step, values.data(), chord.data(), off.data(), n);
    EXPECT_EQ(chord, slope);
    for (std::size_t i = 0; i < n; ++i) {
      ASSERT_EQ(chord[i], wrap(from + (step * static_cast<std::int64_t>(i + 1) >> 16)));
      ASSERT_EQ(off[i], wrap(std::int64_t{values[i]} - chord[i]));
    }
  }
}

TEST(Kernels, CountsThatAreNotZero) {
  std::mt19937_64 random(9);
  for (std::size_t n = 0; n < 150; ++n) {
    std::vector<std::uint32_t> counts(n);
    for (auto& c : counts) c = random() % 3 == 0 ? static_cast<std::uint32_t>(random()) : 0;
    std::array<std::uint64_t, 3> bits{};
    kernels::nonzero(counts.data(), n, bits.data());
    for (std::size_t i = 0; i < 192; ++i) ASSERT_EQ(bits[i / 64] >> i % 64 & 1U, i < n && counts[i] != 0 ? 1U : 0U);
  }
}

TEST(Kernels, CountsWhatIsAbove) {
  std::mt19937_64 random(5);
  for (std::size_t n = 0; n < 100; ++n) {
    std::vector<double> values(n);
    for (double& v : values) v = static_cast<double>(random() % 8);
    if (n > 2) values[1] = std::numeric_limits<double>::infinity();
    const auto larger = static_cast<std::size_t>(std::ranges::count_if(values, [](double v) { return v > 3.0; }));
    EXPECT_EQ(kernels::count_above(values.data(), 3.0, n), larger);
  }
}

TEST(Kernels, TokensAreThoseOfTheirDefinition) {
  std::mt19937_64 random(3);
  std::vector<std::int32_t> values{
      0, -1, 1, 15, 16, -16, -17, std::numeric_limits<std::int32_t>::max(), std::numeric_limits<std::int32_t>::min()};
  // Whatever rounds up as a float lies just below the first value of a token.
  for (const TokenRange& range : kTokenRanges)
    for (const std::uint32_t off : {0U, 1U, 2U, 3U, 64U, 255U, 256U}) values.push_back(unfold(range.first - off));
  for (const std::int32_t v : noise<std::int32_t>(random, 100'000)) values.push_back(v);
  std::vector<std::uint8_t> token(values.size());
  for (const auto tokens : {kernels::tokens, kernels::portable::tokens}) {
    const std::uint8_t largest = tokens(values.data(), token.data(), values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      ASSERT_EQ(token[i], token_of(fold(values[i]))) << values[i];
    }
    EXPECT_EQ(largest, *std::ranges::max_element(token));
    EXPECT_EQ(tokens(values.data(), token.data(), 3), 2);
    EXPECT_EQ(tokens(values.data(), token.data(), 0), 0);
  }
}

TEST(Kernels, AboveFindsEachValueThatIsLarger) {
  std::mt19937_64 random(2);
  for (std::size_t n = 0; n < 200; ++n) {
    std::vector<double> values(n);
    for (double& v : values) v = static_cast<double>(random() % 16) / 4.0; // many equal ones, some of them the limit itself
    const double limit = static_cast<double>(random() % 5);
    std::vector<std::uint32_t> indexes(n);
    double rest = 0.25;
    indexes.resize(kernels::above(values.data(), limit, indexes.data(), n, rest));
    std::vector<std::uint32_t> wanted;
    double most = 0.25;
    for (std::uint32_t i = 0; i < n; ++i)
      if (values[i] > limit)
        wanted.push_back(i);
      else
        most = std::max(most, values[i]);
    EXPECT_EQ(indexes, wanted);
    EXPECT_EQ(rest, most);
  }
}

TEST(Kernels, BoundsAreTheSmallestAndTheLargest) {
  std::mt19937_64 random(3);
  for (std::size_t n = 1; n < 100; ++n) {
    const auto values = noise<std::int32_t>(random, n);
    std::int32_t low = values.front();
    std::int32_t high = values.front();
    kernels::bounds(values.data(), n, low, high);
    EXPECT_EQ(low, *std::min_element(values.begin(), values.end()));
    EXPECT_EQ(high, *std::max_element(values.begin(), values.end()));
  }
}

} // namespace
} // namespace scansion
