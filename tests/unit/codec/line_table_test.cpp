// Axis scales: shared steps and steps that nearly all values share.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/line_table.hpp"

#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace scansion {
namespace {

void expect_scale_holds(const std::vector<std::int32_t>& values) {
  const AxisScale scale = find_scale(values);
  for (const std::int32_t v : values) {
    const std::int64_t u = scale.steps(v);
    const std::int64_t r = scale.remainder(v);
    EXPECT_EQ(std::int64_t{scale.base} + static_cast<std::int64_t>(scale.step) * u + r, v);
    EXPECT_EQ(u, static_cast<std::int32_t>(u));
    if (!scale.split) {
      EXPECT_EQ(r, 0);
    }
  }
}

TEST(AxisScale, FindsTheSharedStep) {
  EXPECT_EQ(find_scale(std::vector<std::int32_t>{7, 1007, -2993}).step, 1000U);
  EXPECT_FALSE(find_scale(std::vector<std::int32_t>{7, 1007, -2993}).split);
  EXPECT_EQ(find_scale(std::vector<std::int32_t>{5, 5, 5}).step, 1U);
  expect_scale_holds({7, 1007, -2993});
}

TEST(AxisScale, SplitsWhenNearlyAllShareACoarserStep) {
  std::mt19937 random(1);
  std::vector<std::int32_t> values;
  values.reserve(2000);
  for (int i = 0; i < 2000; ++i)
    values.push_back(static_cast<std::int32_t>(random() % 2000000) * 1000 + (i % 20 == 0 ? 370 : 0) - 1000000000);
  const AxisScale scale = find_scale(values);
  EXPECT_EQ(scale.step, 1000U);
  EXPECT_TRUE(scale.split);
  expect_scale_holds(values);
}

TEST(AxisScale, ExtremesFit) {
  constexpr std::int32_t low = std::numeric_limits<std::int32_t>::min();
  constexpr std::int32_t high = std::numeric_limits<std::int32_t>::max();
  expect_scale_holds({low, high});
  expect_scale_holds({low, high, 0, 1, -1});
  expect_scale_holds({high - 1, high});
  expect_scale_holds({low, low + 1});
  expect_scale_holds({high});
  std::mt19937 random(2);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::int32_t> values;
    values.reserve(100);
    const auto step = static_cast<std::int32_t>(1 + random() % 100000);
    for (int i = 0; i < 100; ++i) values.push_back(static_cast<std::int32_t>(random()) / step * step);
    expect_scale_holds(values);
  }
}

using Runs = std::vector<Run>; // in tests Run is a function
using Lines = std::vector<Runs>;

LineGroup group_of(const Lines& lines) {
  LineGroup group;
  for (const auto& runs : lines) {
    ScanLine line;
    line.index = group.lines.size();
    line.first_run = static_cast<std::uint32_t>(group.runs.size());
    line.run_count = static_cast<std::uint32_t>(runs.size());
    for (Run run : runs) {
      run.first = group.runs.empty() ? 0 : group.runs.back().first + group.runs.back().count;
      group.runs.push_back(run);
    }
    group.lines.push_back(line);
  }
  return group;
}

PayloadHeader header_of(const LineGroup& group) {
  PayloadHeader header;
  header.line_count = static_cast<std::uint16_t>(group.lines.size());
  header.points = group.runs.empty() ? 0 : group.runs.back().first + group.runs.back().count;
  return header;
}

Bytes table_of(const LineGroup& group) {
  Bytes table;
  write_line_table(group, {}, table);
  return table;
}

void expect_lines_come_back(const LineGroup& group) {
  LineGroup back;
  GroupFacts facts;
  const auto read = read_line_table(table_of(group), header_of(group), back, facts);
  ASSERT_TRUE(read) << read.error().context;
  EXPECT_EQ(back.lines, group.lines);
  EXPECT_EQ(back.runs, group.runs);
}

TEST(LineTable, LinesThatAreTheSameAreToldOnce) {
  const Runs plain{{0, 800, 0}};
  const Runs broken{{0, 5, 2}, {0, 7, 1}};
  const LineGroup same = group_of(Lines(64, plain));
  expect_lines_come_back(same);
  EXPECT_LT(table_of(same).size(), table_of(group_of({plain})).size() + 3);
  expect_lines_come_back(group_of({plain, plain, broken, broken, broken, {}, {}, plain}));
  LineGroup stamped = group_of({plain, plain, plain, plain});
  stamped.lines[1].stamps.encoder = 5;
  stamped.lines[2].stamps.encoder = 5;
  stamped.lines[3].invalid_after = 1;
  expect_lines_come_back(stamped);
}

TEST(LineTable, ImpossibleRepetitionsAreDamage) {
  const LineGroup same = group_of(Lines(4, {{0, 9, 0}}));
  Bytes table = table_of(same);
  LineGroup back;
  GroupFacts facts;
  const PayloadHeader header = header_of(same);
  for (const int more : {0, 2, 4, 127}) { // 3 is right
    table.back() = static_cast<std::byte>(more);
    EXPECT_FALSE(read_line_table(table, header, back, facts)) << more;
  }
  table.back() = std::byte{3};
  EXPECT_TRUE(read_line_table(table, header, back, facts));
  table[table.size() - 3] |= std::byte{8}; // a line with an encoder count of its own
  EXPECT_FALSE(read_line_table(table, header, back, facts));
}

TEST(AxisScale, EvenRunsAreFound) {
  std::vector<std::int32_t> scratch;
  const std::vector<scansion::Run> runs{{0, 3, 0}, {3, 1, 0}, {4, 4, 2}};
  const std::vector<std::int32_t> even{100, 200, 300, 7000, 50, 0, -50, -100};
  AxisScale scale = find_scale(even, runs, scratch);
  EXPECT_TRUE(scale.even);
  EXPECT_EQ(scale.step, 50U);
  std::vector<std::int32_t> u(even.size());
  to_steps(even, scale, u);
  for (std::size_t i = 0; i < even.size(); ++i) EXPECT_EQ(scale.base + static_cast<std::int32_t>(scale.step) * u[i], even[i]);
  for (std::size_t i = 0; i < even.size(); ++i) {
    std::vector<std::int32_t> bent = even;
    ++bent[i];
    EXPECT_EQ(find_scale(bent, runs, scratch).even, i == 3) << i; // a single point is always even
  }
  // Steps that wrap around 32 bits are not even.
  constexpr std::int32_t low = std::numeric_limits<std::int32_t>::min();
  EXPECT_FALSE(
      find_scale(std::vector<std::int32_t>{0, 2000000000, low + 1705032704}, std::vector<scansion::Run>{{0, 3, 0}}, scratch)
          .even);
}

TEST(AxisScale, StepsAreTheSameAsByDivision) {
  std::mt19937 random(3);
  for (int round = 0; round < 300; ++round) {
    const auto step = static_cast<std::int32_t>(1 + random() % (round % 2 == 0 ? 1000 : 100000000));
    std::vector<std::int32_t> values;
    values.reserve(50);
    for (int i = 0; i < 50; ++i) values.push_back(static_cast<std::int32_t>(random()) / step * step + 17 % step);
    const AxisScale scale = find_scale(values);
    std::vector<std::int32_t> u(values.size());
    to_steps(values, scale, u);
    for (std::size_t i = 0; i < values.size(); ++i) ASSERT_EQ(u[i], scale.steps(values[i]));
  }
}

} // namespace
} // namespace scansion
