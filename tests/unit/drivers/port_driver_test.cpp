// The template decoder, lines of text and line spacing.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/port/link_counters.hpp"
#include "drivers/port/spacing.hpp"
#include "drivers/port/text_lines.hpp"
#include "drivers/port/way.hpp"
#include "drivers/template/decoder.hpp"

#include <gtest/gtest.h>

namespace scansion {
namespace {

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// Everything a decoder makes of `text`, cut into pieces of `piece` bytes.
std::string decoded(Decoder& decoder, std::string_view text, std::size_t piece) {
  std::string out;
  LineBuffer line;
  Gap gap;
  for (std::size_t at = 0; at < text.size(); at += piece) {
    auto bytes = bytes_of(text.substr(at, piece));
    for (;;) {
      const auto step = decoder.decode(bytes, {}, line, gap);
      bytes = bytes.subspan(step.used);
      if (step.what == Decoded::more) break;
      if (step.what == Decoded::line) out += "line " + std::to_string(line.points()) + "; ";
      if (step.what == Decoded::gap) out += "gap " + std::to_string(*gap.count) + "; ";
      if (step.what == Decoded::reply) out += "reply; ";
      line.clear();
    }
    EXPECT_TRUE(bytes.empty());
  }
  return out;
}

std::string profile(std::string text) {
  unsigned sum = 0;
  for (const char c : text) sum ^= static_cast<unsigned char>(c);
  char tail[8];
  std::snprintf(tail, sizeof tail, "*%02X\n", sum);
  return text + tail;
}

TEST(TemplateDecoder, GivesTheSameHoweverBytesAreCut) {
  const std::string text = "OK\n" + profile("P,0,2,0,1,2,3") + "noise\n" + profile("P,4,1,7,8") + profile("P,5,2,7,8");
  for (const std::size_t piece : {std::size_t{1}, std::size_t{2}, std::size_t{7}, text.size()}) {
    LinkCounters counters;
    TemplateDecoder decoder(counters);
    EXPECT_EQ(decoded(decoder, text, piece), "reply; line 2; gap 3; line 1; ") << piece;
    EXPECT_EQ(counters.accepted, 3U);
    EXPECT_EQ(counters.rejected(Reject::framing), 1U);
    EXPECT_EQ(counters.rejected(Reject::count), 1U);
    EXPECT_EQ(counters.rejected(), 2U);
  }
}

TEST(TextLines, OverlongLinesAreCountedOnceAndSkipped) {
  LinkCounters counters;
  TextLines lines(4, counters);
  std::size_t used = 0;
  const auto bytes = bytes_of("12345678\nab\r\n\n1234\nx");
  EXPECT_EQ(lines.next(bytes, used), "ab");
  EXPECT_EQ(lines.next(bytes, used), "");
  EXPECT_EQ(lines.next(bytes, used), "1234");
  EXPECT_EQ(lines.next(bytes, used), std::nullopt);
  EXPECT_EQ(used, bytes.size());
  EXPECT_EQ(counters.rejected(Reject::overlong), 1U);
}

TEST(LineSpacing, FollowsStepSpeedOrEncoder) {
  OptionValues values;
  EXPECT_DOUBLE_EQ(LineSpacing::create(values).assume_value().way_mm(3, 0, 0), 3.0);
  values.set("speed", 20.0);
  EXPECT_DOUBLE_EQ(LineSpacing::create(values).assume_value().way_mm(3, 500'000'000, 7), 10.0);
  values.set("encoder", 0.5);
  EXPECT_FALSE(LineSpacing::create(values));
}

TEST(Way, GoesOnOverALoss) {
  OptionValues values;
  values.set("encoder", 0.5);
  Way way(LineSpacing::create(values).assume_value());
  EXPECT_DOUBLE_EQ(way.at({.encoder = -7}), 0.0);
  EXPECT_DOUBLE_EQ(way.at({.encoder = 3}), 5.0);
  way.go_on(1, 0); // the device was switched off: what moved meanwhile is not known
  EXPECT_DOUBLE_EQ(way.at({.encoder = 0}), 5.0);
  EXPECT_DOUBLE_EQ(way.at({.encoder = -2}), 4.0);
  way.go_on(1, 0);
  way.go_on(1, 0); // twice without a line between is once
  EXPECT_DOUBLE_EQ(way.at({.encoder = INT64_MAX}), 4.0);
  EXPECT_DOUBLE_EQ(way.at({.encoder = INT64_MIN}), 4.5) << "over a wrap";
}

} // namespace
} // namespace scansion
