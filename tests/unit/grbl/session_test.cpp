// A whole raster against the simulated controller, and every way it can go wrong.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/grbl/bench.hpp"

namespace scansion::grbl::test {
namespace {

TEST(GrblSession, RasterGivesTheSurface) {
  for (const Dialect dialect : {Dialect::grbl, Dialect::grblhal}) {
    Bench bench({.dialect = dialect});
    bench.connect();
    ASSERT_TRUE(bench.finish()) << bench.failure() << bench.log();
    bench.expect_whole_scan();
    EXPECT_EQ(bench.session().counts().repeats, 0U);
    EXPECT_EQ(bench.session().counts().strays, 0U);
    EXPECT_EQ(bench.sent_lines("$X"), 0U);
    EXPECT_EQ(bench.log().find('\x18'), std::string::npos);
    EXPECT_NEAR(bench.firmware().true_place(bench.now())[2], 0.0, 0.002);
  }
}

TEST(GrblSession, InchReportsGiveTheSurfaceToo) {
  Bench bench;
  bench.firmware().settings().force(13, 1.0);
  bench.connect();
  ASSERT_TRUE(bench.finish()) << bench.failure();
  EXPECT_TRUE(bench.session().machine().reports_inches);
  for (const Row& row : bench.rows()) {
    for (const auto& point : row.points) {
      ASSERT_TRUE(point);
      const double x = static_cast<double>((*point)[0]) * 0.00254, y = static_cast<double>((*point)[1]) * 0.00254;
      EXPECT_NEAR(static_cast<double>((*point)[2]) * 0.00254, wavy(x, y) - 0.002, 0.006);
    }
  }
}

TEST(GrblSession, WorkOffsetsDoNotMoveTheRaster) {
  Bench bench;
  const std::string_view line = "G10L2P1X5Y-3Z2.25\n";
  bench.firmware().receive({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, bench.now());
  bench.firmware().settings().force(10, 0.0); // reports WPos
  bench.connect();
  ASSERT_TRUE(bench.finish()) << bench.failure();
  bench.expect_whole_scan();
}

TEST(GrblSession, HolesAreRecordedAsSuch) {
  BenchOptions options;
  options.surface = [](double x, double y) { return x > 4.0 && x < 6.0 ? -50.0 : wavy(x, y); };
  Bench bench(options);
  bench.connect();
  ASSERT_TRUE(bench.finish()) << bench.failure();
  ASSERT_EQ(bench.rows().size(), 3U);
  for (const Row& row : bench.rows()) {
    EXPECT_TRUE(row.points[0]);
    EXPECT_FALSE(row.points[1]);
    EXPECT_TRUE(row.points[2]);
  }
  EXPECT_EQ(bench.session().counts().misses, 3U);
}

TEST(GrblSession, TooManyHolesTogetherEndIt) {
  BenchOptions options;
  options.max_misses = 4;
  Bench bench(options);
  bench.firmware().set_contact_missing(true);
  bench.connect();
  EXPECT_FALSE(bench.finish());
  ASSERT_TRUE(bench.session().failure());
  EXPECT_EQ(bench.session().failure()->code, Errc::attention);
  EXPECT_NE(bench.failure().find("is the probe connected"), std::string::npos) << bench.failure();
}

TEST(GrblSession, NeverUnlocksAMachineThatIsLockedAtTheStart) {
  Bench bench;
  bench.firmware().settings().force(22, 1.0);
  bench.firmware().power_on(bench.now());
  bench.connect();
  EXPECT_FALSE(bench.finish());
  ASSERT_TRUE(bench.session().failure());
  EXPECT_EQ(bench.session().failure()->code, Errc::attention);
  EXPECT_NE(bench.failure().find("home it"), std::string::npos);
  EXPECT_EQ(bench.log().find("$X"), std::string::npos);
  EXPECT_EQ(bench.log().find("$H"), std::string::npos);
}

TEST(GrblSession, RefusesAClosedProbeAndAnAreaThatIsTooLarge) {
  Bench closed;
  closed.firmware().set_pin_stuck(true);
  closed.connect();
  EXPECT_FALSE(closed.finish());
  EXPECT_NE(closed.failure().find("Pn:P"), std::string::npos) << closed.failure();

  Bench inverted;
  inverted.firmware().settings().force(6, 1.0);
  inverted.connect();
  EXPECT_FALSE(inverted.finish());
  EXPECT_NE(inverted.failure().find("$6"), std::string::npos);

  Bench large;
  large.firmware().settings().force(130, 5.0);
  large.connect();
  EXPECT_FALSE(large.finish());
  EXPECT_EQ(large.session().failure()->code, Errc::config);
  EXPECT_NE(large.failure().find("$130=5.000"), std::string::npos) << large.failure();
}

TEST(GrblSession, EveryAlarmEndsItWithoutUnlocking) {
  for (int number = 1; number <= 10; ++number) {
    Bench bench;
    bench.connect();
    ASSERT_TRUE(bench.until_sent("G53G0X", 3)) << bench.failure();
    bench.firmware().raise_alarm(number);
    EXPECT_FALSE(bench.finish());
    ASSERT_TRUE(bench.session().failure()) << number;
    EXPECT_EQ(bench.session().failure()->code, Errc::attention);
    const std::size_t before = bench.log().size();
    for (int i = 0; i < 50; ++i) bench.step();
    EXPECT_EQ(bench.log().size(), before) << "nothing is sent to a machine in alarm " << number;
    EXPECT_EQ(bench.log().find("$X"), std::string::npos) << number;
  }
}

TEST(GrblSession, BannerInMidJobIsALostPosition) {
  Bench bench;
  bench.connect();
  ASSERT_TRUE(bench.until_sent("G38", 4));
  bench.firmware().power_on(bench.now() + 100 * kMs);
  EXPECT_FALSE(bench.finish());
  ASSERT_TRUE(bench.session().failure());
  EXPECT_EQ(bench.session().failure()->code, Errc::attention);
  EXPECT_NE(bench.failure().find("position is lost"), std::string::npos) << bench.failure();
  const std::size_t before = bench.log().size();
  for (int i = 0; i < 50; ++i) bench.step();
  EXPECT_EQ(bench.log().size(), before);
  // Coming back, it sees by itself that the controller has forgotten where it is.
  bench.connect({.rows = 0, .has_begun = true});
  EXPECT_FALSE(bench.finish());
  EXPECT_NE(bench.failure().find("position is lost"), std::string::npos) << bench.failure();
}

TEST(GrblSession, StuckPinIsSeenAndToldApartFromABadStart) {
  Bench bench;
  bench.connect();
  ASSERT_TRUE(bench.until_sent("G38", 2));
  ASSERT_TRUE(bench.until_sent("G53G0Z", 3));
  bench.firmware().set_pin_stuck(true);
  EXPECT_FALSE(bench.finish());
  ASSERT_TRUE(bench.session().failure());
  EXPECT_NE(bench.failure().find("stays closed"), std::string::npos) << bench.failure();
  EXPECT_EQ(bench.sent_lines("$X"), 1U); // ALARM 4 of its own probing may be cleared

  Bench passing;
  passing.connect();
  ASSERT_TRUE(passing.until_sent("G38", 2));
  ASSERT_TRUE(passing.until_sent("G53G0Z", 3));
  passing.firmware().set_pin_stuck(true);
  ASSERT_TRUE(passing.until_sent("$X"));
  passing.firmware().set_pin_stuck(false);
  ASSERT_TRUE(passing.finish()) << passing.failure();
  passing.expect_whole_scan();
}

TEST(GrblSession, ReportsOnTheirWayWhileItUnlocksAreNoNewAlarm) {
  // The pin closes for a moment at another place of the poll's beat each time, and wires are slow.
  for (Ns wire = 0; wire <= 30 * kMs; wire += 3 * kMs) {
    for (int beat = 0; beat < 8; ++beat) {
      Bench bench({.wire = wire});
      bench.connect();
      ASSERT_TRUE(bench.until_sent("G38", 3));
      ASSERT_TRUE(bench.until_sent("G53G0Z", 3));
      const Ns begin = bench.now() + Ns{25} * beat * kMs;
      ASSERT_TRUE(bench.run([&] { return bench.now() >= begin; }));
      bench.firmware().set_pin_stuck(true);
      const bool unlocks = bench.until_sent("$X");
      bench.firmware().set_pin_stuck(false);
      ASSERT_TRUE(unlocks && bench.finish()) << wire << ' ' << beat << bench.failure();
      bench.expect_whole_scan();
    }
  }
}

TEST(GrblSession, ContactAboveTheTopEndsItWithoutAMove) {
  BenchOptions options;
  options.area.top = -5.0;
  options.surface = [](double x, double) { return x > 6.0 ? -4.0 : -8.0; };
  options.area.x_from = 7.0; // the machine stands at 0, above the top
  Bench bench(options);
  bench.connect();
  EXPECT_FALSE(bench.finish());
  EXPECT_NE(bench.failure().find("above top"), std::string::npos) << bench.failure();
  EXPECT_EQ(bench.sent_lines("G38"), 1U);
  EXPECT_TRUE(bench.rows().empty());
}

TEST(GrblSession, AsksTenTimesASecondAtMost) {
  for (const bool holds : {false, true}) {
    Bench bench;
    bench.connect();
    ASSERT_TRUE(bench.until_sent("G38", 2));
    if (holds) bench.session().hold(bench.now());
    const auto asked = [&] { return std::count(bench.log().begin(), bench.log().end(), '?'); };
    const auto before = asked();
    const Ns until = bench.now() + 2 * kS;
    ASSERT_TRUE(bench.run([&] { return bench.now() >= until; }));
    EXPECT_LE(asked() - before, 21);
  }
  Bench greeting;
  greeting.connect();
  const Ns until = greeting.now() + 2 * kS;
  ASSERT_TRUE(greeting.run([&] { return greeting.now() >= until || greeting.session().is_ready(); }));
  EXPECT_LE(std::count(greeting.log().begin(), greeting.log().end(), '?'), 21);
}

TEST(GrblSession, RefusesATurningSpindle) {
  Bench bench;
  const std::string_view line = "M3S100\n";
  bench.firmware().receive({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, bench.now());
  bench.connect();
  EXPECT_FALSE(bench.finish());
  EXPECT_NE(bench.failure().find("spindle"), std::string::npos) << bench.failure();
  EXPECT_EQ(bench.sent_lines("G"), 0U);
}

TEST(GrblSession, TravelGoesWhereHomingSaysThatItGoes) {
  // A build that sets the origin where it homed: upwards of it on axes that home to their low end.
  const auto spoil_with = [](std::string_view letters) {
    return [letters](std::string& said) {
      const std::size_t at = said.find("[OPT:V,");
      if (at != std::string::npos) said.insert(at + 5, letters);
    };
  };
  for (const bool fits : {false, true}) {
    Bench bench;
    bench.firmware().settings().force(22, 1.0);
    bench.firmware().settings().force(20, 1.0);
    bench.firmware().settings().force(23, fits ? 3.0 : 1.0); // the area lies above 0 in x and y
    bench.spoil = spoil_with("Z");
    bench.connect();
    ASSERT_TRUE(bench.run([&] { return bench.session().is_ready(); }) == fits) << bench.failure();
    EXPECT_EQ(bench.failure().find("travel in Y") != std::string::npos, !fits) << bench.failure();
  }
}

TEST(GrblSession, HeldProbeCyclesAreDoneAgain) {
  Bench bench;
  bench.connect();
  ASSERT_TRUE(bench.until_sent("G38", 5));
  const auto press = [&](char key) {
    const auto byte = static_cast<std::uint8_t>(key);
    bench.firmware().receive({&byte, 1}, bench.now());
  };
  press('!');
  const Ns until = bench.now() + 20 * kS;
  ASSERT_TRUE(bench.run([&] { return bench.now() >= until; })) << bench.failure();
  EXPECT_EQ(bench.session().condition(), "the machine is in feed hold; press cycle start");
  // The pin closes while it stands: going on reports a contact where there is none.
  bench.firmware().set_pin_stuck(true);
  press('~');
  bench.firmware().set_pin_stuck(false);
  ASSERT_TRUE(bench.finish()) << bench.failure();
  bench.expect_whole_scan();
  EXPECT_EQ(bench.session().counts().disturbed, 1U);

  Bench door;
  door.connect();
  ASSERT_TRUE(door.until_sent("G38", 5));
  const std::uint8_t open = 0x84;
  door.firmware().receive({&open, 1}, door.now());
  door.firmware().run_until(door.now() + 2 * kS);
  const std::uint8_t start = '~';
  door.firmware().receive({&start, 1}, door.now() + 2 * kS);
  ASSERT_TRUE(door.finish()) << door.failure();
  door.expect_whole_scan();
  EXPECT_EQ(door.session().counts().disturbed, 1U);
}

TEST(GrblSession, LostRepliesAreFoundAndThePointIsRepeated) {
  for (const char* before : {"G53G0Z", "G53G0X", "G38"}) {
    Bench bench;
    bench.connect();
    ASSERT_TRUE(bench.until_sent(before, 3));
    bench.firmware().drop_replies(1);
    ASSERT_TRUE(bench.finish()) << before << bench.failure();
    bench.expect_whole_scan();
    EXPECT_EQ(bench.session().counts().resyncs, 1U);
  }
}

TEST(GrblSession, SurplusRepliesOfASecondHostAreNoSuccess) {
  for (const char* before : {"G53G0Z", "G53G0X", "G38"}) {
    Bench bench;
    bench.connect();
    ASSERT_TRUE(bench.until_sent(before, 3));
    bool done = false;
    bench.spoil = [&](std::string& said) {
      if (!std::exchange(done, true)) said.insert(0, "ok\r\n");
    };
    ASSERT_TRUE(bench.finish()) << before << bench.failure();
    bench.expect_whole_scan();
  }
}

TEST(GrblSession, ForeignProbeReportsAreNoSuccess) {
  Bench bench;
  bench.connect();
  ASSERT_TRUE(bench.until_sent("G38", 4));
  bool done = false;
  bench.spoil = [&](std::string& said) {
    if (!std::exchange(done, true)) said.insert(0, "[PRB:2.000,3.000,-1.000:1]\r\nok\r\n");
  };
  ASSERT_TRUE(bench.finish()) << bench.failure();
  bench.expect_whole_scan();
  EXPECT_GE(bench.session().counts().resyncs, 1U);
}

TEST(GrblSession, SilenceIsAnError) {
  Bench bench;
  bench.connect();
  ASSERT_TRUE(bench.until_sent("G38", 2));
  bench.spoil = [](std::string& said) { said.clear(); };
  EXPECT_FALSE(bench.finish());
  ASSERT_TRUE(bench.session().failure());
  EXPECT_EQ(bench.session().failure()->code, Errc::unavailable);

  Bench nobody;
  nobody.spoil = [](std::string& said) { said.clear(); };
  nobody.connect();
  EXPECT_FALSE(nobody.finish());
  EXPECT_NE(nobody.failure().find("does not answer"), std::string::npos);

  Bench wrong_baud;
  wrong_baud.spoil = [](std::string& said) {
    for (char& c : said) c = static_cast<char>(c == '\n' ? c : static_cast<char>(c | '\x80'));
  };
  wrong_baud.connect();
  EXPECT_FALSE(wrong_baud.finish());
  EXPECT_NE(wrong_baud.failure().find("baud rate"), std::string::npos) << wrong_baud.failure();
}

} // namespace
} // namespace scansion::grbl::test
