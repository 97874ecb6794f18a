// Percentages, line ranges, counts, and the common threshold of a reduction over the scan.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/export/selection.hpp"

#include "pipeline/export/common_threshold.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

namespace scansion {
namespace {

Rational share(const char* percent) {
  const auto parsed = parse_reduction(percent);
  EXPECT_TRUE(parsed) << percent;
  return parsed ? parsed.value() : Rational{};
}

TEST(Selection, CountsAreTheFormulas) {
  EXPECT_EQ(kept_of_scan(1'328'531, share("95")), 66'427U); // the paper's data set
  EXPECT_EQ(kept_of_run(1000, share("95")), 51U);           // m = 50, m + 1 points
  EXPECT_EQ(kept_of_run(1000, share("97.5")), 26U);
  EXPECT_EQ(kept_of_run(1000, share("0")), 1000U);
  EXPECT_EQ(kept_of_run(1000, share("100")), 2U);
  EXPECT_EQ(kept_of_run(1, share("95")), 1U);
  EXPECT_EQ(kept_of_run(2, share("95")), 2U);
  EXPECT_EQ(kept_of_run(3, share("95")), 2U);
  // 70 % of 10 leaves exactly 3, not 2.999...: the arithmetic is on fractions.
  EXPECT_EQ(kept_of_run(10, share("70")), 4U);
  EXPECT_EQ(kept_of_scan(10, share("95")), 1U); // 0.5 rounds up
}

TEST(Selection, RefusesWhatIsNoPercentage) {
  for (const char* text : {"-1", "100.1", "x", "", "1e9", "nan"}) EXPECT_FALSE(parse_reduction(text)) << text;
}

TEST(Selection, LineRanges) {
  EXPECT_EQ(parse_lines("3:7").value(), (std::pair<std::uint64_t, std::uint64_t>{3, 7}));
  EXPECT_EQ(parse_lines("3:").value().first, 3U);
  EXPECT_EQ(parse_lines(":7").value().second, 7U);
  for (const char* text : {"7", "7:3", "a:b", "3:3", "-1:4"}) EXPECT_FALSE(parse_lines(text)) << text;
}

// A scan small enough for memory and one that needs the radix passes must agree with sorting.
TEST(CommonThreshold, EqualsSorting) {
  std::mt19937_64 random(3);
  for (const std::size_t points : {std::size_t{1000}, std::size_t{200'000}, (std::size_t{1} << 22) + 5000}) {
    std::vector<double> distance(points);
    for (double& d : distance) d = static_cast<double>(random() % 5000) / 1000.0; // many ties
    distance.front() = distance.back() = std::numeric_limits<double>::infinity();
    CommonThreshold search;
    const Rational keep = share("90");
    int passes = 0;
    do {
      const auto all = std::span(distance);
      for (std::size_t i = 0; i < points; i += 1000) search.add(all.subspan(i, std::min<std::size_t>(1000, points - i)));
      ASSERT_LE(++passes, 3);
    } while (!search.finish_pass(keep));

    std::vector<double> sorted(distance.begin() + 1, distance.end() - 1);
    std::ranges::sort(sorted, std::greater<>());
    const std::uint64_t wanted = kept_of_scan(points, keep) - 2;
    EXPECT_EQ(search.threshold(), sorted[wanted - 1]) << points;
    const auto above =
        static_cast<std::uint64_t>(std::ranges::count_if(sorted, [&](double d) { return d > search.threshold(); }));
    EXPECT_EQ(search.ties(), wanted - above) << points;
  }
}

TEST(CommonThreshold, FewerThanTheEndsKeepsTheEnds) {
  CommonThreshold search;
  search.add(std::vector<double>{std::numeric_limits<double>::infinity(), 1.0, std::numeric_limits<double>::infinity()});
  ASSERT_TRUE(search.finish_pass(share("99")));
  EXPECT_GT(search.threshold(), 1e300);
  EXPECT_EQ(search.ties(), 0U);
}

} // namespace
} // namespace scansion
