// The simulated controller says what a real one was seen to say (Grbl 1.1h, grblHAL where named).
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/grbl/bench.hpp"

#include <utility>

namespace scansion::grbl::test {
namespace {

class Controller : public testing::Test {
protected:
  void SetUp() override { power(Dialect::grbl); }
  void power(Dialect dialect) {
    FirmwareOptions options;
    options.dialect = dialect;
    options.surface = [](double x, double) { return x > 50.0 ? -100.0 : -5.0; };
    machine_.emplace(std::move(options), Settings());
    machine_->power_on(now_);
    static_cast<void>(heard());
  }
  /// Sends, lets `time` go by, and gives what was said, lines joined by '|'.
  std::string say(std::string_view text, Ns time = 10 * kS) {
    machine_->receive({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, now_);
    now_ += time;
    machine_->run_until(now_);
    return heard();
  }
  std::string heard() {
    std::string out;
    for (const char c : std::exchange(machine_->output(), {})) {
      if (c == '\n')
        out += '|';
      else if (c != '\r')
        out += c;
    }
    return out;
  }

  std::optional<Firmware> machine_;
  Ns now_ = 0;
};

TEST_F(Controller, AnswersEachLineOnce) {
  std::string longest(80, 'A'), longer(81, 'A');
  longest.back() = longer.back() = '\n';
  const std::vector<std::pair<std::string_view, std::string_view>> talk{
      {"\r\n", "ok|ok|"},       {"%\n", "error:1|"},          {"(comment)\n ; more\n", "ok|ok|"},
      {"g1 x1\n", "error:22|"}, {"G38.2F100\n", "error:26|"}, {"G38.2Z0F100\n", "error:33|"},
      {longest, "error:2|"},    {longer, "error:11|"},        {"\xC3\xA4\n", "ok|"}};
  for (const auto& [sent, answer] : talk) EXPECT_EQ(say(sent), answer) << sent;
}

TEST_F(Controller, ProbeCyclesEndAsObserved) {
  EXPECT_EQ(say("G38.2Z-10F300\n", 60 * kS), "[PRB:0.000,0.000,-5.000:1]|ok|");
  EXPECT_EQ(say("G38.2Z-10\n", 60 * kS), "ALARM:4|ok|");
  EXPECT_EQ(say("G0X1\n"), "error:9|");
  EXPECT_EQ(say("$J=G91X1F100\n"), "error:8|");
  EXPECT_EQ(say("$X\n"), "[MSG:Caution: Unlocked]|ok|");
  EXPECT_EQ(say("$X\n"), "ok|");
  EXPECT_EQ(say("G0Z0\nG0X60\n", 60 * kS), "ok|ok|");
  EXPECT_EQ(say("G38.2Z-10\n", 60 * kS), "ALARM:5|[PRB:0.000,0.000,-5.000:0]|ok|") << "the contact before, stale";
  EXPECT_EQ(say("$X\nG0Z0\n", 60 * kS), "[MSG:Caution: Unlocked]|ok|ok|");
  EXPECT_EQ(say("G38.3Z-10\n", 60 * kS), "[PRB:60.000,0.000,-10.000:0]|ok|");
  EXPECT_EQ(say("$C\nG38.2Z-1F9\n"), "[MSG:Enabled]|ok|ok|");

  power(Dialect::grblhal);
  EXPECT_EQ(say("G0X60\n", 60 * kS), "ok|");
  EXPECT_EQ(say("G38.2Z-10F300\n", 60 * kS), "ALARM:5|[PRB:60.000,0.000,-10.000:0]|ok|");
}

TEST_F(Controller, TipOvershootsAsFarAsBrakingTakes) {
  ASSERT_EQ(say("G38.2Z-10F300\n", 60 * kS), "[PRB:0.000,0.000,-5.000:1]|ok|");
  // v*v/2a + 0.05 s * v at 5 mm/s and 10 mm/s2
  EXPECT_NEAR(machine_->true_place(now_)[2], -6.5, 0.01);
}

TEST_F(Controller, ReceiveBufferHolds128Bytes) {
  const std::string fill(129, '\n');
  EXPECT_EQ(say("G4P1\n", 0), "");
  static_cast<void>(say(fill, 0));
  EXPECT_EQ(machine_->lost_bytes(), 1U);
}

TEST_F(Controller, HoldKeepsTheProbeLineUnanswered) {
  EXPECT_EQ(say("G38.2Z-10F100\n", kS), "");
  EXPECT_EQ(say("!", 10 * kMs), "");
  EXPECT_TRUE(say("?", 5 * kS).starts_with("<Hold:1|"));
  EXPECT_TRUE(say("?").starts_with("<Hold:0|"));
  EXPECT_EQ(say("~", 60 * kS), "[PRB:0.000,0.000,-5.000:1]|ok|");
}

TEST_F(Controller, ResetsAnswerTheLineInWorkAndClearTheContact) {
  EXPECT_EQ(say("G38.2Z-10F100\n", kS), "");
  EXPECT_EQ(say("\x18"), "ALARM:3|ok||Grbl 1.1h ['$' for help]|[MSG:'$H'|'$X' to unlock]|");
  EXPECT_EQ(say("$X\nG0Z0\n"), "[MSG:Caution: Unlocked]|ok|ok|");
  EXPECT_EQ(say("G1X5F60\n", kS), "ok|");
  EXPECT_EQ(say("\x18"), "ALARM:3||Grbl 1.1h ['$' for help]|[MSG:'$H'|'$X' to unlock]|") << "G1 was answered long ago";
  EXPECT_NE(say("$#\n").find("[PRB:0.000,0.000,0.000:0]|ok|"), std::string::npos);

  power(Dialect::grbl);
  EXPECT_EQ(say("G38.2Z-10F100\n", 60 * kS), "[PRB:0.000,0.000,-5.000:1]|ok|");
  EXPECT_TRUE(say("\x18").starts_with("ALARM:3|")) << "Idle, but the cancelled motion left its flag";
  power(Dialect::grblhal);
  EXPECT_EQ(say("G38.2Z-10F100\n", kS), "");
  EXPECT_TRUE(say("\x18").starts_with("ALARM:3||GrblHAL"));
}

TEST_F(Controller, SoftLimitsAreDeafUntilReset) {
  machine_->settings().force(22, 1.0);
  machine_->settings().force(20, 1.0);
  EXPECT_EQ(say("G38.2Z-300F100\n"), "ALARM:2|[MSG:Reset to continue]|");
  EXPECT_EQ(say("?\n$X\n"), "");
  EXPECT_EQ(say("\x18"), "ok||Grbl 1.1h ['$' for help]|[MSG:'$H'|'$X' to unlock]|");
}

TEST_F(Controller, AlarmsPauseBeforeTheyGoOn) {
  machine_->settings().force(22, 1.0);
  machine_->settings().force(20, 1.0);
  EXPECT_EQ(say("G0X300\n", 499 * kMs), "ALARM:2|");
  EXPECT_EQ(say("", kMs), "[MSG:Reset to continue]|");
  static_cast<void>(say("\x18"));
  EXPECT_EQ(say("$X\n"), "[MSG:Caution: Unlocked]|ok|");
  EXPECT_EQ(say("G38.3Z-10F3000\n"), "[PRB:0.000,0.000,-5.000:1]|ok|");
  EXPECT_EQ(say("G38.3Z-10\n", 100 * kMs), "ALARM:4|");
  EXPECT_EQ(say("?", 399 * kMs), "");
  const std::string rest = say("", kMs);
  EXPECT_TRUE(rest.starts_with("<Alarm|")) << rest;
  EXPECT_TRUE(rest.ends_with(">|ok|")) << rest;
}

TEST_F(Controller, HomingIsNeededAfterPowerWhenItIsOn) {
  EXPECT_EQ(say("$H\n"), "error:5|");
  machine_->settings().force(22, 1.0);
  machine_->power_on(now_);
  EXPECT_EQ(heard(), "|Grbl 1.1h ['$' for help]|[MSG:'$H'|'$X' to unlock]|");
  EXPECT_EQ(say("$H\n", kS), "");
  EXPECT_EQ(say("?", kMs), "") << "deaf while it homes";
  static_cast<void>(say("", 600 * kS));
  EXPECT_TRUE(say("?").starts_with("<Idle|MPos:-1.000,-1.000,-1.000|"));
}

TEST_F(Controller, OffsetsComeWithTheFirstAndEveryTenthReport) {
  std::string pattern;
  for (int i = 0; i < 12; ++i) {
    const std::string report = say("?", kMs);
    pattern += report.find("WCO:") != std::string::npos ? 'W' : report.find("Ov:") != std::string::npos ? 'O' : '-';
  }
  EXPECT_EQ(pattern, "WO--------WO");
}

TEST_F(Controller, PollsInABurstAreAnsweredOnce) {
  const std::string reports = say("????????????????????");
  EXPECT_EQ(std::count(reports.begin(), reports.end(), '<'), 1);
}

} // namespace
} // namespace scansion::grbl::test
