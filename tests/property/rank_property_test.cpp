// The ranking against the brute-force reference, and its promises on long lines.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rank/farthest.hpp"
#include "pipeline/rank/hull_tree.hpp"
#include "pipeline/rank/rank.hpp"
#include "tests/property/reference.hpp"

#include <cstdlib>
#include <gtest/gtest.h>
#include <iostream>
#include <numeric>

namespace scansion::test {
namespace {

struct Ranked {
  std::vector<double> distance;
  std::vector<std::uint32_t> depth;
};

Ranked rank(Ranker& ranker, const Coordinates& c, std::span<const std::uint32_t> position = {}) {
  Ranked r{std::vector<double>(c[0].size()), std::vector<std::uint32_t>(c[0].size())};
  ranker.rank({c[0], c[1], c[2], position}, r.distance, r.depth);
  return r;
}

constexpr Rational kMicrometre{1, 1000};

TEST(RankProperty, EqualsTheReferenceOnRandomAndAdversarialRuns) {
  Random random(1);
  Ranker ranker(kMicrometre);
  for (int round = 0; round < 6000; ++round) {
    const Kind kind = any_kind(random);
    const auto n = static_cast<std::size_t>(pick(random, 1, round % 100 == 0 ? 300 : 40));
    const Coordinates c = make_run(random, kind, n);
    const Ranked got = rank(ranker, c);
    const ReferenceRank want = reference_rank(c, kMicrometre);
    ASSERT_EQ(got.distance, want.distance) << "kind " << static_cast<int>(kind) << " n " << n << " round " << round;
    ASSERT_EQ(got.depth, want.depth) << "kind " << static_cast<int>(kind) << " n " << n << " round " << round;
  }
}

std::vector<RankUnit> vector_units() {
  std::vector<RankUnit> units{RankUnit::portable};
  for (const RankUnit unit : {RankUnit::avx2, RankUnit::avx512}) {
    if (has_rank_unit(unit))
      units.push_back(unit);
    else
      std::cout << "SKIPPED: this processor lacks " << (unit == RankUnit::avx2 ? "AVX2" : "AVX-512") << std::endl;
  }
  return units;
}

std::vector<std::uint32_t> sorted_in_full(const Ranked& r) {
  std::vector<std::uint32_t> order(r.distance.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, [&](std::uint32_t p, std::uint32_t q) {
    if (r.distance[p] != r.distance[q]) return r.distance[p] > r.distance[q];
    return r.depth[p] != r.depth[q] ? r.depth[p] < r.depth[q] : p < q;
  });
  return order;
}

// SCANSION_RANK_ROUNDS=1000000 for the long form.
TEST(RankProperty, AllUnitsGiveTheSame) {
  const char* const wanted = std::getenv("SCANSION_RANK_ROUNDS");
  const int rounds = wanted != nullptr ? std::atoi(wanted) : 20'000;
  Random random(6);
  Ranker one_by_one(kMicrometre, RankUnit::one_by_one);
  struct Unit {
    Ranker ranker;
    RankSorter sorter;
  };
  std::vector<Unit> units;
  for (const RankUnit unit : vector_units()) units.push_back({Ranker(kMicrometre, unit), RankSorter(unit)});
  std::vector<std::uint32_t> order;
  for (int round = 0; round < rounds; ++round) {
    const Kind kind = any_kind(random);
    const auto n = static_cast<std::size_t>(pick(random, 1, round % 50 == 0 ? 2000 : round % 5 == 0 ? 300 : 40));
    const Coordinates c = make_run(random, kind, n);
    const Ranked want = rank(one_by_one, c);
    const std::vector<std::uint32_t> wanted_order = sorted_in_full(want);
    for (Unit& unit : units) {
      const Ranked got = rank(unit.ranker, c);
      const auto index = &unit - units.data();
      ASSERT_EQ(got.distance, want.distance) << "unit " << index << " kind " << static_cast<int>(kind) << " round " << round;
      ASSERT_EQ(got.depth, want.depth) << "unit " << index << " kind " << static_cast<int>(kind) << " round " << round;
      unit.sorter.sort(got.distance, got.depth, order);
      ASSERT_EQ(order, wanted_order) << "unit " << index << " kind " << static_cast<int>(kind) << " round " << round;
    }
  }
}

TEST(RankProperty, RunsOfAGroupRankAsTheyDoAlone) {
  Random random(7);
  Ranker one_by_one(kMicrometre, RankUnit::one_by_one);
  for (const RankUnit unit : vector_units()) {
    Ranker ranker(kMicrometre, unit);
    for (int round = 0; round < 500; ++round) {
      Coordinates all;
      std::vector<scansion::Run> runs;
      const Kind common = any_kind(random);
      const bool mixed = random() % 2 == 0;
      for (std::int64_t r = pick(random, 1, 30); r > 0; --r) {
        const Coordinates c =
            make_run(random, mixed ? any_kind(random) : common, static_cast<std::size_t>(pick(random, 1, 300)));
        runs.push_back({static_cast<std::uint32_t>(all[0].size()), static_cast<std::uint32_t>(c[0].size()), 0});
        for (std::size_t axis = 0; axis < 3; ++axis) all[axis].insert(all[axis].end(), c[axis].begin(), c[axis].end());
      }
      const std::array<std::span<const std::int32_t>, 3> xyz{all[0], all[1], all[2]};
      Ranked want{std::vector<double>(all[0].size()), std::vector<std::uint32_t>(all[0].size())};
      Ranked got = want;
      one_by_one.rank(xyz, runs, want.distance, want.depth);
      ranker.rank(xyz, runs, got.distance, got.depth);
      ASSERT_EQ(got.distance, want.distance) << "round " << round;
      ASSERT_EQ(got.depth, want.depth) << "round " << round;
    }
  }
}

TEST(RankProperty, TheGuardFindsWhatScanningFinds) {
  Random random(8);
  for (int round = 0; round < 1500; ++round) {
    const Kind kind = any_kind(random);
    if (kind == Kind::wide) continue;
    const auto n = static_cast<std::size_t>(pick(random, 3, round % 20 == 0 ? 3000 : 500));
    const Coordinates c = make_run(random, kind, n);
    HullTree tree;
    tree.reset(c[0].data(), c[2].data(), static_cast<std::uint32_t>(n));
    for (int t = 0; t < 20; ++t) {
      const auto a = static_cast<std::uint32_t>(pick(random, 0, static_cast<std::int64_t>(n) - 3));
      const auto b = static_cast<std::uint32_t>(pick(random, a + 2, static_cast<std::int64_t>(n) - 1));
      const auto want = farthest(Planar{c[0].data(), c[2].data()}, MiddleRule({}), a, b);
      const Found got = tree.find(a, b);
      ASSERT_EQ(got.index, want.index) << "kind " << static_cast<int>(kind) << " n " << n << " a " << a << " b " << b;
      ASSERT_EQ(got.numerator, exact::nearest_double(want.distance.numerator));
      ASSERT_EQ(got.denominator, exact::nearest_double(want.distance.denominator));
    }
  }
}

// A zigzag that dies away splits at its end each time: quadratic without the guard.
TEST(RankProperty, ALineMadeToBeSlowIsRankedTheSame) {
  Coordinates c;
  constexpr std::int32_t kPoints = 6000;
  for (std::int32_t i = 0; i < kPoints; ++i) {
    c[0].push_back(i * 100);
    c[1].push_back(0);
    c[2].push_back((i % 2 == 0 ? 1 : -1) * (kPoints - i) / 2);
  }
  Ranker one_by_one(kMicrometre, RankUnit::one_by_one);
  const Ranked want = rank(one_by_one, c);
  for (const RankUnit unit : vector_units()) {
    Ranker ranker(kMicrometre, unit);
    const Ranked got = rank(ranker, c);
    EXPECT_EQ(got.distance, want.distance);
    EXPECT_EQ(got.depth, want.depth);
    std::vector<std::uint32_t> order;
    RankSorter(unit).sort(got.distance, got.depth, order);
    EXPECT_EQ(order, sorted_in_full(got));
  }
}

TEST(RankProperty, ToleranceSelectsTheTextbookPoints) {
  Random random(2);
  Ranker ranker(kMicrometre);
  for (int round = 0; round < 1500; ++round) {
    const Coordinates c = make_run(random, any_kind(random), static_cast<std::size_t>(pick(random, 1, 60)));
    const Ranked got = rank(ranker, c);
    for (int t = 0; t < 4; ++t) {
      // Half of the tolerances are met exactly by a point: > and >= must differ.
      const double tolerance = t % 2 == 0 ? 1e-4 * static_cast<double>(pick(random, 1, 100000))
                                          : std::min(1e6, got.distance[random() % got.distance.size()]);
      const std::vector<bool> want = textbook(c, tolerance, kMicrometre);
      for (std::size_t i = 0; i < want.size(); ++i) ASSERT_EQ(got.distance[i] > tolerance, want[i]) << "round " << round;
    }
  }
}

TEST(RankProperty, KeptPointsAloneRankTheSame) {
  Random random(3);
  Ranker ranker(kMicrometre);
  for (int round = 0; round < 2000; ++round) {
    const Coordinates c = make_run(random, any_kind(random), static_cast<std::size_t>(pick(random, 3, 200)));
    const Ranked all = rank(ranker, c);
    const double tolerance = std::min(1e6, all.distance[random() % all.distance.size()]);
    Coordinates kept;
    std::vector<std::uint32_t> position;
    for (std::size_t i = 0; i < c[0].size(); ++i) {
      if (!(all.distance[i] > tolerance)) continue;
      position.push_back(static_cast<std::uint32_t>(i));
      for (std::size_t axis = 0; axis < 3; ++axis) kept[axis].push_back(c[axis][i]);
    }
    const Ranked some = rank(ranker, kept, position);
    for (std::size_t k = 0; k < position.size(); ++k) {
      ASSERT_EQ(some.distance[k], all.distance[position[k]]) << "round " << round;
      ASSERT_EQ(some.depth[k], all.depth[position[k]]) << "round " << round;
    }
  }
}

// Above the floor nothing changes; below, tolerances still keep their promise.
TEST(RankProperty, AFloorEndsSplittingAndNothingElse) {
  Random random(9);
  Ranker whole_ranker(kMicrometre);
  const std::vector<RankUnit> units = vector_units();
  for (int round = 0; round < 1500; ++round) {
    const Kind kind = any_kind(random);
    const Coordinates c = make_run(random, kind, static_cast<std::size_t>(pick(random, 1, round % 50 == 0 ? 1000 : 60)));
    const double floor = round % 3 == 0 ? 0.5 : static_cast<double>(pick(random, 1, kind == Kind::part ? 8 : 3000));
    const double floor_mm = floor * 1 / 1000;
    const Ranked whole = rank(whole_ranker, c);
    Ranker one_by_one(kMicrometre, RankUnit::one_by_one, floor);
    const Ranked want = rank(one_by_one, c);
    const RunPoints points{c[0], c[1], c[2], {}};
    const double tolerance = floor_mm * static_cast<double>(pick(random, 0, 100)) / 100;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < c[0].size(); ++i) {
      if (whole.distance[i] > floor_mm) {
        ASSERT_EQ(want.distance[i], whole.distance[i]) << "round " << round;
        ASSERT_EQ(want.depth[i], whole.depth[i]) << "round " << round;
      } else {
        ASSERT_GE(want.distance[i], whole.distance[i]) << "round " << round;
        ASSERT_LE(want.distance[i], floor_mm) << "round " << round;
      }
      if (!(want.distance[i] > tolerance)) continue;
      for (std::size_t left_out = kept + 1; left_out < i; ++left_out)
        ASSERT_LE(segment_distance(points, left_out, kept, i, kMicrometre), tolerance) << "round " << round;
      kept = i;
    }
    for (const RankUnit unit : units) {
      Ranker ranker(kMicrometre, unit, floor);
      const Ranked got = rank(ranker, c);
      ASSERT_EQ(got.distance, want.distance) << "kind " << static_cast<int>(kind) << " round " << round;
      ASSERT_EQ(got.depth, want.depth) << "kind " << static_cast<int>(kind) << " round " << round;
    }
  }
}

TEST(RankProperty, PlanarAndSpatialKernelsAgree) {
  // The same planar run, turned by exchanging axes, and lifted into space by a copy of one axis where that is exact.
  Random random(4);
  Ranker ranker(kMicrometre);
  for (int round = 0; round < 1000; ++round) {
    const Coordinates c = make_run(random, Kind::plane_cloud, static_cast<std::size_t>(pick(random, 1, 120)));
    const Ranked xz = rank(ranker, c);
    EXPECT_EQ(rank(ranker, {c[0], c[2], c[1]}).distance, xz.distance);
    EXPECT_EQ(rank(ranker, {c[1], c[0], c[2]}).distance, xz.distance);
    for (std::size_t k = 1; k + 1 < c[0].size(); ++k)
      EXPECT_EQ(segment_distance({c[0], c[1], c[2], {}}, k, 0, c[0].size() - 1, kMicrometre),
                to_mm(squared_distance(c, k, 0, c[0].size() - 1), kMicrometre));
  }
}

TEST(RankProperty, LongRunsFinishAndKeepTheirOrder) {
  Random random(5);
  Ranker ranker(kMicrometre);
  for (const Kind kind : {Kind::part, Kind::two_step, Kind::flat, Kind::zigzag, Kind::duplicates, Kind::tiny_grid}) {
    const Coordinates c = make_run(random, kind, 1'000'000);
    const Ranked r = rank(ranker, c);
    std::vector<std::uint32_t> order;
    RankSorter().sort(r.distance, r.depth, order);
    EXPECT_EQ(order[0], 0U);
    EXPECT_EQ(order[1], c[0].size() - 1);
    for (std::size_t i = 2; i < order.size(); ++i) ASSERT_GE(r.distance[order[i - 1]], r.distance[order[i]]);
  }
}

TEST(RankProperty, DecimalTiesAreDecimal) {
  // A point exactly 0.05 mm above its chord is not farther than a tolerance of 0.05, whatever the resolution.
  for (const Rational resolution : {Rational{1, 1000}, Rational{1, 200}, Rational{1, 100000}}) {
    const auto counts = static_cast<std::int32_t>(0.05 / resolution.value() + 0.5);
    Ranker ranker(resolution);
    const Ranked r = rank(ranker, {std::vector<std::int32_t>{0, 1000, 2000}, {0, 0, 0}, {0, counts, 0}});
    EXPECT_EQ(r.distance[1], 0.05);
  }
}

} // namespace
} // namespace scansion::test
