// The state machine of a device and its back-off, without a thread or a clock.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/supervisor/session_state.hpp"

#include <gtest/gtest.h>
#include <set>

namespace scansion {
namespace {

SessionMachine exact_machine() {
  SessionPolicy policy;
  policy.jitter = 0.0;
  return SessionMachine(policy, 1);
}

void stream(SessionMachine& machine, SteadyNs now) {
  machine.opening();
  machine.starting();
  machine.streaming(now);
}

TEST(SessionState, GoodCaseRunsToItsEnd) {
  SessionMachine machine = exact_machine();
  EXPECT_EQ(machine.state(), SessionState::closed);
  machine.opening();
  EXPECT_EQ(machine.state(), SessionState::opening);
  machine.starting();
  EXPECT_EQ(machine.state(), SessionState::starting);
  machine.streaming(0);
  machine.delivered(1);
  EXPECT_EQ(machine.state(), SessionState::streaming);
  machine.finished();
  EXPECT_EQ(machine.state(), SessionState::finished);
}

TEST(SessionState, AbsentDeviceBacksOffDoublingToABound) {
  SessionMachine machine = exact_machine();
  const SteadyNs waits_ms[] = {250, 500, 1000, 1000, 1000};
  SteadyNs now = 0;
  for (const SteadyNs wait : waits_ms) {
    machine.opening();
    machine.failed(Errc::not_found, now);
    EXPECT_EQ(machine.state(), SessionState::backing_off);
    EXPECT_EQ(machine.retry_at() - now, wait * kMillisecond);
    now = machine.retry_at();
  }
}

TEST(SessionState, JitterStaysInItsBandAndVaries) {
  std::set<SteadyNs> waits;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SessionMachine machine(SessionPolicy{}, seed * 7919);
    machine.opening();
    machine.failed(Errc::io, 0);
    EXPECT_GE(machine.retry_at(), 187 * kMillisecond);
    EXPECT_LE(machine.retry_at(), 313 * kMillisecond);
    waits.insert(machine.retry_at());
  }
  EXPECT_GT(waits.size(), 100U);
}

TEST(SessionState, FailureWhileStreamingIsLostUntilTheRunIsEnded) {
  SessionMachine machine = exact_machine();
  stream(machine, 0);
  machine.failed(Errc::undecodable, 10);
  EXPECT_EQ(machine.state(), SessionState::lost);
  machine.settle(20);
  EXPECT_EQ(machine.state(), SessionState::backing_off);
  EXPECT_EQ(machine.retry_at(), 20 + 250 * kMillisecond);
}

TEST(SessionState, ConfigurationErrorIsGivenUp) {
  SessionMachine machine = exact_machine();
  machine.opening();
  machine.failed(Errc::config, 0);
  EXPECT_EQ(machine.state(), SessionState::closed);
}

TEST(SessionState, ShortStreamingKeepsTheBackOffGrowing) {
  SessionMachine machine = exact_machine();
  SteadyNs last = 0;
  for (int i = 0; i < 3; ++i) {
    stream(machine, 0);
    machine.delivered(kMillisecond);
    machine.failed(Errc::io, 2 * kMillisecond);
    machine.settle(0);
    EXPECT_GT(machine.retry_at(), last);
    last = machine.retry_at();
  }
}

TEST(SessionState, StableStreamingForgetsEarlierFailures) {
  SessionMachine machine = exact_machine();
  for (int i = 0; i < 5; ++i) {
    machine.opening();
    machine.failed(Errc::not_found, 0);
  }
  stream(machine, 0);
  machine.delivered(6 * kSecond);
  machine.failed(Errc::io, 6 * kSecond);
  machine.settle(6 * kSecond);
  EXPECT_EQ(machine.retry_at(), 6 * kSecond + 250 * kMillisecond);
}

TEST(SessionState, SilenceIsStaleAndALineEndsIt) {
  SessionMachine machine = exact_machine();
  stream(machine, 0);
  machine.silent(kSecond);
  EXPECT_EQ(machine.state(), SessionState::streaming);
  machine.silent(2 * kSecond);
  EXPECT_EQ(machine.state(), SessionState::stale);
  machine.delivered(3 * kSecond);
  EXPECT_EQ(machine.state(), SessionState::streaming);
}

TEST(SessionState, EveryStateHasItsName) {
  std::set<std::string_view> names;
  for (const auto state : {SessionState::closed, SessionState::opening, SessionState::starting, SessionState::streaming,
                           SessionState::stale, SessionState::lost, SessionState::backing_off, SessionState::finished}) {
    names.insert(name(state));
  }
  EXPECT_EQ(names.size(), 8U);
}

} // namespace
} // namespace scansion
