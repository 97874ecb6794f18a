// Sessions of the touch-probe machine that are stopped, left, cut off and gone on with.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/grbl/bench.hpp"

namespace scansion::grbl::test {
namespace {

TEST(GrblSession, StopAtAnyMomentHoldsAndGoesOn) {
  for (int at = 0; at < 160; at += 7) {
    Bench bench;
    bench.connect();
    for (int i = 0; i < at && !bench.session().failure(); ++i) bench.step();
    bench.session().hold(bench.now());
    bench.transmit();
    ASSERT_TRUE(bench.run([&] { return bench.session().is_at_rest(); }, 3 * kS)) << at << bench.failure();
    const auto place = bench.firmware().true_place(bench.now());
    const std::size_t lines = static_cast<std::size_t>(std::count(bench.log().begin(), bench.log().end(), '\n'));
    const Ns until = bench.now() + 30 * kS;
    ASSERT_TRUE(bench.run([&] { return bench.now() >= until; })) << at << bench.failure();
    EXPECT_EQ(bench.firmware().true_place(bench.now()), place) << at;
    EXPECT_EQ(static_cast<std::size_t>(std::count(bench.log().begin(), bench.log().end(), '\n')), lines) << at;
    EXPECT_EQ(bench.log().find('\x18'), std::string::npos) << "position is kept";
    bench.session().go_on();
    ASSERT_TRUE(bench.finish()) << at << bench.failure();
    bench.expect_whole_scan();
  }
}

TEST(GrblSession, LeavingHoldsFirstAndResetsThen) {
  Bench bench;
  bench.connect();
  ASSERT_TRUE(bench.until_sent("G38", 4));
  for (int i = 0; i < 3; ++i) bench.step();
  bench.session().leave(bench.now());
  bench.transmit();
  ASSERT_TRUE(bench.run([&] { return bench.session().is_at_rest(); }, kS));
  bench.transmit();
  const std::size_t hold = bench.log().find('!'), reset = bench.log().find('\x18');
  ASSERT_NE(hold, std::string::npos);
  ASSERT_NE(reset, std::string::npos);
  EXPECT_LT(hold, reset);
  EXPECT_TRUE(bench.session().was_reset());
}

TEST(GrblSession, LeavingWaitsForALongBrake) {
  BenchOptions options;
  options.area.x_from = options.area.x_to = 60.0;
  Bench bench(options);
  for (const int axis : {120, 121, 122}) bench.firmware().settings().force(axis, 5.0);
  bench.connect();
  ASSERT_TRUE(bench.until_sent("G53G0X"));
  // On its way to x 60 it has 15 mm/s after 3 s, and needs as long to stand again.
  const Ns begin = bench.now() + 3 * kS;
  ASSERT_TRUE(bench.run([&] { return bench.now() >= begin; }));
  bench.session().leave(bench.now());
  ASSERT_FALSE(bench.run([&] { return bench.session().is_at_rest(); }, kS));
  EXPECT_EQ(bench.log().find('\x18'), std::string::npos) << "a reset while it moves would lose the position";
  ASSERT_TRUE(bench.run([&] { return bench.session().is_at_rest(); }, 5 * kS));
  EXPECT_TRUE(bench.session().was_reset());
}

TEST(GrblSession, LeavingAnIdleOrFinishedMachineSendsNothing) {
  Bench bench;
  bench.connect();
  ASSERT_TRUE(bench.finish());
  const std::size_t before = bench.log().size();
  bench.session().leave(bench.now());
  EXPECT_TRUE(bench.session().is_at_rest());
  bench.transmit();
  EXPECT_EQ(bench.log().size(), before);
}

TEST(GrblSession, GoesOnAfterTheCableWasOut) {
  Bench bench;
  bench.connect();
  ASSERT_TRUE(bench.until_sent("G38", 8));
  const auto rows = static_cast<std::uint32_t>(bench.rows().size());
  ASSERT_EQ(rows, 1U);
  bench.leave_alone(30 * kS); // the machine ends its probe cycle, with the tip on the part
  bench.connect({.rows = rows, .has_begun = true});
  ASSERT_TRUE(bench.finish()) << bench.failure();
  bench.expect_whole_scan();
}

TEST(GrblSession, GoesOnAfterTheCableWasOutInItsFirstProbeCycle) {
  for (const bool restarts : {false, true}) {
    Bench bench;
    bench.connect();
    ASSERT_TRUE(bench.until_sent("G38"));
    EXPECT_TRUE(bench.session().has_probed());
    EXPECT_FALSE(bench.session().has_touched());
    bench.leave_alone(30 * kS); // the tip stands on the part now
    if (restarts) bench.firmware().power_on(bench.now());
    bench.connect({.has_probed = true});
    EXPECT_EQ(bench.finish(), !restarts) << bench.failure();
    // Started anew, its coordinates are 0 where the tip stands: a lift to the top might go down.
    EXPECT_EQ(bench.failure().find("position is lost") != std::string::npos, restarts) << bench.failure();
    if (!restarts) bench.expect_whole_scan();
  }
}

TEST(GrblSession, GoesOnOnlyWhereItsLastProbeCycleWas) {
  const auto again = [](std::string_view line, bool trusts = false) {
    Bench bench;
    bench.connect();
    static_cast<void>(bench.until_sent("G38", 8));
    bench.leave_alone(30 * kS);
    bench.firmware().receive({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, bench.now());
    bench.leave_alone(60 * kS);
    bench.connect({.rows = 1, .has_begun = true}, trusts);
    return bench.finish() ? std::string("whole") : bench.failure();
  };
  // Another probe cycle elsewhere, as after somebody moved the part and set a new origin.
  const std::string_view elsewhere = "G53G0Z0\nG53G0X30Y20\nG38.3Z-12F240\nG53G0Z0\n";
  EXPECT_EQ(again("G53G0Z0\nG53G0X30Y20\n"), "whole");
  EXPECT_NE(again(elsewhere).find("last probe cycle"), std::string::npos) << again(elsewhere);
  EXPECT_EQ(again(elsewhere, true), "whole");
}

TEST(GrblSession, GoesOnARowBehindWhatAKilledDaemonHadWritten) {
  for (const bool is_recorded : {false, true}) {
    Bench bench;
    bench.connect();
    ASSERT_TRUE(bench.until_sent("G38", 8));
    ASSERT_EQ(bench.rows().size(), 1U); // lost with the group that was open
    bench.leave_alone(30 * kS);
    bench.connect({.rows = 0, .has_begun = true, .is_recorded = is_recorded});
    EXPECT_EQ(bench.finish(), is_recorded) << bench.failure();
    EXPECT_EQ(bench.failure().find("last probe cycle") == std::string::npos, is_recorded) << bench.failure();
  }
}

TEST(GrblSession, PredecessorsHalfLineAndMotionDoNoHarm) {
  Bench bench;
  const std::string_view left = "G21G91\nG1F200X1\nG1X1\nG53G0X";
  bench.firmware().receive({reinterpret_cast<const std::uint8_t*>(left.data()), left.size()}, bench.now());
  bench.connect();
  ASSERT_TRUE(bench.finish()) << bench.failure();
  bench.expect_whole_scan();
}

TEST(GrblSession, NoiseNeverMakesAWrongPoint) {
  std::uint32_t wrong_runs = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    Bench bench;
    bench.connect();
    std::minstd_rand random(seed);
    bench.spoil = [&](std::string& said) {
      for (char& c : said) {
        if (random() % 1000 == 0) c = static_cast<char>(random() % 256);
      }
    };
    if (!bench.finish()) ++wrong_runs;
    // A digit that became another digit in z cannot be told; anything else must not get through.
    for (const Row& row : bench.rows()) {
      for (std::uint32_t c = 0; c < bench.raster().columns(); ++c) {
        if (!row.points[c]) continue;
        EXPECT_NEAR(static_cast<double>((*row.points[c])[0]) / 1e4, static_cast<double>(bench.raster().x(c)) / 1e3, 0.01);
      }
    }
  }
  EXPECT_LE(wrong_runs, 6U); // a spoiled ALARM or a mangled state word ends a raster
}

} // namespace
} // namespace scansion::grbl::test
