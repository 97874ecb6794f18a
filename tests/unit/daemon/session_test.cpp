// A whole device session, threads included, on scripted devices and a disk that fails on demand.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/supervisor/supervisor.hpp"
#include "tests/unit/daemon/fakes.hpp"

#include <future>

namespace scansion::test {
namespace {

class Session : public testing::Test {
protected:
  void SetUp() override {
    auto opened = JournalDirectory::open(temporary_.path());
    ASSERT_TRUE(opened);
    directory_.emplace(std::move(opened).assume_value());
    ports_.emplace(fake_ports(*directory_, disk_));
    settings_.policy.jitter = 0.0;
  }

  void start(ScriptedDriver::Script script, Clock& clock) {
    static const DriverInfo info{"scripted", "for tests", {}, nullptr};
    DeviceConfig config;
    config.name = "d";
    config.driver = &info;
    session_ =
        std::make_unique<DeviceSession>(config, std::make_unique<ScriptedDriver>(std::move(script)), settings_, *ports_, clock);
  }

  [[nodiscard]] bool is_in(std::string_view state) {
    return eventually([&] { return session_->status().state == state; });
  }

  TemporaryDirectory temporary_;
  std::optional<JournalDirectory> directory_;
  FakeDisk disk_;
  std::optional<JournalPorts> ports_;
  SessionSettings settings_;
  ManualClock manual_;
  SystemClock system_;
  std::unique_ptr<DeviceSession> session_;
};

/// Delivers `lines` lines, then ends.
ScriptedDriver::Script recorded(std::uint32_t lines) {
  ScriptedDriver::Script script;
  script.start = [] {
    DeviceFacts facts = test_facts();
    facts.live = false;
    return Result<DeviceFacts>(facts);
  };
  script.next = [lines, done = 0U](LineBuffer& line, Gap&) mutable -> Result<Delivery> {
    if (done++ == lines) return Delivery::end;
    fill_line(line, 10);
    return Delivery::line;
  };
  return script;
}

TEST_F(Session, RecordedSourceIsWrittenWholeAndFinished) {
  start(recorded(1000), manual_);
  ASSERT_TRUE(is_in("finished"));
  ASSERT_TRUE(eventually([&] { return session_->status().lines_written == 1000; }));
  const DeviceStatus status = session_->status();
  EXPECT_EQ(status.lines, 1000U);
  EXPECT_EQ(status.points, 10000U);
  EXPECT_EQ(status.groups_written, 16U);
  EXPECT_EQ(status.error, "");
  ASSERT_TRUE(eventually([&] { return disk_.seen()[0].finished; }));
  const auto files = disk_.seen();
  ASSERT_EQ(files.size(), 1U);
  for (std::size_t i = 0; i < 15; ++i) EXPECT_EQ(files[0].lines[i].second, kGroupLines);
  EXPECT_EQ(files[0].lines[15].second, 1000U - 15 * kGroupLines);
}

TEST_F(Session, RecordedLossIsNoReasonToTryForEver) {
  auto script = recorded(10);
  int runs = 0;
  script.open = [&]() -> Result<void> {
    ++runs;
    return success();
  };
  script.start = [&]() -> Result<DeviceFacts> {
    if (runs > 1) return fail(Errc::unavailable, "ended before the device had started");
    return test_facts();
  };
  script.next = [next = script.next](LineBuffer& line, Gap& gap) -> Result<Delivery> {
    SCANSION_TRY(delivery, next(line, gap));
    if (delivery == Delivery::end) return fail(Errc::unavailable, "then: lost");
    return delivery;
  };
  script.is_over = [&] { return runs > 1; };
  start(std::move(script), system_);
  ASSERT_TRUE(is_in("finished"));
  EXPECT_EQ(runs, 2);
  EXPECT_EQ(session_->status().lines, 10U);
  EXPECT_EQ(session_->status().error, "then: lost");
}

TEST_F(Session, AbsentDeviceIsTriedAgainWithoutARecording) {
  std::atomic<int> attempts{0};
  std::atomic<bool> there{false};
  auto script = recorded(10);
  script.open = [&]() -> Result<void> {
    ++attempts;
    if (!there) return fail(Errc::not_found, "port: no such device");
    return success();
  };
  start(std::move(script), manual_);
  ASSERT_TRUE(is_in("backing off"));
  EXPECT_EQ(session_->status().error, "port: no such device");
  EXPECT_EQ(attempts, 1) << "no attempt before the back-off is over";
  manual_.advance(300 * kMillisecond);
  ASSERT_TRUE(eventually([&] { return attempts == 2; }));
  EXPECT_TRUE(disk_.seen().empty());
  there = true;
  ASSERT_TRUE(is_in("backing off"));
  manual_.advance(11 * kSecond);
  ASSERT_TRUE(is_in("finished"));
  ASSERT_TRUE(eventually([&] { return session_->status().lines_written == 10; }));
  EXPECT_EQ(session_->status().error, "");
}

TEST_F(Session, FailureInTheMiddleKeepsWhatCameAndBacksOff) {
  auto script = recorded(0);
  std::atomic<int> runs{0};
  script.open = [&]() -> Result<void> {
    ++runs;
    return success();
  };
  script.next = [done = 0](LineBuffer& line, Gap&) mutable -> Result<Delivery> {
    if (done++ == 70) return fail(Errc::undecodable, "f.xyz:71: two fields; give three");
    fill_line(line, 5);
    return Delivery::line;
  };
  start(std::move(script), manual_);
  ASSERT_TRUE(is_in("backing off"));
  EXPECT_EQ(session_->status().error, "f.xyz:71: two fields; give three");
  ASSERT_TRUE(eventually([&] { return session_->status().lines_written == 70; }));
  ASSERT_TRUE(eventually([&] { return disk_.seen()[0].finished; }));
  EXPECT_EQ(runs, 1);
}

TEST_F(Session, ConfigurationErrorIsGivenUp) {
  auto script = recorded(0);
  script.start = []() -> Result<DeviceFacts> { return fail(Errc::config, "wrong model"); };
  start(std::move(script), manual_);
  ASSERT_TRUE(is_in("closed"));
  ASSERT_TRUE(eventually([&] { return session_->status().error == "wrong model"; }));
}

TEST_F(Session, LiveGroupClosesByTime) {
  std::promise<void> go;
  auto may_go_on = go.get_future().share();
  ScriptedDriver::Script script;
  script.next = [may_go_on, done = 0](LineBuffer& line, Gap&) mutable -> Result<Delivery> {
    if (done == 5) {
      may_go_on.wait();
      return Delivery::end;
    }
    ++done;
    fill_line(line, 5);
    return Delivery::line;
  };
  start(std::move(script), manual_);
  ASSERT_TRUE(eventually([&] { return session_->status().lines == 5 && session_->status().queue_depth == 0; }));
  EXPECT_EQ(session_->status().lines_written, 0U);
  manual_.advance(settings_.group_age + kMillisecond);
  EXPECT_TRUE(eventually([&] { return session_->status().lines_written == 5; }));
  go.set_value();
  EXPECT_TRUE(is_in("finished"));
}

TEST_F(Session, GapClosesTheGroupAndShiftsIndexes) {
  ScriptedDriver::Script script;
  script.next = [done = 0](LineBuffer& line, Gap& gap) mutable -> Result<Delivery> {
    ++done;
    if (done == 4) {
      gap.count = 10;
      gap.reason = "overrun";
      return Delivery::gap;
    }
    if (done == 8) return Delivery::end;
    fill_line(line, 5);
    return Delivery::line;
  };
  start(std::move(script), manual_);
  ASSERT_TRUE(eventually([&] { return session_->status().lines_written == 6; }));
  const auto files = disk_.seen();
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0].lines, (std::vector<std::pair<std::uint64_t, std::uint32_t>>{{0, 3}, {13, 3}}));
  EXPECT_EQ(files[0].gaps, (std::vector<Gap>{{3, 10, "overrun"}}));
  EXPECT_EQ(session_->status().gaps, 1U);
}

TEST_F(Session, PaceFollowsTheClock) {
  auto script = recorded(100);
  script.start = [] {
    DeviceFacts facts = test_facts();
    facts.pace = 10.0;
    return Result<DeviceFacts>(facts);
  };
  start(std::move(script), manual_);
  ASSERT_TRUE(eventually([&] { return session_->status().lines == 1; }));
  for (std::uint64_t i = 2; i <= 20; ++i) {
    manual_.advance(100 * kMillisecond);
    ASSERT_TRUE(eventually([&] { return session_->status().lines == i; })) << i;
  }
}

TEST_F(Session, SilentDeviceIsStale) {
  start({}, manual_);
  ASSERT_TRUE(is_in("streaming"));
  manual_.advance(3 * kSecond);
  EXPECT_TRUE(is_in("stale"));
}

/// The disk is full for a while; the recorded source waits at the bound and nothing is lost.
TEST_F(Session, FullDiskHoldsUpARecordedSourceWithoutLoss) {
  settings_.recorder.pending_bytes = 20'000;
  disk_.full = true;
  start(recorded(5000), manual_);
  ASSERT_TRUE(eventually([&] {
    const DeviceStatus status = session_->status();
    return status.queue_depth == LineQueue::kLines && status.blocked == "no space left" && status.pending_groups > 1;
  }));
  EXPECT_LT(session_->status().lines, 1000U);
  EXPECT_EQ(session_->status().state, "streaming");
  disk_.full = false;
  ASSERT_TRUE(eventually([&] {
    manual_.advance(kSecond);
    return session_->status().lines_written == 5000;
  }));
  EXPECT_EQ(disk_.lines_seen(), 5000U);
  EXPECT_EQ(session_->status().lost_lines, 0U);
  EXPECT_EQ(session_->status().blocked, "");
}

/// The source is at its end before the disk takes anything: its run ends only when all is written.
TEST_F(Session, FullDiskAtTheEndOfASourceLosesNothing) {
  disk_.full = true;
  start(recorded(300), manual_);
  ASSERT_TRUE(is_in("finished"));
  ASSERT_TRUE(eventually([&] { return session_->status().pending_groups == 5; }));
  manual_.advance(3 * kSecond);
  EXPECT_EQ(session_->status().lost_lines, 0U);
  disk_.full = false;
  ASSERT_TRUE(eventually([&] {
    manual_.advance(kSecond);
    return session_->status().lines_written == 300;
  }));
  ASSERT_TRUE(eventually([&] { return disk_.seen()[0].finished; }));
  EXPECT_EQ(session_->status().lost_lines, 0U);
}

TEST_F(Session, StopOnAFullDiskCountsWhatIsLost) {
  settings_.recorder.pending_bytes = 20'000;
  disk_.full = true;
  start(recorded(5000), system_);
  ASSERT_TRUE(eventually([&] { return session_->status().queue_depth == LineQueue::kLines; }));
  session_->request_stop();
  ASSERT_TRUE(session_->wait_device(system_.steady_ns() + 10 * kSecond));
  ASSERT_TRUE(session_->wait_recording(system_.steady_ns() + 10 * kSecond));
  EXPECT_EQ(session_->status().lost_lines, session_->status().lines);
}

TEST_F(Session, StopWritesWhatCame) {
  ScriptedDriver::Script script;
  script.next = [done = 0](LineBuffer& line, Gap&) mutable -> Result<Delivery> {
    if (done == 30) return Delivery::nothing;
    ++done;
    fill_line(line, 5);
    return Delivery::line;
  };
  start(std::move(script), system_);
  ASSERT_TRUE(eventually([&] { return session_->status().lines == 30; }));
  session_->request_stop();
  ASSERT_TRUE(session_->wait_device(system_.steady_ns() + 10 * kSecond));
  ASSERT_TRUE(session_->wait_recording(system_.steady_ns() + 10 * kSecond));
  EXPECT_EQ(disk_.lines_seen(), 30U);
  EXPECT_TRUE(disk_.seen()[0].finished);
  EXPECT_EQ(session_->status().state, "closed");
  EXPECT_EQ(session_->progress_at(), kNever);
}

/// A device that never comes back from its call: it is left behind, its lines are kept, and the recording is whole.
TEST_F(Session, StuckDeviceIsLeftBehind) {
  auto release = std::make_shared<std::promise<void>>();
  auto released = release->get_future().share();
  auto gone = std::make_shared<std::promise<void>>();
  ScriptedDriver::Script script;
  script.next = [released, gone, done = 0](LineBuffer& line, Gap&) mutable -> Result<Delivery> {
    if (done == 30) {
      released.wait();
      gone->set_value();
      return Delivery::end;
    }
    ++done;
    fill_line(line, 5);
    return Delivery::line;
  };
  start(std::move(script), system_);
  ASSERT_TRUE(eventually([&] { return session_->status().lines == 30; }));
  session_->request_stop();
  EXPECT_FALSE(session_->wait_device(system_.steady_ns() + 50 * kMillisecond));
  ASSERT_TRUE(session_->wait_recording(system_.steady_ns() + 10 * kSecond));
  EXPECT_EQ(disk_.lines_seen(), 30U);
  EXPECT_TRUE(disk_.seen()[0].finished);
  session_.reset();
  release->set_value();
  gone->get_future().wait(); // the thread must not outlive the clock of this test by more than its last steps
  ASSERT_TRUE(eventually([&] { return gone.use_count() == 1; }));
}

TEST_F(Session, ProgressIsTheWorkersLastStep) {
  start({}, manual_);
  ASSERT_TRUE(is_in("streaming"));
  manual_.advance(kSecond);
  EXPECT_TRUE(eventually([&] { return session_->progress_at() == manual_.steady_ns(); }));
}

} // namespace
} // namespace scansion::test
