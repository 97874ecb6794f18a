// Described streams: fields, exact numbers, sums, line ends, errors of the configuration.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/stream/decoder.hpp"

#include <gtest/gtest.h>

namespace scansion::stream {
namespace {

using Keys = std::initializer_list<std::pair<const char*, OptionValue>>;

OptionValues values_of(Keys keys) {
  OptionValues out;
  for (const Option& row : rows()) {
    if (const auto* text = std::get_if<std::string_view>(&row.standard)) out.set(row.key, std::string(*text));
    if (const auto* whole = std::get_if<std::int64_t>(&row.standard)) out.set(row.key, *whole);
    if (const auto* real = std::get_if<double>(&row.standard)) out.set(row.key, *real);
  }
  for (const auto& [key, value] : keys) out.set(key, value);
  return out;
}
OptionValue text(const char* value) {
  return std::string(value);
}

std::string reason(Keys keys) {
  auto plan = make_plan(values_of(keys));
  return plan ? "none" : plan.assume_error().context;
}

struct Bench {
  explicit Bench(Keys keys)
      : plan(make_plan(values_of(keys)).assume_value()), decoder(counters, plan, RecordReader::create(plan).assume_value()) {}

  void take(Decoder::Step& step, std::span<const std::uint8_t> bytes, const Moment& at) {
    Gap gap;
    step = decoder.decode(bytes, at, line, gap);
    if (step.what == Decoded::gap) out += "gap " + (gap.count ? std::to_string(*gap.count) : "unknown") + "; ";
    if (step.what != Decoded::line) return;
    std::size_t invalid = line.invalid_after;
    for (const Run& run : line.runs) {
      invalid += run.invalid_before;
      for (std::uint32_t i = run.first; i < run.first + run.count; ++i)
        out += std::to_string(line.xyz[0][i]) + "," + std::to_string(line.xyz[2][i]) + " ";
      if (&run != &line.runs.back()) out += "| ";
    }
    out += "!" + std::to_string(invalid) + "; ";
    line.clear();
  }
  std::string feed(std::string_view bytes, std::size_t piece = 1000, std::int64_t at_ms = 0) {
    out.clear();
    std::span<const std::uint8_t> rest(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    Decoder::Step step;
    for (; !rest.empty();) {
      auto part = rest.first(std::min(piece, rest.size()));
      rest = rest.subspan(part.size());
      do {
        take(step, part, {at_ms * 1'000'000, 0});
        part = part.subspan(step.used);
      } while (step.what != Decoded::more);
    }
    return out;
  }
  std::string finish(bool is_lost = false) {
    out.clear();
    decoder.finish({}, is_lost);
    Decoder::Step step;
    do take(step, {}, {});
    while (step.what != Decoded::more);
    return out;
  }

  LinkCounters counters;
  Plan plan;
  StreamDecoder decoder;
  LineBuffer line;
  std::string out;
};

TEST(Stream, BlankRowsEndLinesHoweverBytesAreCut) {
  for (const std::size_t piece : {1U, 2U, 7U, 1000U}) {
    Bench bench({});
    EXPECT_EQ(bench.feed("# x y z\r\n0 0 0.001\r\n 1;0;-2.5\n\n\n\nX2.0\tY0 Z:1e-2\n\n", piece),
              "0,1 1000,-2500 !0; 2000,10 !0; ");
    EXPECT_EQ(bench.counters.accepted, 3U);
    EXPECT_EQ(bench.counters.rejected(), 0U);
    EXPECT_EQ(bench.feed("1 1 1\n", piece), "");
    EXPECT_EQ(bench.finish(), "1000,1000 !0; ");
  }
}

TEST(Stream, NumbersGoExactlyToTheNearestCount) {
  const auto counts = [](std::int64_t mantissa, int exponent, Rational factor) {
    const auto rounded = round_to({mantissa, exponent, NumberKind::decimal}, factor, kMostCounts);
    return rounded ? rounded->value : INT64_MIN;
  };
  EXPECT_EQ(counts(1234567, -3, {1000, 1}), 1234567);
  EXPECT_EQ(counts(5, -4, {1000, 1}), 1); // half a count, away from zero
  EXPECT_EQ(counts(-5, -4, {1000, 1}), -1);
  EXPECT_EQ(counts(49999999999999999, -20, {1000, 1}), 0);
  EXPECT_EQ(counts(123456789012345678, -12, {1000, 1}), 123456789);
  EXPECT_EQ(counts(1, 9, {1, 1}), INT64_MIN);
  EXPECT_EQ(counts(1, 18, {1000, 1}), INT64_MIN);
  EXPECT_EQ(counts(7, 0, {127, 5}), 178); // 177.8
}

TEST(Stream, SumsAreThoseOfTheCatalogue) {
  const std::string_view nine = "123456789";
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(nine.data()), nine.size());
  EXPECT_EQ(checksum(Checksum::crc16_modbus, bytes), 0x4b37U);
  EXPECT_EQ(checksum(Checksum::crc16_ccitt, bytes), 0x29b1U);
  EXPECT_EQ(checksum(Checksum::crc32, bytes), 0xcbf43926U);
  EXPECT_EQ(checksum(Checksum::xor8, bytes), 0x31U);
  EXPECT_EQ(checksum(Checksum::sum8, bytes), 0xddU);
}

TEST(Stream, RefusedRowsAreCountedByCauseAndSplitTheLine) {
  Bench bench({{"fields", text("=P x z")}, {"null", text("-9")}});
  EXPECT_EQ(bench.feed("P 0 1\nQ 1 1\nP 2\nP 3 x\nP 1e9 1\nP 4 1 1\nP 5 1\nP 6 -9\nP 7 nan\nP 8 1\n\n"),
            "0,1000 | 5000,1000 | 8000,1000 !7; ");
  EXPECT_EQ(bench.counters.rejected(Reject::framing), 1U);
  EXPECT_EQ(bench.counters.rejected(Reject::count), 2U);
  EXPECT_EQ(bench.counters.rejected(Reject::value), 2U);
  EXPECT_EQ(bench.counters.accepted, 5U);
}

TEST(Stream, ALineNumberEndsLinesAndTellsOfLostOnes) {
  Bench bench({{"fields", text("line x z")}});
  EXPECT_EQ(bench.feed("4 0 1\n4 1 1\n5 0 1\n9 0 1\n0 0 1\n"), "0,1000 1000,1000 !0; 0,1000 !0; gap 3; 0,1000 !0; ");
}

TEST(Stream, AReversalBeginsALineAtTheFarthestPoint) {
  Bench bench({{"break", text("reversal")}, {"turn", OptionValue(2.0)}});
  EXPECT_EQ(bench.feed("0 0 0\n5 0 0\n9 0 0\n8 0 0\n9 0 1\n7.5 1 0\n4 1 0\n0 1 0\n5 2 0\n"),
            "0,0 5000,0 9000,0 8000,0 9000,1000 !0; 7500,0 4000,0 0,0 !0; ");
  EXPECT_EQ(bench.finish(), "5000,0 !0; ");
}

TEST(Stream, APauseEndsALineAtTheSameMomentHoweverItIsSeen) {
  for (const bool by_clock : {false, true}) {
    Bench bench({{"pause_ms", OptionValue(std::int64_t{50})}});
    EXPECT_EQ(bench.feed("0 0 0\n", 1000, 100), "");
    EXPECT_EQ(bench.decoder.look_for_pause({149'000'000, 0}), 150'000'000);
    if (by_clock) static_cast<void>(bench.decoder.look_for_pause({151'000'000, 0}));
    Gap gap;
    const std::string_view next = "1 0 0\n";
    static_cast<void>(bench.decoder.decode({reinterpret_cast<const std::uint8_t*>(next.data()), next.size()}, {200'000'000, 0},
                                           bench.line, gap));
    EXPECT_EQ(bench.line.points(), 1U);
    EXPECT_EQ(bench.line.stamps.host_monotonic_ns, 150'000'000);
  }
}

TEST(Stream, RecordsAreFoundAgainBehindForeignBytes) {
  Bench bench({{"format", text("binary")},
               {"fields", text("x:i16be*0.5 z:u8")},
               {"sync", text("AA55")},
               {"checksum", text("sum")},
               {"break", text("points")},
               {"points", OptionValue(std::int64_t{2})},
               {"checksum_from", OptionValue(std::int64_t{2})}});
  const std::string good("\xAA\x55\x00\x04\x01\x05", 6);
  const std::string bad("\xAA\x55\x00\x04\x01\x06", 6);
  for (const std::size_t piece : {1U, 4U, 1000U}) {
    EXPECT_EQ(bench.feed(good + "\xAA" + good + bad + "\xAA\x55\xAA" + good + good, piece),
              "2000,1000 | 2000,1000 !1; 2000,1000 2000,1000 !1; ")
        << piece;
  }
  EXPECT_EQ(bench.counters.accepted, 12U);
  EXPECT_EQ(bench.counters.rejected(Reject::framing), 3U);
  EXPECT_EQ(bench.counters.rejected(Reject::checksum), 3U);
}

TEST(Stream, TheLastRowOfAFileMayLackItsLineFeed) {
  for (const bool is_lost : {false, true}) {
    Bench bench({});
    EXPECT_EQ(bench.feed("0 0 1\n1 0 1"), "");
    EXPECT_EQ(bench.finish(is_lost), is_lost ? "0,1000 !1; " : "0,1000 1000,1000 !0; ") << "1 may have been 1.5";
    EXPECT_EQ(bench.counters.rejected(Reject::framing), is_lost ? 1U : 0U);
  }
  Bench numbers({{"fields", text("line x z")}});
  EXPECT_EQ(numbers.feed("4 0 1\n5 0 2"), "");
  EXPECT_EQ(numbers.finish(), "0,1000 !0; 0,2000 !0; ");
}

TEST(Stream, ABrokenOffRecordIsCounted) {
  Bench bench({{"format", text("binary")},
               {"fields", text("x:i16be z:u8")},
               {"break", text("points")},
               {"points", OptionValue(std::int64_t{9})}});
  EXPECT_EQ(bench.feed(std::string("\0\1\1\0", 4)), "");
  EXPECT_EQ(bench.finish(true), "1000,1000 !1; ");
}

TEST(Stream, NumbersTellWhatWasLostWhileAway) {
  Bench bench({{"fields", text("line x z")}, {"spacing", OptionValue(2.0)}});
  const auto away = [&](std::string_view rows) {
    bench.decoder.reset();
    bench.feed(rows);
    bench.finish();
    return bench.decoder.lost_while_away();
  };
  EXPECT_EQ(away("4 0 1\n"), std::nullopt);
  EXPECT_EQ(away("9 0 1\n"), 4U);
  EXPECT_EQ(away("10 0 1\n"), 0U);
  EXPECT_EQ(away("2 0 1\n"), std::nullopt) << "counts anew";
}

TEST(Stream, TheWayGoesOnOverALoss) {
  const auto place = [](Bench& bench, std::string_view rows, std::int64_t at_ms) {
    Gap gap;
    LineBuffer line;
    bench.feed(rows, 1000, at_ms);
    bench.decoder.finish({}, true);
    Decoder::Step step;
    do step = bench.decoder.decode({}, {}, line, gap);
    while (step.what == Decoded::gap);
    EXPECT_EQ(step.what, Decoded::line);
    bench.decoder.reset();
    return line.xyz[1].at(0);
  };
  Bench steps({{"fields", text("line x z")}, {"spacing", OptionValue(2.0)}});
  EXPECT_EQ(place(steps, "4 0 1\n", 0), 0);
  EXPECT_EQ(place(steps, "9 0 1\n", 0), 10'000) << "lost ones leave their room";
  EXPECT_EQ(place(steps, "2 0 1\n", 0), 12'000) << "how many is not told";
  Bench encoder({{"fields", text("x z encoder")}, {"encoder", OptionValue(0.5)}});
  EXPECT_EQ(place(encoder, "0 1 100\n", 0), 0);
  EXPECT_EQ(place(encoder, "0 1 160\n", 0), 30'000);
  Bench time({{"fields", text("x z time")}, {"speed", OptionValue(2.0)}});
  EXPECT_EQ(place(time, "0 1 10\n", 0), 0);
  EXPECT_EQ(place(time, "0 1 15\n", 5000), 10'000);
  EXPECT_EQ(place(time, "0 1 0.5\n", 8000), 16'000) << "its clock began anew: by the host's";
}

TEST(Stream, ErrorsNameKeyReasonAndFix) {
  EXPECT_NE(reason({{"fields", text("x w z")}}).find("fields = \"x w z\" has \"w\", which is none of x, y, z"),
            std::string::npos);
  EXPECT_NE(reason({{"fields", text("x y")}}).find("has not both x and z"), std::string::npos);
  EXPECT_NE(reason({{"fields", text("x:i32le z")}}).find("with a type in text; leave it out"), std::string::npos);
  EXPECT_NE(reason({{"format", text("binary")}}).find("without a type; write such as x:i32le"), std::string::npos);
  EXPECT_NE(reason({{"format", text("binary")}, {"fields", text("x:i32 z:i16le")}}).find("whose type is none of"),
            std::string::npos);
  EXPECT_NE(reason({{"format", text("binary")}, {"fields", text("x:i32le z:i16le")}}).find("choose reversal, pause or points"),
            std::string::npos);
  EXPECT_NE(reason({{"break", text("mark")}}).find("the key mark is missing"), std::string::npos);
  EXPECT_NE(reason({{"break", text("line")}}).find("fields has no \"line\"; add it"), std::string::npos);
  EXPECT_NE(reason({{"spacing", OptionValue(1.0)}}).find("but fields has y; remove one"), std::string::npos);
  EXPECT_NE(reason({{"fields", text("x z")}, {"speed", OptionValue(1.0)}}).find("fields has no time"), std::string::npos);
}

} // namespace
} // namespace scansion::stream
