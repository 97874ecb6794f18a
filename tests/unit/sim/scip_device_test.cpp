// The simulated SCIP sensor against conversations written down from the specification and from real sensors.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/hokuyo-scip/scip_text.hpp"
#include "sim/device/scip/scip_device.hpp"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>
#include <unistd.h>

namespace scansion {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(ScipText, SumsAreThoseOfRealSensors) {
  using scip::sum_of;
  const std::pair<const char*, char> known[] = {{"00", 'P'},
                                                {"99", 'b'},
                                                {"01", 'Q'},
                                                {"0E", 'e'},
                                                {"10", 'Q'},
                                                {"DMIN:20", '4'},
                                                {"DMAX:5600", '_'},
                                                {"ARES:1024", '\\'},
                                                {"AMIN:44", '7'},
                                                {"AMAX:725", 'o'},
                                                {"AFRT:384", '6'},
                                                {"SCAN:600", 'e'},
                                                {"PROT:SCIP 2.0", 'N'},
                                                {"LASR:OFF", '7'},
                                                {"1l4k", 'l'}};
  for (const auto& [text, sum] : known) EXPECT_EQ(sum_of(text), sum) << text;
}

TEST(ScipText, NumbersAreThoseOfTheSpecification) {
  const std::pair<const char*, std::int32_t> known[] = {{"CB", 1234},       {"oo", 4095},    {"1Dh", 5432},  {"00D", 20},
                                                        {"0?X", 1000},      {"7D`", 30000},  {"?om", 65533}, {"m2@0", 16000000},
                                                        {"oooo", 16777215}, {"1l4k", 508219}};
  for (const auto& [text, value] : known) {
    EXPECT_EQ(scip::decode_number(text), value) << text;
    std::string back;
    scip::encode_number(back, static_cast<std::uint32_t>(value), static_cast<unsigned>(std::string_view(text).size()));
    EXPECT_EQ(back, text);
  }
  EXPECT_FALSE(scip::decode_number("0p0"));
  EXPECT_FALSE(scip::decode_number("0/0"));
}

/// A flat plate 300 mm below the sensor, and a model of it.
class Scip : public testing::Test {
protected:
  void SetUp() override {
    path_ = testing::TempDir() + "scansion-scip-" + std::to_string(::getpid()) + ".xyz";
    std::ofstream file(path_);
    for (int line = 0; line < 5; ++line) file << -500 << ' ' << line << " 0\n" << 500 << ' ' << line << " 0\n\n";
  }
  void TearDown() override { ::unlink(path_.c_str()); }

  ScipDevice& device(ScipPlan plan = {}) {
    plan.model.name = "UTM-30LX";
    PlayPlan play;
    play.scan = path_;
    device_ = std::make_unique<ScipDevice>(LineSource::open(play).assume_value(), std::move(plan));
    device_->power_up(0);
    return *device_;
  }
  std::string ask(std::string_view text, std::int64_t now_ns = 0) {
    device_->receive({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, now_ns);
    return heard(now_ns);
  }
  std::string heard(std::int64_t now_ns) {
    std::vector<std::uint8_t> out;
    while (device_->send(now_ns, out)) {
    }
    return {out.begin(), out.end()};
  }

  std::string path_;
  std::unique_ptr<ScipDevice> device_;
};

TEST_F(Scip, AnswersAsTheSpecificationSays) {
  device();
  const std::pair<const char*, const char*> talk[] = {
      {"\n", ""},
      {"QT\n", "QT\n00P\n\n"},
      {"QT\r\n", "QT\n00P\n\n"},
      {"XX\n", "XX\n0Ee\n\n"},
      {"GD0384038401\n", "GD0384038401\n10Q\n\n"},
      {"BM\n", "BM\n00P\n\n"},
      {"BM\n", "BM\n02R\n\n"},
      {"MD038X038401001\n", "MD038X038401001\n01Q\n\n"},
      {"MD0384X38401001\n", "MD0384X38401001\n02R\n\n"},
      {"MD03840384X1001\n", "MD03840384X1001\n03S\n\n"},
      {"MD0384038401X01\n", "MD0384038401X01\n06V\n\n"},
      {"MD03840384010X1\n", "MD03840384010X1\n07W\n\n"},
      {"MD0400038401001\n", "MD0400038401001\n05U\n\n"},
      {"MD0384999901001\n", "MD0384999901001\n04T\n\n"},
      {"MD03840384\n", "MD03840384\n0Cc\n\n"},
      {"MD03840384010010\n", "MD03840384010010\n0Dd\n\n"},
      {"QT;12345678901234567\n", "QT;12345678901234567\n0Gg\n\n"},
      {"QT;a-b\n", "QT;a-b\n0Hh\n\n"},
      {"TM1\n", "TM1\n04T\n\n"},
      {"TM0\n", "TM0\n00P\n\n"},
      {"TM0\n", "TM0\n02R\n\n"},
      {"TM2\n", "TM2\n00P\n\n"},
      {"TM2\n", "TM2\n03S\n\n"},
      {"TM3\n", "TM3\n01Q\n\n"},
      {"RS;tag\n", "RS;tag\n00P\n\n"},
      {"%ST\n", "%ST\n00P\n000@\n\n"},
      {"RB\n", "RB\n01Q\n\n"},
  };
  for (const auto& [question, answer] : talk) EXPECT_EQ(ask(question), answer) << question;
}

TEST_F(Scip, ClockCountsMillisecondsAndWraps) {
  ScipPlan plan;
  plan.clock_ms = 16777215;
  device(plan);
  ask("TM0\n");
  EXPECT_EQ(ask("TM1\n", 0), "TM1\n00P\noooo" + std::string(1, scip::sum_of("oooo")) + "\n\n");
  EXPECT_EQ(ask("TM1\n", kMs), "TM1\n00P\n00000\n\n");
}

TEST_F(Scip, MeasuresThePlateAndCountsDown) {
  device();
  EXPECT_EQ(ask("MD0540054001002;abc\n"), "MD0540054001002;abc\n00P\n\n");
  EXPECT_EQ(heard(24 * kMs), "");
  EXPECT_EQ(heard(25 * kMs), "MD0540054001001;abc\n99b\n00000\n04\\0\n\n"); // 300 mm
  EXPECT_EQ(heard(50 * kMs), "MD0540054001000;abc\n99b\n000II\n04\\0\n\n"); // 25 ms
  EXPECT_EQ(heard(900 * kMs), "");
  EXPECT_EQ(ask("%ST\n"), "%ST\n00P\n000@\n\n") << "the laser is off again";
}

TEST_F(Scip, FramesAreAsLongAsThoseOfTheSensor) {
  device();
  ask("BM\n");
  EXPECT_EQ(ask("MD0000108001001\n").size() + heard(25 * kMs).size(), 16U + 3 + 1 + 1 + 3372);
  EXPECT_EQ(ask("ME0000108001001\n").size() + heard(50 * kMs).size(), 16U + 3 + 1 + 1 + 6717);
}

TEST_F(Scip, EveryRayMeetsThePlate) {
  PlayPlan play;
  play.scan = path_;
  auto source = LineSource::open(play).assume_value();
  PlayedLine line;
  ASSERT_TRUE(source.next(line).assume_value());
  std::vector<ScipSample> samples;
  const ScipModel model;
  scip_scan(line, source, model, {0.0, 300.0}, samples);
  ASSERT_EQ(samples.size(), 1081U);
  int seen = 0;
  for (std::int32_t step = 0; step <= 1080; ++step) {
    const double angle = 2.0 * std::numbers::pi * (step - 540) / 1440;
    const double range = 300.0 / std::cos(angle);
    const bool is_on_plate = std::cos(angle) > 0.0 && std::abs(300.0 * std::tan(angle)) <= 500.0;
    EXPECT_EQ(samples[static_cast<std::size_t>(step)].echoes[0].distance, is_on_plate ? std::lround(range) : 1) << step;
    seen += is_on_plate;
  }
  EXPECT_EQ(seen, 473);
}

TEST_F(Scip, RestartsWhenToldTwice) {
  device();
  EXPECT_EQ(ask("RB\n", 0), "RB\n01Q\n\n");
  EXPECT_EQ(ask("RB\n", 1100 * kMs), "RB\n01Q\n\n") << "too late";
  EXPECT_FALSE(device_->drops_link());
  device_->receive({reinterpret_cast<const std::uint8_t*>("RB\n"), 3}, 1200 * kMs);
  EXPECT_FALSE(device_->drops_link()) << "the answer goes first";
  EXPECT_EQ(heard(1200 * kMs), "RB\n00P\n\n");
  EXPECT_TRUE(device_->drops_link());
  EXPECT_FALSE(device_->drops_link());
}

TEST_F(Scip, OldModeKnowsOneCommand) {
  ScipPlan plan;
  plan.starts_in_scip1 = true;
  device(plan);
  EXPECT_EQ(ask("\nQT\r\n"), "\nE\n\nQT\nE\n\n");
  EXPECT_EQ(ask("SCIP2.0\n"), "SCIP2.0\n0\n\n");
  EXPECT_EQ(ask("QT\n"), "QT\n00P\n\n");
}

} // namespace
} // namespace scansion
