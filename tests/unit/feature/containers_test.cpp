// What tracks and curves are kept in: values that grow at both ends, tracks by the columns they end in or have passed over,
// places. SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/crosswise/column_ends.hpp"
#include "pipeline/feature/crosswise/column_gaps.hpp"
#include "pipeline/feature/line/near_places.hpp"
#include "pipeline/feature/link/double_ended.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include <deque>
#include <map>
#include <random>
#include <set>
#include <vector>

namespace scansion {
namespace {

struct Value {
  int number = 0;
  double more = 0.5;
};

void expect_same(const DoubleEnded<Value>& got, const std::deque<int>& wanted) {
  ASSERT_EQ(got.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) ASSERT_EQ(got[i].number, wanted[i]) << i;
  if (wanted.empty()) return;
  EXPECT_EQ(got.front().number, wanted.front());
  EXPECT_EQ(got.back().number, wanted.back());
}

TEST(DoubleEnded, HoldsWhatADequeHolds) {
  std::mt19937 random(7);
  DoubleEnded<Value> values;
  std::deque<int> wanted;
  for (int i = 0; i < 20'000; ++i) {
    const auto choice = random() % 100;
    if (choice < 40) {
      values.push_back({i});
      wanted.push_back(i);
    } else if (choice < 70) {
      values.push_front({i});
      wanted.push_front(i);
    } else if (choice < 80) {
      const std::size_t at = random() % (wanted.size() + 1);
      values.insert(values.begin() + at, {i});
      wanted.insert(wanted.begin() + static_cast<std::ptrdiff_t>(at), i);
    } else if (choice < 98) {
      if (wanted.empty()) continue;
      values.pop_back();
      wanted.pop_back();
    } else if (choice == 98) {
      const std::size_t count = wanted.size() / 2;
      values.pop_front(count);
      wanted.erase(wanted.begin(), wanted.begin() + static_cast<std::ptrdiff_t>(count));
    } else if (random() % 8 == 0) {
      values.clear();
      wanted.clear();
    }
    expect_same(values, wanted);
  }
}

TEST(DoubleEnded, TakesTheValuesOfAnother) {
  for (int count = 0; count < 30; ++count) {
    for (int more = 0; more < 30; ++more) {
      DoubleEnded<Value> values, others;
      std::deque<int> wanted;
      for (int i = 0; i < count; ++i) values.push_back({i});
      for (int i = 0; i < more; ++i) others.push_back({100 + i});
      for (int i = 0; i < count; ++i) wanted.push_back(i);
      for (int i = 0; i < more; ++i) wanted.push_back(100 + i);
      values.append(others);
      expect_same(values, wanted);
      EXPECT_TRUE(others.empty());
      others.push_back({1});
      EXPECT_EQ(others.front().number, 1);
    }
  }
}

TEST(DoubleEnded, MovesAndLeavesNothingBehind) {
  DoubleEnded<Value> from;
  for (int i = 0; i < 10; ++i) from.push_front({i});
  DoubleEnded<Value> to(std::move(from));
  expect_same(to, {9, 8, 7, 6, 5, 4, 3, 2, 1, 0});
  from = std::move(to);
  EXPECT_TRUE(to.empty()); // NOLINT(bugprone-use-after-move,clang-analyzer-cplusplus.Move): that is what is tested
  expect_same(from, {9, 8, 7, 6, 5, 4, 3, 2, 1, 0});
}

TEST(ColumnEnds, FindsEachTrackInItsLastColumnOnly) {
  std::mt19937 random(3);
  ColumnEnds ends;
  std::map<std::uint32_t, std::int64_t> wanted;
  for (int round = 0; round < 5'000; ++round) {
    const auto track = static_cast<std::uint32_t>(random() % 50);
    // Some columns stand so far apart that they share a list.
    const std::int64_t column = static_cast<std::int64_t>(random() % 8) - 4 + static_cast<std::int64_t>(random() % 3) * 4096;
    if (random() % 3 == 0) {
      ends.take(track);
      wanted.erase(track);
    } else {
      ends.put(track, column);
      wanted[track] = column;
    }
    std::set<std::uint32_t> here, found;
    for (const auto& [t, at] : wanted)
      if (at == column) here.insert(t);
    ends.visit(column, [&](std::uint32_t t) { EXPECT_TRUE(found.insert(t).second); });
    ASSERT_EQ(found, here);
  }
}

// A track that passed over nothing so far takes over more columns than any before it: nothing is read where it was.
TEST(ColumnGaps, GoToTracksNotSeenBefore) {
  ColumnGaps gaps;
  for (std::int64_t column = 0; column < 16; ++column) gaps.put(0, column);
  gaps.hand_over(0, 1000);
  for (std::int64_t column = 0; column < 16; ++column) {
    std::vector<std::uint32_t> seen;
    gaps.visit(column, [&](std::uint32_t t) { seen.push_back(t); });
    EXPECT_EQ(seen, std::vector<std::uint32_t>{1000}) << column;
  }
}

TEST(ColumnGaps, HoldsWhatASetHolds) {
  std::mt19937 random(11);
  constexpr std::uint32_t kTracks = 6;
  ColumnGaps gaps;
  std::vector<std::deque<std::int64_t>> wanted(kTracks);
  for (int i = 0; i < 20'000; ++i) {
    const auto track = static_cast<std::uint32_t>(random() % kTracks);
    // Lists are shared every 1024 columns.
    const std::int64_t column = 1024 * static_cast<std::int64_t>(random() % 3) - 1024 + static_cast<std::int64_t>(random() % 7);
    std::deque<std::int64_t>& own = wanted[track];
    const auto at = std::find(own.begin(), own.end(), column);
    const auto put = [&](std::deque<std::int64_t>& columns, std::int64_t c) {
      if (columns.size() == 16) columns.pop_front();
      columns.push_back(c);
    };
    const auto choice = random() % 20;
    if (choice < 12 && at == own.end()) {
      gaps.put(track, column);
      put(own, column);
    } else if (choice < 18 && at != own.end()) {
      gaps.take(track, column);
      own.erase(at);
    } else if (choice == 18) {
      gaps.take_all(track);
      own.clear();
    } else if (choice == 19) {
      // Two tracks never pass over one column and become one: their columns stand apart.
      const std::uint32_t other = (track + 1) % kTracks;
      const bool apart = std::none_of(own.begin(), own.end(), [&](std::int64_t c) {
        return std::find(wanted[other].begin(), wanted[other].end(), c) != wanted[other].end();
      });
      if (!apart) continue;
      gaps.hand_over(track, other);
      for (const std::int64_t c : own) put(wanted[other], c);
      own.clear();
    }
    std::multiset<std::uint32_t> seen, there;
    gaps.visit(column, [&](std::uint32_t t) { seen.insert(t); });
    for (std::uint32_t t = 0; t < kTracks; ++t)
      if (std::find(wanted[t].begin(), wanted[t].end(), column) != wanted[t].end()) there.insert(t);
    ASSERT_EQ(seen, there) << i;
  }
}

TEST(NearPlaces, MissNoneWithinReachAndNoneOfTheOtherPolarity) {
  struct At {
    double s, c;
    bool convex;
  };
  std::mt19937 random(83);
  NearPlaces places;
  for (const double reach : {0.7, 3.0, 50.0}) {
    std::uniform_real_distribution<double> somewhere(-20.0, 20.0);
    std::vector<At> there;
    places.restart(reach);
    for (std::uint32_t i = 0; i < 400; ++i) {
      // Some exactly a reach apart, and on the borders of strips.
      const double s = i % 4 == 0 ? reach * static_cast<double>(i % 7) : somewhere(random);
      there.push_back({s, i % 8 == 0 ? reach * static_cast<double>(i % 5) : somewhere(random), i % 3 == 0});
      places.add(there.back().s, there.back().c, there.back().convex, i);
    }
    places.close();
    const auto is_near = [&](const At& a, const At& b) { return std::hypot(a.s - b.s, a.c - b.c) <= reach; };
    for (const At& at : there) {
      std::multiset<std::uint32_t> seen, wanted;
      EXPECT_FALSE(places.any(at.s, at.c, at.convex, [&](std::uint32_t i) {
        EXPECT_EQ(there[i].convex, at.convex);
        if (is_near(at, there[i])) seen.insert(i);
        return false;
      }));
      for (std::uint32_t i = 0; i < there.size(); ++i)
        if (there[i].convex == at.convex && is_near(at, there[i])) wanted.insert(i);
      ASSERT_EQ(seen, wanted);
      EXPECT_TRUE(places.any(at.s, at.c, at.convex, [](std::uint32_t) { return true; }));
    }
  }
  places.restart(1.0);
  places.close();
  EXPECT_FALSE(places.any(0.0, 0.0, true, [](std::uint32_t) { return true; })) << "what was there before";
}

} // namespace
} // namespace scansion
