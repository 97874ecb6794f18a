// A scan line where columns cross it: the same heights whether samples stand evenly or not.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/crosswise/column_samples.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

namespace scansion {
namespace {

constexpr double kPitch = 0.1; // mm
constexpr std::uint32_t kSamples = 200;

struct Sampled {
  std::vector<float> height;
  std::vector<std::uint32_t> source;
};

Profile profile_of(const std::function<double(std::uint32_t)>& s, const std::function<double(double)>& w) {
  Profile profile;
  for (std::uint32_t k = 0; k < kSamples; ++k) {
    profile.s.push_back(s(k));
    profile.w.push_back(w(profile.s.back()));
    profile.source.push_back(1000 + k);
  }
  profile.ends = {kSamples};
  return profile;
}

Sampled sample(Profile& profile, std::size_t columns = kSamples + 2) {
  Sampled out{std::vector<float>(columns, 77.0F),
              std::vector<std::uint32_t>(columns, 77)}; // of the row that stood there before
  stand(profile, {kPitch, 1.0});
  sample_columns(profile, {0.005, kPitch, kPitch}, {0, columns}, out.height.data(), out.source.data());
  return out;
}

// Each column looked up by itself.
void expect_between_neighbours(const Profile& profile, const Sampled& seen, std::size_t first, std::size_t last) {
  for (std::size_t j = first; j <= last; ++j) {
    const double place = static_cast<double>(j) * kPitch;
    const auto after = std::lower_bound(profile.s.begin() + 1, profile.s.end(), place);
    ASSERT_NE(after, profile.s.end());
    const auto k = static_cast<std::size_t>(after - profile.s.begin()) - 1;
    const double share = (place - profile.s[k]) / (profile.s[k + 1] - profile.s[k]);
    const double height = profile.w[k] + share * (profile.w[k + 1] - profile.w[k]) - 1.0;
    EXPECT_NEAR(seen.height[j], height, 1e-5) << "column " << j;
    const double off = std::abs(share - 0.5);
    if (off > 0.01 && off < 0.49) {
      EXPECT_EQ(seen.source[j], profile.source[share < 0.5 ? k : k + 1]) << "column " << j;
    }
  }
}

double ramp(double s) {
  return 3.0 + 0.4 * s;
}

TEST(ColumnSamples, evenSamplesBetweenColumns) {
  Profile profile = profile_of([](std::uint32_t k) { return 0.137 + kPitch * k; }, ramp);
  expect_between_neighbours(profile, sample(profile), 2, kSamples);
}

TEST(ColumnSamples, samplesOnColumnsButForRounding) {
  Profile profile = profile_of([](std::uint32_t k) { return kPitch * k + (k % 3 == 0 ? 4e-4 : -4e-4); }, ramp);
  expect_between_neighbours(profile, sample(profile), 1, kSamples - 2);
}

TEST(ColumnSamples, unevenSamples) {
  Profile profile = profile_of([](std::uint32_t k) { return kPitch * k + 0.08 * std::sin(0.7 * k); },
                               [](double s) { return 0.5 * std::sin(s); });
  expect_between_neighbours(profile, sample(profile), 1, kSamples - 3);
}

TEST(ColumnSamples, wallsKeepTheHeightsBesideThem) {
  Profile profile =
      profile_of([](std::uint32_t k) { return 0.03 + kPitch * k; }, [](double s) { return s < 10.0 ? 1.0 : 6.0; });
  const Sampled seen = sample(profile);
  for (std::size_t j = 1; j < kSamples; ++j)
    EXPECT_EQ(seen.height[j], static_cast<double>(j) * kPitch < 9.98 ? 0.0F : 5.0F) << "column " << j;
}

TEST(ColumnSamples, nothingIsSeenInHolesAndBeyondTheEnds) {
  Profile profile = profile_of([](std::uint32_t k) { return 0.03 + kPitch * (k < 100 ? k : k + 20); }, ramp);
  const std::vector<std::uint32_t> ends{50, kSamples};
  profile.ends = ends;
  const Sampled out = sample(profile, kSamples + 30);
  for (std::size_t j = 0; j < kSamples + 30; ++j) {
    const bool hole = (j >= 100 && j <= 120) || j == 50 || j == 0 || j > kSamples + 19;
    EXPECT_EQ(std::isnan(out.height[j]), hole) << "column " << j;
    if (j == 0 || j == 50 || j > kSamples + 19) {
      EXPECT_EQ(out.source[j], 1000U) << "column " << j;
    }
    if (j >= 100 && j <= 120) {
      EXPECT_EQ(out.source[j], j < 110 ? 1099U : 1100U) << "column " << j;
    }
  }
}

} // namespace
} // namespace scansion
