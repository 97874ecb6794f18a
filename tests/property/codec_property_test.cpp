// Groups survive the codec bit for bit, level by level, and hostile payloads are refused.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/pipeline.hpp"
#include "tests/property/lines.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace scansion::test {
namespace {

constexpr Rational kMicrometre{1, 1000};

LineGroup random_group(Random& random, std::size_t max_lines, std::size_t max_runs, std::size_t max_points, bool ulps) {
  LineGroup group;
  const auto lines = pick(random, 1, static_cast<std::int64_t>(max_lines));
  const auto first = static_cast<std::uint64_t>(pick(random, 0, 1LL << 40));
  for (std::int64_t i = 0; i < lines; ++i)
    append_line(group, first + static_cast<std::uint64_t>(i), make_line(random, max_runs, max_points, ulps));
  group.number = random() % 1000;
  return group;
}

AlphaSet random_alpha(Random& random) {
  AlphaSet alpha;
  double t = std::ldexp(1.0, static_cast<int>(pick(random, -6, 4)));
  for (auto n = pick(random, 1, 4); n > 0; --n) {
    alpha.tolerances.push_back(t);
    t /= 1.5;
  }
  return alpha;
}

// Encodes groups and holds every state that decoding goes through against the group.
class RoundTrip {
public:
  void expect(const LineGroup& group, const AlphaSet& alpha) {
    rank_group(ranker_, group, ranks_);
    encoder_.encode(group, ranks_, alpha, 7, encoded);
    ASSERT_EQ(encoded.payloads.size(), alpha.tolerances.size() + 2);
    const auto begun = decoder_.begin(encoded.payloads[0], decoded_);
    ASSERT_TRUE(begun) << begun.error().context;
    ASSERT_EQ(decoded_.group.lines, group.lines);
    ASSERT_EQ(decoded_.group.runs, group.runs);
    ASSERT_EQ(decoded_.group.number, group.number);
    for (std::size_t k = 0; k <= alpha.tolerances.size(); ++k) {
      const auto added = decoder_.add(encoded.payloads[k + 1], decoded_);
      ASSERT_TRUE(added) << added.error().context;
      ASSERT_NO_FATAL_FAILURE(expect_state(group, alpha, k));
    }
    ASSERT_TRUE(decoded_.lossless());
    ASSERT_EQ(decoded_.alpha.tolerances, alpha.tolerances);
  }
  [[nodiscard]] double bits_per_point(const LineGroup& group) const {
    std::size_t bytes = 0;
    for (const Bytes& payload : encoded.payloads) bytes += payload.size();
    return 8.0 * static_cast<double>(bytes) / static_cast<double>(group.points());
  }

  EncodedGroup encoded;

private:
  void expect_state(const LineGroup& group, const AlphaSet& alpha, std::size_t k) {
    double left_out = 0.0;
    for (std::size_t i = 0; i < group.points(); ++i) {
      const std::uint32_t width = alpha.width(ranks_.distance[i]);
      if (width > k) {
        ASSERT_EQ(decoded_.width[i], DecodedGroup::kUnknown);
        left_out = std::max(left_out, ranks_.distance[i]);
        continue;
      }
      ASSERT_EQ(decoded_.width[i], width);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        ASSERT_EQ(decoded_.group.xyz[axis][i], group.xyz[axis][i]);
        if (!group.ulp[axis].empty()) {
          ASSERT_EQ(decoded_.group.ulp[axis][i], group.ulp[axis][i]);
        }
      }
    }
    ASSERT_EQ(decoded_.left_out, left_out);
    ASSERT_LE(decoded_.left_out, k < alpha.tolerances.size() ? alpha.tolerances[k] : 0.0);
  }

  Ranker ranker_{kMicrometre};
  GroupEncoder encoder_;
  GroupDecoder decoder_;
  GroupRanks ranks_;
  DecodedGroup decoded_;
};

TEST(CodecProperty, EveryLevelComesBackExactly) {
  Random random(1);
  RoundTrip trip;
  for (int round = 0; round < 1500; ++round) {
    const LineGroup group = random_group(random, round % 50 == 0 ? 64 : 6, 3, round % 20 == 0 ? 300 : 30, round % 3 == 0);
    ASSERT_NO_FATAL_FAILURE(trip.expect(group, random_alpha(random))) << "round " << round;
  }
}

TEST(CodecProperty, SpecialGroupsComeBackExactlyAndSmall) {
  Random random(5);
  RoundTrip trip;
  for (int round = 0; round < 60; ++round) {
    const auto special = static_cast<Special>(round % static_cast<int>(Special::specials));
    const LineGroup group = make_special(random, special, 40, 200);
    ASSERT_NO_FATAL_FAILURE(trip.expect(group, AlphaSet{.tolerances = {0.5, 0.1, 0.05}})) << "round " << round;
    // Noise of eleven values; the fan's directions and the first line of what repeats itself come on top.
    EXPECT_LT(trip.bits_per_point(group), special == Special::raster ? 6.5 : 10.0) << "round " << round;
  }
}

TEST(CodecProperty, MixedGroupsDoNotInheritFromEachOther) {
  Random random(6);
  RoundTrip one;
  for (int round = 0; round < 40; ++round) {
    const LineGroup group =
        round % 2 == 0 ? make_special(random, static_cast<Special>(round / 2 % static_cast<int>(Special::specials)), 20, 60)
                       : random_group(random, 10, 3, 100, round % 4 == 1);
    const AlphaSet alpha = random_alpha(random);
    ASSERT_NO_FATAL_FAILURE(one.expect(group, alpha));
    RoundTrip fresh;
    ASSERT_NO_FATAL_FAILURE(fresh.expect(group, alpha));
    ASSERT_EQ(one.encoded.payloads, fresh.encoded.payloads);
  }
}

TEST(CodecProperty, LeftOutIsTheTrueErrorOfTheLevel) {
  Random random(2);
  Ranker ranker(kMicrometre);
  GroupRanks ranks;
  for (int round = 0; round < 300; ++round) {
    const LineGroup group = random_group(random, 3, 2, 200, false);
    rank_group(ranker, group, ranks);
    const double tolerance = 0.001 * static_cast<double>(pick(random, 1, 5000));
    double claimed = 0.0;
    double truth = 0.0;
    for (const scansion::Run& run : group.runs) {
      const auto axis = [&](std::size_t a) { return std::span(group.xyz[a]).subspan(run.first, run.count); };
      std::size_t left = 0;
      for (std::size_t i = 1; i < run.count; ++i) {
        if (!(ranks.distance[run.first + i] > tolerance)) {
          claimed = std::max(claimed, ranks.distance[run.first + i]);
          continue;
        }
        for (std::size_t p = left + 1; p < i; ++p)
          truth = std::max(truth, segment_distance({axis(0), axis(1), axis(2), {}}, p, left, i, kMicrometre));
        left = i;
      }
    }
    ASSERT_EQ(claimed, truth);
  }
}

TEST(CodecProperty, DamagedBodiesAreRefusedOrDecodeToSomethingBounded) {
  // The checksum is made right again after each change, so that the decoder itself is tested.
  Random random(3);
  Ranker ranker(kMicrometre);
  GroupEncoder encoder;
  GroupDecoder decoder;
  GroupRanks ranks;
  EncodedGroup encoded;
  DecodedGroup decoded;
  std::size_t refused = 0;
  for (int round = 0; round < 4000; ++round) {
    const LineGroup group = round % 16 == 0 ? make_special(random, static_cast<Special>(round / 16 % 3), 12, 70)
                                            : random_group(random, 5, 2, 60, round % 2 == 0);
    const AlphaSet alpha = random_alpha(random);
    rank_group(ranker, group, ranks);
    encoder.encode(group, ranks, alpha, 7, encoded);
    Bytes& victim = encoded.payloads[random() % encoded.payloads.size()];
    const auto header = parse_payload_header(victim);
    ASSERT_TRUE(header);
    Bytes body(victim.begin() + static_cast<std::ptrdiff_t>(header_size(header.value())), victim.end());
    for (auto flips = pick(random, 1, 4); flips > 0 && !body.empty(); --flips)
      body[random() % body.size()] ^= static_cast<std::byte>(1U << random() % 8);
    if (random() % 4 == 0) body.resize(random() % (body.size() + 1));
    seal_payload(header.value(), body, victim);
    bool good = decoder.begin(encoded.payloads[0], decoded).has_value();
    for (std::size_t k = 1; good && k < encoded.payloads.size(); ++k)
      good = decoder.add(encoded.payloads[k], decoded).has_value();
    refused += good ? 0 : 1;
  }
  EXPECT_GT(refused, 1000U);
}

TEST(CodecProperty, PipelineOutputDependsOnTheLinesAlone) {
  Random random(4);
  std::vector<LineGroup> groups;
  for (int g = 0; g < 20; ++g) groups.push_back(random_group(random, 20, 2, 100, false));
  const auto run = [&] {
    Pipeline pipeline(LevelSpec{}, kMicrometre, 3);
    std::vector<std::vector<Bytes>> all;
    EncodedGroup encoded;
    for (const LineGroup& group : groups) {
      pipeline.process(group, encoded);
      all.push_back(encoded.payloads);
    }
    return all;
  };
  EXPECT_EQ(run(), run());
}

} // namespace
} // namespace scansion::test
