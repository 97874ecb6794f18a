// Coded integers: tokens, frequencies, and arrays that come back.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/symbols.hpp"

#include <gtest/gtest.h>
#include <numeric>
#include <random>

namespace scansion {
namespace {

TEST(Tokens, EveryFoldedResidualLiesInTheRangeOfItsToken) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 100000; ++round) {
    const auto folded = static_cast<std::uint32_t>(random()) >> random() % 32;
    const std::uint32_t token = token_of(folded);
    ASSERT_LT(token, kTokens);
    const TokenRange range = kTokenRanges[token];
    ASSERT_GE(folded, range.first);
    ASSERT_LE(folded - range.first, (std::uint64_t{1} << range.bits) - 1);
    ASSERT_EQ(fold(unfold(folded)), folded);
  }
  EXPECT_EQ(token_of(~0U), kTokens - 1);
}

TEST(Frequencies, LogarithmIsCloseAndGrows) {
  std::uint32_t before = 0;
  for (std::uint32_t x = 1; x < 70000; ++x) {
    const std::uint32_t log = log2_fixed(x);
    EXPECT_NEAR(log, std::log2(x) * (1 << kLogBits), 32);
    EXPECT_GE(log, before);
    before = log;
  }
}

TEST(Frequencies, AnyClassesAddUpToTheTotal) {
  std::mt19937 random(2);
  for (int round = 0; round < 20000; ++round) {
    Classes classes{};
    const std::size_t used = 1 + random() % kTokens;
    const auto most = static_cast<std::uint32_t>(1 + random() % kMaxClass);
    for (std::size_t t = 0; t < used; ++t) classes[t] = static_cast<std::uint8_t>(random() % (most + 1));
    Frequencies frequencies;
    const bool any = std::ranges::any_of(classes, [](auto k) { return k != 0; });
    ASSERT_EQ(frequencies_of(classes, frequencies), any);
    if (!any) continue;
    ASSERT_EQ(std::accumulate(frequencies.begin(), frequencies.end(), 0U), kTotal);
    for (std::size_t t = 0; t < kTokens; ++t) ASSERT_EQ(frequencies[t] != 0, classes[t] != 0);

    Bytes bytes;
    BitWriter writer(bytes);
    write_classes(classes, writer);
    writer.flush();
    BitReader reader(bytes);
    Classes read;
    ASSERT_TRUE(read_classes(reader, read));
    ASSERT_EQ(read, classes);
    ASSERT_TRUE(reader.untouched().empty());
  }
}

struct Value {
  std::int32_t value;
  std::uint32_t context;
};

Bytes written(const std::vector<Value>& values, bool as_long = false) {
  SymbolWriter writer;
  writer.clear();
  for (const Value& v : values) writer.put(v.value, v.context);
  Bytes bytes;
  as_long ? writer.write_long(bytes) : writer.write(bytes);
  return bytes;
}

// The same as a long array, read with a cursor that leaves its bytes only once in a while.
void expect_comes_back_long(const std::vector<Value>& values) {
  const Bytes bytes = written(values, true);
  SymbolReader reader;
  ByteReader from(bytes);
  constexpr std::size_t kUnheld = 100;
  ASSERT_TRUE(reader.begin_long(from, kUnheld));
  EXPECT_TRUE(from.at_end());
  auto cursor = reader.cursor();
  for (std::size_t i = 0; i < values.size(); ++i) {
    ASSERT_EQ(unfold(cursor.next<kLongStates>(cursor.table(values[i].context))), values[i].value);
    if (i % kUnheld == kUnheld - 1) cursor.hold();
  }
  reader.set(cursor);
  EXPECT_TRUE(reader.finish());
}

void expect_comes_back(const std::vector<Value>& values) {
  expect_comes_back_long(values);
  const Bytes bytes = written(values);
  SymbolReader reader;
  ByteReader from(bytes);
  const auto begun = reader.begin(from);
  ASSERT_TRUE(begun) << begun.error().context;
  EXPECT_TRUE(from.at_end());
  for (const Value& v : values) ASSERT_EQ(reader.next(v.context), v.value);
  EXPECT_TRUE(reader.finish());
}

TEST(Symbols, ArraysComeBack) {
  expect_comes_back({});
  expect_comes_back({{0, 0}, {0, 47}});
  expect_comes_back({{1, 47}});
  expect_comes_back({{std::numeric_limits<std::int32_t>::min(), 3}, {std::numeric_limits<std::int32_t>::max(), 3}, {-1, 0}});
  std::mt19937_64 random(3);
  for (int round = 0; round < 300; ++round) {
    std::vector<Value> values(random() % 5000);
    const auto contexts = static_cast<std::uint32_t>(1 + random() % kMaxContexts);
    for (Value& v : values) {
      v.context = static_cast<std::uint32_t>(random() % contexts);
      // Residuals grow with the context, as they should.
      v.value =
          static_cast<std::int32_t>(random()) >> std::max(0, 31 - static_cast<int>(v.context) - static_cast<int>(random() % 4));
    }
    expect_comes_back(values);
  }
}

TEST(Symbols, NoiseCostsLittleMoreThanItsEntropy) {
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0.0, 5.0);
  std::vector<Value> values(60000);
  for (Value& v : values) v = {static_cast<std::int32_t>(std::lround(noise(random))), 7};
  EXPECT_LT(8.0 * static_cast<double>(written(values).size()) / static_cast<double>(values.size()), 4.369 + 0.02);
}

TEST(Symbols, ContextsThatDifferGetTablesOfTheirOwn) {
  std::mt19937 random(5);
  std::vector<Value> apart;
  std::vector<Value> together;
  for (int i = 0; i < 40000; ++i) {
    const bool wild = random() % 2 == 0;
    const auto value = static_cast<std::int32_t>(wild ? random() % 2000 : random() % 3);
    apart.push_back({value, wild ? 30U : 5U});
    together.push_back({value, 5});
  }
  EXPECT_LT(written(apart).size() * 10, written(together).size() * 9);
}

TEST(Symbols, DamageIsFoundOrHarmless) {
  std::mt19937 random(6);
  std::vector<Value> values(500);
  for (Value& v : values) v = {static_cast<std::int32_t>(random() % 30) - 15, static_cast<std::uint32_t>(random() % 3)};
  const Bytes good = written(values);
  std::size_t found = 0;
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    Bytes bytes = good;
    bytes[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
    SymbolReader reader;
    ByteReader from(bytes);
    if (!reader.begin(from)) {
      ++found;
      continue;
    }
    for (const Value& v : values) (void)reader.next(v.context);
    found += reader.finish() && from.at_end() ? 0U : 1U;
  }
  EXPECT_GT(found, good.size() * 8 / 2); // a wrong bit may end in one wrong token; the payload's checksum finds it
}

} // namespace
} // namespace scansion
