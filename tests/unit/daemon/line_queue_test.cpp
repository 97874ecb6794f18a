// The queue between device and pipeline: order, bounds, waiting, closing.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/supervisor/line_queue.hpp"

#include <gtest/gtest.h>
#include <thread>

namespace scansion {
namespace {

QueueItem line_of(std::size_t points, std::int64_t mark) {
  QueueItem item;
  item.kind = QueueItem::Kind::line;
  for (auto& axis : item.line.xyz) axis.assign(points, 1);
  item.line.stamps.encoder = mark;
  return item;
}

TEST(LineQueue, KeepsOrderAcrossThreads) {
  SystemClock clock;
  LineQueue queue(clock);
  constexpr std::int64_t kCount = 20000;
  std::thread producer([&] {
    QueueItem item;
    for (std::int64_t i = 0; i < kCount; ++i) {
      item.line.stamps.encoder = i;
      for (auto& axis : item.line.xyz) axis.assign(static_cast<std::size_t>(i % 50), 0);
      ASSERT_TRUE(queue.push(item));
    }
    queue.close();
  });
  QueueItem item;
  std::int64_t next = 0;
  while (!queue.drained()) {
    if (!queue.pop(item, kNever)) continue;
    ASSERT_EQ(item.line.stamps.encoder, next);
    ASSERT_EQ(item.line.points(), static_cast<std::size_t>(next % 50));
    ++next;
  }
  producer.join();
  EXPECT_EQ(next, kCount);
}

/// The producer waits at the bound; nothing is dropped.
TEST(LineQueue, IsBoundedByLines) {
  ManualClock clock;
  LineQueue queue(clock);
  for (std::size_t i = 0; i < LineQueue::kLines; ++i) {
    QueueItem item = line_of(1, static_cast<std::int64_t>(i));
    ASSERT_TRUE(queue.push(item));
  }
  std::atomic<bool> pushed{false};
  std::thread producer([&] {
    QueueItem item = line_of(1, 4711);
    EXPECT_TRUE(queue.push(item));
    pushed = true;
  });
  EXPECT_FALSE(pushed);
  EXPECT_EQ(queue.depth(), LineQueue::kLines);
  QueueItem item;
  ASSERT_TRUE(queue.pop(item, kNever));
  producer.join();
  EXPECT_TRUE(pushed);
  EXPECT_EQ(queue.depth(), LineQueue::kLines);
}

TEST(LineQueue, IsBoundedByPointsButTakesOneLineOfAnySize) {
  ManualClock clock;
  LineQueue queue(clock);
  QueueItem huge = line_of(LineQueue::kPoints * 2, 0);
  ASSERT_TRUE(queue.push(huge));
  std::thread producer([&] {
    QueueItem item = line_of(1, 1);
    EXPECT_TRUE(queue.push(item));
  });
  QueueItem item;
  ASSERT_TRUE(queue.pop(item, kNever));
  EXPECT_EQ(item.line.points(), LineQueue::kPoints * 2);
  producer.join();
  ASSERT_TRUE(queue.pop(item, kNever));
  EXPECT_EQ(item.line.stamps.encoder, 1);
  EXPECT_LE(item.line.xyz[0].capacity(), LineQueue::kKeptPoints) << "the huge buffer must not travel on";
}

TEST(LineQueue, CloseWakesTheProducerAndKeepsWhatIsThere) {
  ManualClock clock;
  LineQueue queue(clock);
  QueueItem item = line_of(LineQueue::kPoints, 1);
  ASSERT_TRUE(queue.push(item));
  std::thread producer([&] {
    QueueItem refused = line_of(10, 2);
    EXPECT_FALSE(queue.push(refused));
    EXPECT_EQ(refused.line.points(), 10U) << "a refused item stays with its owner";
  });
  queue.close();
  producer.join();
  EXPECT_FALSE(queue.drained());
  EXPECT_TRUE(queue.pop(item, kNever));
  EXPECT_TRUE(queue.drained());
  EXPECT_FALSE(queue.pop(item, kNever));
}

TEST(LineQueue, PopEndsAtItsDeadline) {
  ManualClock clock;
  LineQueue queue(clock);
  QueueItem item;
  EXPECT_FALSE(queue.pop(item, clock.steady_ns()));
  const SteadyNs deadline = clock.steady_ns() + kSecond / 2;
  std::thread later([&] { clock.advance(kSecond); });
  EXPECT_FALSE(queue.pop(item, deadline));
  later.join();
}

} // namespace
} // namespace scansion
