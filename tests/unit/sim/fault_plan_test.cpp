// Faults of a simulated connection: when they begin and end, what they do to bytes, and that a seed repeats them.
// SPDX-License-Identifier: Apache-2.0
#include "sim/port/fault_plan.hpp"

#include <gtest/gtest.h>

namespace scansion {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

FaultPlan plan_of(std::initializer_list<std::string_view> texts, std::uint64_t seed = 1) {
  std::vector<FaultSpec> specs;
  for (const auto text : texts) specs.push_back(parse_fault(text).assume_value());
  return {std::move(specs), seed};
}

/// "0.5+unplug 1.0-unplug": what changes until `end`, and when.
std::string changes(FaultPlan& plan, std::int64_t end) {
  std::string out;
  FaultPlan::Change change;
  while (plan.next_at() <= end) {
    const std::int64_t now = plan.next_at();
    if (!plan.next_change(now, change)) break;
    out += std::to_string(now / (kSecond / 10)) + (change.starts ? '+' : '-') + change.fault->kind + ' ';
  }
  return out;
}

TEST(FaultPlan, BeginsEndsAndComesAgain) {
  auto plan = plan_of({"unplug:at=1,for=0.5,every=2"});
  EXPECT_EQ(changes(plan, 4 * kSecond), "10+unplug 15-unplug 30+unplug 35-unplug ");
  auto moment = plan_of({"half:at=0.2", "cut:at=0.1,every=0.3"});
  EXPECT_EQ(changes(moment, kSecond / 2), "1+cut 1-cut 2+half 2-half 4+cut 4-cut ");
  auto always = plan_of({"mute"});
  EXPECT_FALSE(always.is_muted());
  EXPECT_EQ(changes(always, 100 * kSecond), "0+mute ");
  EXPECT_TRUE(always.is_muted());
}

TEST(FaultPlan, ASeedRepeatsIt) {
  const std::vector<std::uint8_t> message(5000, 0x55);
  std::vector<std::vector<std::uint8_t>> results;
  for (const std::uint64_t seed : {1U, 1U, 2U}) {
    auto plan = plan_of({"flip:rate=0.01", "drop:rate=0.01", "insert:rate=0.01"}, seed);
    static_cast<void>(changes(plan, 0));
    auto bytes = message;
    plan.disturb(bytes);
    results.push_back(bytes);
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_NE(results[0], results[2]);
  EXPECT_NE(results[0], message);
}

TEST(FaultPlan, WholeMessagesAreHalvedLostAndDoubled) {
  auto plan = plan_of({"duplicate:rate=1"});
  static_cast<void>(changes(plan, 0));
  std::vector<std::uint8_t> message{1, 2, 3, 4};
  plan.halve_next();
  plan.disturb(message);
  EXPECT_EQ(message, (std::vector<std::uint8_t>{1, 2, 1, 2}));
  auto lossy = plan_of({"lose:rate=1"});
  static_cast<void>(changes(lossy, 0));
  lossy.disturb(message);
  EXPECT_TRUE(message.empty());
}

TEST(FaultPlan, MistakesAreNamed) {
  for (const char* text : {"", ":at=1", "mute:at", "mute:at=x", "mute:at=-1", "flip:rate=nan"}) {
    auto spec = parse_fault(text);
    ASSERT_FALSE(spec) << text;
    EXPECT_EQ(spec.assume_error().code, Errc::usage);
  }
}

} // namespace
} // namespace scansion
