// The Gocator decoder on messages put together from the manual, cut anywhere and damaged.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/lmi-gocator/decoder.hpp"

#include <gtest/gtest.h>

namespace scansion {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes stamp(std::uint64_t frame) {
  Bytes out;
  gdp::put<std::uint32_t>(out, 70);
  gdp::put<std::uint16_t>(out, 1);
  gdp::put<std::uint32_t>(out, 1);
  gdp::put<std::uint16_t>(out, 56);
  gdp::put<std::uint16_t>(out, 0);
  gdp::put(out, frame);
  gdp::put(out, frame * 1000U);
  gdp::put(out, static_cast<std::int64_t>(frame) * 10);
  out.resize(70);
  return out;
}

Bytes profile(std::int16_t z, std::uint32_t scale_nm = 1000, std::uint8_t source = 0) {
  Bytes out;
  gdp::put<std::uint32_t>(out, 40 + 3 * 4);
  gdp::put<std::uint16_t>(out, 5 | gdp::kLastOfGroup);
  gdp::put<std::uint16_t>(out, 32);
  gdp::put<std::uint32_t>(out, 1);
  gdp::put<std::uint32_t>(out, 3);
  gdp::put(out, scale_nm);
  gdp::put(out, scale_nm);
  gdp::put<std::int32_t>(out, 0);
  gdp::put<std::int32_t>(out, 0);
  out.push_back(source);
  out.resize(40);
  for (const int x : {0, 1, 2}) {
    gdp::put(out, static_cast<std::int16_t>(x));
    gdp::put(out, x == 1 ? gdp::kNull : z);
  }
  return out;
}

Bytes frame(std::uint64_t number) {
  Bytes out = stamp(number);
  const Bytes more = profile(static_cast<std::int16_t>(number));
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

class Gocator : public testing::Test {
protected:
  /// What comes of `bytes`, fed in pieces: "z" of each line, "gap n", "reply".
  std::string decoded(const Bytes& bytes, std::size_t piece = 1000) {
    std::string out;
    LineBuffer line;
    std::span<const std::uint8_t> rest(bytes);
    while (!rest.empty()) {
      auto part = rest.first(std::min(piece, rest.size()));
      rest = rest.subspan(part.size());
      for (;;) {
        Gap gap;
        const auto step = decoder_->decode(part, {}, line, gap);
        part = part.subspan(step.used);
        if (step.what == Decoded::more) break;
        if (step.what == Decoded::line)
          out += std::to_string(line.xyz[2].front()) + "@" + std::to_string(line.xyz[1].front()) + " ";
        if (step.what == Decoded::gap) out += "gap " + (gap.count ? std::to_string(*gap.count) : "unknown") + " ";
        if (step.what == Decoded::reply) {
          out += "reply ";
          if (decoder_->refusal().empty()) decoder_->set_count_nm(1000, false);
        }
        last_ = line;
        line.clear();
      }
    }
    EXPECT_EQ(counters_.rejected(Reject::overlong) + counters_.rejected(Reject::checksum), 0U);
    return out;
  }
  static Bytes joined(std::initializer_list<Bytes> parts) {
    Bytes out;
    for (const Bytes& part : parts) out.insert(out.end(), part.begin(), part.end());
    return out;
  }

  LinkCounters counters_;
  std::optional<GocatorDecoder> decoder_{std::in_place, counters_, GocatorChoice{}, LineSpacing::create({}).assume_value()};
  LineBuffer last_;
};

TEST_F(Gocator, GivesTheSameHoweverBytesAreCut) {
  const Bytes bytes = joined({frame(5), frame(6), frame(9)});
  std::uint64_t accepted = 0;
  for (const std::size_t piece : {1U, 3U, 16U, 1000U}) {
    decoder_.emplace(counters_, GocatorChoice{}, LineSpacing::create({}).assume_value());
    EXPECT_EQ(decoded(bytes, piece), "reply 5@0 6@1000 gap 2 9@4000 ") << piece;
    EXPECT_EQ(counters_.accepted, accepted += 6);
  }
  EXPECT_EQ(counters_.rejected(), 0U);
}

TEST_F(Gocator, NullsSplitLinesAndAreCounted) {
  EXPECT_EQ(decoded(frame(7)), "reply 7@0 ");
  ASSERT_EQ(last_.runs.size(), 2U);
  EXPECT_EQ(last_.runs[1], (scansion::Run{1, 1, 1}));
  EXPECT_EQ(last_.stamps.device_ns, 7'000'000);
  EXPECT_EQ(last_.stamps.encoder, 70);
}

TEST_F(Gocator, IsBackInStepWithTheNextStamp) {
  EXPECT_EQ(decoded(joined({frame(1), {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, frame(2), frame(3)})), "reply 1@0 2@1000 3@2000 ");
  EXPECT_EQ(counters_.rejected(Reject::framing), 1U);
  EXPECT_EQ(counters_.rejected(), 1U);
}

TEST_F(Gocator, RepeatedFramesAreNotTakenTwice) {
  EXPECT_EQ(decoded(joined({frame(1), frame(1), frame(2)})), "reply 1@0 2@1000 ");
  EXPECT_EQ(counters_.rejected(Reject::value), 2U);
}

TEST_F(Gocator, AStepBackIsBelievedOnlyWhenItGoesOn) {
  EXPECT_EQ(decoded(joined({frame(50), frame(3), frame(51), frame(52)})), "reply 50@0 51@1000 52@2000 ");
  EXPECT_EQ(decoded(joined({frame(3), frame(4), frame(5)})), "gap unknown 4@3000 5@4000 ");
  EXPECT_EQ(decoded(joined({frame(0), frame(1)})), "0@5000 1@6000 ");
}

TEST_F(Gocator, AWrongLeapIsTakenBack) {
  EXPECT_EQ(decoded(joined({frame(50), frame(60), frame(51), frame(52)})), "reply 50@0 gap 9 60@10000 51@1000 52@2000 ");
  EXPECT_EQ(decoded(joined({frame(62), frame(63), frame(53)})), "gap 9 62@12000 63@13000 ") << "this leap was confirmed";
}

TEST_F(Gocator, LossesOverALostConnectionAreCounted) {
  EXPECT_EQ(decoded(frame(10)), "reply 10@0 ");
  decoder_->reset();
  EXPECT_EQ(decoded(frame(15)), "15@5000 ");
  EXPECT_EQ(decoder_->lost_while_away(), 4U);
  decoder_->reset();
  EXPECT_EQ(decoded(frame(2)), "2@6000 ") << "the way goes on";
  EXPECT_EQ(decoder_->lost_while_away(), std::nullopt);
}

TEST_F(Gocator, SecondSourceIsRefusedWithTheKeyThatChooses) {
  auto two = joined({stamp(1), profile(1), profile(2, 1000, 1), stamp(2), profile(3), profile(4, 1000, 1)});
  two[70 + 5] = 0; // the first profile is not the last of its group
  two[70 + 52 + 52 + 70 + 5] = 0;
  EXPECT_EQ(decoded(two), "reply 1@0 3@1000 reply ");
  EXPECT_NE(decoder_->refusal().find("source = "), std::string::npos);
}

TEST_F(Gocator, ChangedScalesAreRefusedWhenTheyStay) {
  EXPECT_EQ(decoded(joined({frame(1), stamp(2), profile(2, 1001), frame(3)})), "reply 1@0 gap 1 3@2000 ");
  EXPECT_EQ(decoded(joined({stamp(4), profile(2, 1003), stamp(5), profile(2, 1003)})), "reply ");
  EXPECT_NE(decoder_->refusal().find("scales have changed"), std::string::npos);
}

TEST_F(Gocator, AWrongLengthOfAnotherMessageHidesNothing) {
  Bytes other;
  gdp::put<std::uint32_t>(other, 50'000'000);
  gdp::put<std::uint16_t>(other, 10 | gdp::kLastOfGroup);
  other.resize(20);
  for (const std::size_t piece : {1U, 5U, 13U, 1000U}) {
    decoder_.emplace(counters_, GocatorChoice{}, LineSpacing::create({}).assume_value());
    EXPECT_EQ(decoded(joined({frame(1), other, frame(2), frame(3)}), piece), "reply 1@0 2@1000 3@2000 ") << piece;
  }
  EXPECT_EQ(counters_.rejected(Reject::framing), 4U);
}

TEST_F(Gocator, OtherMessagesArePassedOverWhole) {
  Bytes other;
  gdp::put<std::uint32_t>(other, 10'000);
  gdp::put<std::uint16_t>(other, 10 | gdp::kLastOfGroup);
  while (other.size() < 10'000) other.push_back(static_cast<std::uint8_t>(other.size() % 5));
  for (const std::size_t piece : {1U, 4096U, 100'000U}) {
    decoder_.emplace(counters_, GocatorChoice{}, LineSpacing::create({}).assume_value());
    EXPECT_EQ(decoded(joined({frame(1), other, frame(2)}), piece), "reply 1@0 2@1000 ") << piece;
  }
  EXPECT_EQ(counters_.rejected(), 0U);
}

TEST_F(Gocator, SurfacesAreRefused) {
  Bytes surface;
  gdp::put<std::uint32_t>(surface, 20);
  gdp::put<std::uint16_t>(surface, 8 | gdp::kLastOfGroup);
  surface.resize(20);
  EXPECT_EQ(decoded(joined({stamp(1), surface, stamp(2)})), "reply ");
  EXPECT_NE(decoder_->refusal().find("scan mode to Profile"), std::string::npos);
}

} // namespace
} // namespace scansion
