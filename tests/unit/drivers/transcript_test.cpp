// Raw events as text, the ring that keeps them, and transcripts played back.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/raw_ring.hpp"
#include "drivers/transport/raw_tap.hpp"
#include "drivers/transport/transcript.hpp"

#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

namespace scansion {
namespace {

std::span<const std::uint8_t> bytes_of(std::string_view text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

TEST(RawEvent, EveryByteComesBack) {
  std::vector<std::uint8_t> all(256);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);
  std::string text;
  append_event(text, RawEvent::Kind::received, {-5, 1'700'000'000'000'000'000}, all);
  ASSERT_EQ(text.find('\n'), text.size() - 1);
  auto event = parse_event(std::string_view(text).substr(0, text.size() - 1));
  ASSERT_TRUE(event);
  EXPECT_EQ(event.assume_value(), (RawEvent{RawEvent::Kind::received, {-5, 1'700'000'000'000'000'000}, all}));
}

TEST(RawEvent, BadLinesSayWhatIsWrong) {
  for (const char* text : {"", "<", "x 1 2 a", "< 1", "< 1 b", "< 1 2 \\q", "< 1 2 \\x0", "< 1 2 \\", "<1 2 a"}) {
    auto event = parse_event(text);
    ASSERT_FALSE(event) << text;
    EXPECT_EQ(event.assume_error().code, Errc::undecodable);
  }
}

TEST(RawRing, KeepsTheNewestInBoundedMemory) {
  RawRing ring;
  EXPECT_FALSE(ring.has_received());
  EXPECT_EQ(ring.transcript(), "");
  const std::string block(1000, 'x');
  for (int i = 0; i < 2000; ++i) ring.push(RawEvent::Kind::received, {i, i}, bytes_of(block));
  ring.push(RawEvent::Kind::sent, {5000, 5000}, bytes_of("last\n"));
  EXPECT_TRUE(ring.has_received());
  const std::string text = ring.transcript();
  EXPECT_LT(text.size(), RawRing::kBytes);
  EXPECT_GT(text.size(), RawRing::kBytes / 2);
  EXPECT_TRUE(text.starts_with(kTranscriptHeading));
  EXPECT_TRUE(text.ends_with("> 5000 5000 last\\n\n"));
  EXPECT_EQ(text.find("< 0 0 "), std::string::npos);
}

class Transcript : public testing::Test {
protected:
  void SetUp() override {
    path_ = testing::TempDir() + "scansion-transcript-" + std::to_string(::getpid()) + ".raw";
    ::unlink(path_.c_str());
  }
  void TearDown() override { ::unlink(path_.c_str()); }
  void write(std::string_view text) { std::ofstream(path_) << text; }

  static std::string read_all(Transport& transport) {
    std::string out;
    std::uint8_t buffer[3]; // smaller than what comes
    for (;;) {
      auto arrival = transport.read(buffer, 0);
      if (!arrival) return out + "[" + arrival.assume_error().context + "]";
      if (arrival.assume_value().count == 0) return out + (arrival.assume_value().end ? "[end]" : "");
      out.append(reinterpret_cast<const char*>(buffer), arrival.assume_value().count);
    }
  }

  std::string path_;
};

TEST_F(Transcript, GivesBytesAtTheirTimesAndTakesWhatWasSent) {
  write("# scansion raw transcript 1\nO 10 1010\n> 20 1020 ask\\n\n< 30 1030 answer\\n\nL 40 1040 gone\nC 41 1041\n"
        "O 50 1050\n< 60 1060 again\nC 70 1070\n");
  auto played = transcript_transport(path_);
  ASSERT_TRUE(played->open());
  EXPECT_FALSE(played->is_live());
  EXPECT_EQ(played->now(), (Moment{10, 1010}));
  EXPECT_EQ(read_all(*played), "") << "the device waits for the question";
  ASSERT_TRUE(played->write("ask", 0));
  ASSERT_TRUE(played->write("\n", 0));
  EXPECT_EQ(played->now(), (Moment{20, 1020}));
  EXPECT_EQ(read_all(*played), "answer\n[" + path_ + ":6: then: gone]");
  played->close();
  ASSERT_TRUE(played->open());
  EXPECT_EQ(read_all(*played), "again[end]");
  EXPECT_EQ(played->now(), (Moment{70, 1070}));
}

TEST_F(Transcript, IsOverWhenItIsOpenedBehindItsLastRun) {
  write("# scansion raw transcript 1\nO 1 1\n< 2 2 a\nL 3 3 gone\nC 4 4\n");
  auto transport = transcript_transport(path_);
  ASSERT_TRUE(transport->open());
  std::array<std::uint8_t, 8> bytes{};
  EXPECT_TRUE(transport->read(bytes, 100));
  EXPECT_FALSE(transport->read(bytes, 100));
  EXPECT_FALSE(transport->is_over());
  transport->close();
  ASSERT_TRUE(transport->open());
  EXPECT_TRUE(transport->is_over());
}

TEST_F(Transcript, OtherQuestionsAreRefused) {
  write("O 10 1010\n> 20 1020 ask\n< 30 1030 answer\n");
  auto played = transcript_transport(path_);
  ASSERT_TRUE(played->open());
  auto written = played->write("tell", 0);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.assume_error().code, Errc::undecodable);
}

TEST_F(Transcript, ATimerMayBeDueWhereTheDeviceWasLeftThen) {
  for (const bool is_last : {true, false}) {
    write(std::string("O 10 1010\n> 20 1020 ask\n< 30 1030 answer\n> 40 1040 bye\n< 50 1050 bye\n") +
          (is_last ? "" : "> 60 1060 more\n") + "C 70 1070\n");
    auto played = transcript_transport(path_);
    ASSERT_TRUE(played->open());
    ASSERT_TRUE(played->write("ask", 0));
    EXPECT_EQ(read_all(*played), "answer");
    EXPECT_EQ(bool(played->write("ask", 0)), is_last);
    if (is_last) {
      EXPECT_EQ(read_all(*played), "[end]");
    }
  }
}

TEST_F(Transcript, EndsForGoodAtItsBound) {
  const std::string played = path_ + ".played";
  std::ofstream(played) << "O 10 1010\n< 20 1020 12345\n< 30 1030 12345\n< 40 1040 1\nC 50 1050\n";
  for (int run = 0; run < 2; ++run) { // neither a shorter event nor another process goes on
    auto ring = std::make_shared<RawRing>();
    RawTap tap(transcript_transport(played), ring, path_, 60);
    ASSERT_TRUE(tap.open());
    EXPECT_EQ(read_all(tap), "1234512345"
                             "1[end]");
    tap.close();
    EXPECT_GT(ring->dropped(), 0U);
    std::ifstream file(path_);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}),
              "# scansion raw transcript 1\nO 10 1010\n< 20 1020 123\n"
              "# the bound of this transcript is reached; what came later is not here\n");
  }
  ::unlink(played.c_str());
}

TEST_F(Transcript, OfATranscriptIsTheSame) {
  const std::string text = "# scansion raw transcript 1\nO 10 1010\n< 30 1030 one\\xff\nC 30 1030\n";
  write(text);
  const std::string copy = path_ + ".copy";
  ::unlink(copy.c_str());
  auto ring = std::make_shared<RawRing>();
  {
    RawTap tap(transcript_transport(path_), ring, copy);
    ASSERT_TRUE(tap.open());
    std::uint8_t buffer[64];
    auto arrival = tap.read(buffer, 0);
    ASSERT_TRUE(arrival);
    EXPECT_EQ(arrival.assume_value().count, 4U);
    tap.close();
  }
  EXPECT_EQ(ring->transcript(), text);
  std::ifstream file(copy);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), text);
  ::unlink(copy.c_str());
}

} // namespace
} // namespace scansion
