// The SCIP decoder on frames of the specification, cut anywhere, damaged anywhere.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/hokuyo-scip/scip_decoder.hpp"
#include "drivers/hokuyo-scip/scip_text.hpp"

#include <gtest/gtest.h>
#include <random>

namespace scansion {
namespace {

constexpr std::int64_t kMs = 1'000'000;

ScipDecoder::Expected expected_of(char kind = 'D', std::int32_t start = 0, std::int32_t end = 1080) {
  ScipDecoder::Expected out;
  out.sensor = {"UTM-30LX", 23, 60000, 1440, 0, 1080, 540, 2400};
  out.plan = {kind, start, end, 1, 0};
  char head[32];
  std::snprintf(head, sizeof head, "M%c%04d%04d000", kind, start, end);
  out.head = head;
  out.tail = ";s1";
  return out;
}

std::string summed(std::string text) {
  const char sum = scip::sum_of(text);
  return text + sum + "\n";
}

/// A scan message whose distances are `distance` + the sample's number.
std::string scan_of(const ScipDecoder::Expected& expected, std::int64_t stamp_ms, std::uint32_t distance) {
  std::string text = expected.head + "00" + expected.tail + "\n99b\n";
  std::string part;
  scip::encode_number(part, static_cast<std::uint32_t>(stamp_ms & 0xFFFFFF), 4);
  text += summed(part);
  std::string data;
  for (std::int32_t i = 0; i < expected.plan.values(); ++i) {
    scip::encode_number(data, distance + static_cast<std::uint32_t>(i), expected.plan.kind == 'S' ? 2 : 3);
    if (expected.plan.kind == 'E') scip::encode_number(data, 600, 3);
  }
  for (std::size_t at = 0; at < data.size(); at += 64) text += summed(data.substr(at, 64));
  return text + "\n";
}

struct Got {
  std::vector<std::int64_t> clocks; ///< ms, of each line
  std::vector<std::size_t> points;
  std::vector<std::optional<std::uint64_t>> gaps;
  int replies = 0;
};

void feed(ScipDecoder& decoder, std::string_view text, std::size_t piece, std::int64_t at_ns, Got& got) {
  LineBuffer line;
  Gap gap;
  for (std::size_t from = 0; from < text.size(); from += piece) {
    const auto part = text.substr(from, piece);
    std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(part.data()), part.size());
    for (;;) {
      const auto step = decoder.decode(bytes, {at_ns, at_ns}, line, gap);
      bytes = bytes.subspan(step.used);
      if (step.what == Decoded::more) break;
      if (step.what == Decoded::line) {
        got.clocks.push_back(*line.stamps.device_ns / kMs);
        got.points.push_back(line.points());
      }
      if (step.what == Decoded::gap) got.gaps.push_back(gap.count);
      if (step.what == Decoded::reply) ++got.replies;
      line.clear();
    }
  }
}

TEST(ScipDecoder, TakesRepliesAndScansHoweverTheyAreCut) {
  const auto expected = expected_of();
  const std::string text = "\n\nQT\n00P\n\nMD0000108000000;s1\n00P\n\n" + scan_of(expected, 100, 300) +
                           "II\n00P\nMODL:x;8\n\n" + scan_of(expected, 125, 300) + scan_of(expected, 200, 300);
  for (const std::size_t piece : {std::size_t{1}, std::size_t{3}, std::size_t{4096}, text.size()}) {
    LinkCounters counters;
    ScipDecoder decoder(counters);
    decoder.expect(expected);
    Got got;
    feed(decoder, text, piece, 0, got);
    EXPECT_EQ(got.replies, 3);
    EXPECT_EQ(got.clocks, (std::vector<std::int64_t>{100, 125, 200}));
    EXPECT_EQ(got.points, (std::vector<std::size_t>{1081, 1081, 1081}));
    EXPECT_EQ(got.gaps, (std::vector<std::optional<std::uint64_t>>{2}));
    EXPECT_EQ(counters.accepted, 6U);
    EXPECT_EQ(counters.rejected(), 0U);
  }
}

TEST(ScipDecoder, PointsStandWhereTheRangesSay) {
  auto expected = expected_of('E', 540, 541);
  const auto spacing = [] {
    OptionValues values;
    values.set("spacing", 2.5);
    return LineSpacing::create(values).assume_value();
  }();
  LinkCounters counters;
  ScipDecoder decoder(counters, spacing);
  decoder.expect(expected);
  LineBuffer line;
  Gap gap;
  for (int i = 0; i < 2; ++i) {
    const std::string text = scan_of(expected, 100 + 25 * i, 1000);
    line.clear();
    const auto step = decoder.decode({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, {}, line, gap);
    ASSERT_EQ(step.what, Decoded::line);
  }
  // 1000 mm straight down; 1001 mm a quarter of a degree beside it: 1001 sin 0.25 deg = 4.3677, 1001 cos 0.25 deg = 1000.9905.
  EXPECT_EQ(line.xyz[0], (std::vector<std::int32_t>{0, 437}));
  EXPECT_EQ(line.xyz[1], (std::vector<std::int32_t>{250, 250}));
  EXPECT_EQ(line.xyz[2], (std::vector<std::int32_t>{-100000, -100099}));
}

TEST(ScipDecoder, CodesAreInvalidSamples) {
  auto expected = expected_of('D', 0, 6);
  LinkCounters counters;
  ScipDecoder decoder(counters);
  decoder.expect(expected);
  std::string data;
  for (const std::uint32_t value : {1U, 1000U, 1001U, 19U, 65533U, 1002U, 0U}) scip::encode_number(data, value, 3);
  const std::string text = expected.head + "00" + expected.tail + "\n99b\n00000\n" + summed(data) + "\n";
  LineBuffer line;
  Gap gap;
  const auto step = decoder.decode({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, {}, line, gap);
  ASSERT_EQ(step.what, Decoded::line);
  EXPECT_EQ(line.runs, (std::vector<scansion::Run>{{0, 2, 1}, {2, 1, 2}}));
  EXPECT_EQ(line.invalid_after, 1U);
}

TEST(ScipDecoder, ClockWrapsAndIsSetAnew) {
  const auto expected = expected_of('S', 0, 0);
  LinkCounters counters;
  ScipDecoder decoder(counters);
  decoder.expect(expected);
  Got got;
  feed(decoder, scan_of(expected, 16777200, 300), 4096, 0, got);
  feed(decoder, scan_of(expected, 16777225, 300), 4096, 25 * kMs, got); // wraps to 9
  EXPECT_EQ(got.clocks, (std::vector<std::int64_t>{16777200, 16777225}));
  EXPECT_TRUE(got.gaps.empty());
  feed(decoder, scan_of(expected, 8000000, 300), 4096, 50 * kMs, got); // no one waits for two hours in 25 ms
  EXPECT_EQ(got.clocks.back(), 8000000);
  EXPECT_EQ(got.gaps, (std::vector<std::optional<std::uint64_t>>{std::nullopt}));
  feed(decoder, scan_of(expected, 7999000, 300), 4096, 75 * kMs, got); // backwards
  EXPECT_EQ(got.gaps.size(), 2U);
}

TEST(ScipDecoder, EverySingleFlippedBitIsRefused) {
  const auto expected = expected_of('D', 540, 580);
  const std::string good = scan_of(expected, 100, 300);
  const std::string next = scan_of(expected, 125, 300);
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      LinkCounters counters;
      ScipDecoder decoder(counters);
      decoder.expect(expected);
      std::string bad = good;
      bad[at] = static_cast<char>(static_cast<unsigned char>(bad[at]) ^ (1U << bit));
      Got got;
      feed(decoder, bad + next, 4096, 0, got);
      // The digits of the count are the sensor's to choose.
      const bool is_count = at >= expected.head.size() && at < expected.head.size() + 2;
      if (is_count && got.clocks.size() == 2) continue;
      ASSERT_EQ(got.clocks, (std::vector<std::int64_t>{125})) << "byte " << at << " bit " << bit;
      ASSERT_GE(counters.rejected() + (counters.accepted - 1), 1U);
    }
  }
}

/// Noise of all kinds: no line that was not sent, and back in step at the second undamaged scan at the latest.
TEST(ScipDecoder, NoiseLosesOnlyWhatItHits) {
  const auto expected = expected_of('D', 540, 640);
  std::mt19937 random(7);
  for (const double rate : {1e-4, 1e-3, 1e-2}) {
    LinkCounters counters;
    ScipDecoder decoder(counters);
    decoder.expect(expected);
    std::bernoulli_distribution hit(rate);
    Got got;
    int missed_in_a_row = 0;
    int clean = 0;
    for (int scan = 0; scan < 3000; ++scan) {
      const std::string good = scan_of(expected, 25 * scan, 300);
      std::string sent;
      for (const char c : good) {
        const bool is_hit = hit(random);
        const auto kind = random() % 3;
        if (is_hit && kind == 0) continue;
        if (is_hit && kind == 1) sent += static_cast<char>(random());
        sent += is_hit && kind == 2 ? static_cast<char>(static_cast<unsigned char>(c) ^ (1U << (random() % 8))) : c;
      }
      const std::size_t before = got.clocks.size();
      feed(decoder, sent, 4096, 25 * scan * kMs, got);
      const bool is_new = got.clocks.size() > before;
      if (is_new) {
        ASSERT_EQ(got.clocks.back(), 25 * scan);
        ASSERT_EQ(got.points.back(), 101U);
      }
      clean = sent == good ? clean + 1 : 0;
      missed_in_a_row = is_new ? 0 : missed_in_a_row + 1;
      ASSERT_FALSE(clean >= 2 && !is_new) << "scan " << scan << " at rate " << rate;
    }
    std::uint64_t lost = 0;
    for (const auto& gap : got.gaps) lost += gap.value_or(0);
    EXPECT_EQ(got.clocks.size() + lost, static_cast<std::size_t>(got.clocks.back() / 25 - got.clocks.front() / 25 + 1));
    EXPECT_GT(counters.rejected(), 0U);
  }
}

/// Values of steps with further echoes, as one data block.
std::string scan_with(const ScipDecoder::Expected& expected, std::string_view status, const std::string& data) {
  const std::string count = expected.plan.is_polled ? "" : "00";
  std::string text = expected.head + count + expected.tail + "\n" + summed(std::string(status)) + summed("0001");
  for (std::size_t at = 0; at < data.size(); at += 64) text += summed(data.substr(at, 64));
  return text + "\n";
}

TEST(ScipDecoder, OneEchoOfEachStepIsThePoint) {
  using scip::EchoChoice;
  for (const auto& [choice, want] :
       {std::pair{EchoChoice::nearest, 1000}, std::pair{EchoChoice::farthest, 3000}, std::pair{EchoChoice::strongest, 2000}}) {
    auto expected = expected_of('E', 540, 541);
    expected.plan.has_echoes = true;
    expected.plan.echo = choice;
    LinkCounters counters;
    ScipDecoder decoder(counters);
    decoder.expect(expected);
    std::string data;
    for (const auto& [mark, distance, intensity] :
         {std::tuple{"", 2000U, 90U}, {"&", 1U, 99U}, {"&", 1000U, 50U}, {"&", 3000U, 0U}, {"", 1U, 0U}}) {
      data += mark;
      scip::encode_number(data, distance, 3);
      scip::encode_number(data, intensity, 3);
    }
    const std::string text = scan_with(expected, "99", data);
    LineBuffer line;
    Gap gap;
    const auto step = decoder.decode({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, {}, line, gap);
    ASSERT_EQ(step.what, Decoded::line);
    EXPECT_EQ(line.xyz[2], (std::vector<std::int32_t>{-100 * want}));
    EXPECT_EQ(line.invalid_after, 1U);
    // A value that is cut, a step too many, a mark where there is but one echo.
    for (const std::string& bad : {data.substr(0, data.size() - 1), data + data.substr(0, 6), data + "&"}) {
      const std::uint64_t before = counters.rejected();
      Got got;
      feed(decoder, scan_with(expected, "99", bad), 100, 0, got);
      EXPECT_EQ(counters.rejected(), before + 1) << bad;
      EXPECT_TRUE(got.clocks.empty());
    }
    expected.plan.has_echoes = false;
    decoder.expect(expected);
    Got got;
    feed(decoder, text, 100, 0, got);
    EXPECT_TRUE(got.clocks.empty());
  }
}

TEST(ScipDecoder, ScansThatAreAskedForComeOnce) {
  auto expected = expected_of('D', 540, 540);
  expected.head = "GD0540054000";
  expected.plan.is_polled = true;
  LinkCounters counters;
  ScipDecoder decoder(counters);
  decoder.expect(expected);
  const auto scan = [&](std::int64_t stamp_ms) {
    std::string stamp;
    scip::encode_number(stamp, static_cast<std::uint32_t>(stamp_ms), 4);
    return expected.head + expected.tail + "\n00P\n" + summed(stamp) + summed("04\\") + "\n";
  };
  Got got;
  feed(decoder, scan(100) + scan(100) + scan(125) + scan(200) + "GD0540054000;s1\n10Q\n\n", 7, 0, got);
  EXPECT_EQ(got.clocks, (std::vector<std::int64_t>{100, 125, 200}));
  EXPECT_EQ(got.gaps, (std::vector<std::optional<std::uint64_t>>{2}));
  EXPECT_EQ(got.replies, 2) << "the repeated one and the refusal";
  EXPECT_EQ(counters.rejected(), 0U);
}

TEST(ScipDecoder, ARepeatedScanIsNoSecondLine) {
  const auto expected = expected_of('S', 0, 0);
  LinkCounters counters;
  ScipDecoder decoder(counters);
  decoder.expect(expected);
  Got got;
  const std::string one = scan_of(expected, 100, 300);
  feed(decoder, one + one + scan_of(expected, 125, 300), 4096, 0, got);
  EXPECT_EQ(got.clocks, (std::vector<std::int64_t>{100, 125}));
  EXPECT_TRUE(got.gaps.empty());
  EXPECT_EQ(counters.rejected(Reject::value), 1U);
}

/// Line 0 at 100 ms, then away; the next line comes `host_ms` later and is stamped `stamp_ms`.
std::int32_t way_after_loss(const char* key, bool kept_clock, std::int64_t host_ms, std::int64_t stamp_ms,
                            std::optional<std::uint64_t>& lost) {
  OptionValues values;
  values.set(key, 2.0);
  auto expected = expected_of('D', 540, 540);
  LinkCounters counters;
  ScipDecoder decoder(counters, LineSpacing::create(values).assume_value());
  decoder.expect(expected);
  Got got;
  feed(decoder, scan_of(expected, 100, 300), 4096, 0, got);
  decoder.reset();
  expected.kept_clock = kept_clock;
  decoder.expect(expected);
  const std::string text = scan_of(expected, stamp_ms, 300);
  LineBuffer line;
  Gap gap;
  const auto step =
      decoder.decode({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, {host_ms * kMs, 0}, line, gap);
  EXPECT_EQ(step.what, Decoded::line);
  lost = decoder.lost_while_away();
  return line.xyz[1].at(0);
}

TEST(ScipDecoder, TheWayGoesOnOverALoss) {
  std::optional<std::uint64_t> lost;
  EXPECT_EQ(way_after_loss("spacing", true, 1013, 1100, lost), 200 * 40) << "by the sensor's clock: 40 scans of 25 ms";
  EXPECT_EQ(lost, 39U);
  EXPECT_EQ(way_after_loss("spacing", false, 500, 3, lost), 200 * 20) << "by the host's";
  EXPECT_EQ(lost, 19U);
  EXPECT_EQ(way_after_loss("speed", true, 1013, 1100, lost), 200) << "2 mm/s for a second";
  EXPECT_EQ(way_after_loss("speed", false, 500, 3, lost), 100);
}

TEST(ScipDecoder, EndlessTextIsBounded) {
  LinkCounters counters;
  ScipDecoder decoder(counters);
  decoder.expect(expected_of());
  Got got;
  const std::string text(5 * ScipDecoder::kMaxFrame, 'x');
  feed(decoder, text + "\n\n" + scan_of(expected_of(), 100, 300), 4096, 0, got);
  EXPECT_EQ(counters.rejected(Reject::overlong), 1U);
  EXPECT_EQ(got.clocks.size(), 1U);
}

} // namespace
} // namespace scansion
