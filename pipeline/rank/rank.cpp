// The complete Douglas-Peucker rearrangement: which code ranks a run, and the one that takes any run.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/rank/rank.hpp"

#include "pipeline/rank/farthest.hpp"
#include "pipeline/rank/hull_tree.hpp"
#include "pipeline/rank/vector_job.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>

namespace scansion {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// What the vector kernels call for intervals that have points beyond an end of their chord, or points they cannot tell apart.
Found search_exactly(const VectorJob& job, std::uint32_t a, std::uint32_t b) {
  const auto search = [&](const auto& kernel) {
    const auto f = farthest(kernel, MiddleRule({}), a, b);
    return Found{static_cast<std::uint32_t>(f.index), exact::nearest_double(f.distance.numerator),
                 exact::nearest_double(f.distance.denominator)};
  };
  if (job.w == nullptr) return search(Planar{job.u, job.v});
  return job.wide ? search(Wide{job.u, job.v, job.w}) : search(Spatial{job.u, job.v, job.w});
}

// A point whose chord and way from its first end span less than 2^29 counts: products of two differences, and their sums, fit
// 64 bits.
Found measure_narrow(const std::int64_t* e, const std::int64_t* d, std::uint32_t k) {
  const auto square = [](const std::int64_t* p) { return static_cast<std::uint64_t>(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]); };
  const std::int64_t dot = e[0] * d[0] + e[1] * d[1] + e[2] * d[2];
  const std::uint64_t length = square(e);
  if (dot <= 0) return {k, static_cast<double>(square(d)), 1.0};
  if (static_cast<std::uint64_t>(dot) >= length) {
    const std::int64_t f[3] = {d[0] - e[0], d[1] - e[1], d[2] - e[2]};
    return {k, static_cast<double>(square(f)), 1.0};
  }
  exact::U128 sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3;
    const std::int64_t c = e[i] * d[j] - e[j] * d[i];
    const auto magnitude = static_cast<exact::U128>(c < 0 ? -c : c);
    sum += magnitude * magnitude;
  }
  return {k, exact::nearest_double(sum), static_cast<double>(length)};
}

// For lone points, and those of runs of long span.
Found measure_exactly(const VectorJob& job, std::uint32_t a, std::uint32_t b, std::uint32_t k) {
  constexpr std::int64_t kNarrow = std::int64_t{1} << 29;
  const std::int32_t* const axes[3] = {job.u, job.v, job.w};
  std::int64_t e[3];
  std::int64_t d[3];
  bool narrow = true;
  for (std::size_t i = 0; i < 3; ++i) {
    e[i] = std::int64_t{axes[i][b]} - axes[i][a];
    d[i] = std::int64_t{axes[i][k]} - axes[i][a];
    narrow &= std::abs(e[i]) < kNarrow && std::abs(d[i]) < kNarrow;
  }
  if (narrow) return measure_narrow(e, d, k);
  const Wide kernel{job.u, job.v, job.w};
  const auto chord = kernel.chord(a, b);
  Wide::Cross cross;
  Wide::Beyond beyond;
  if (!kernel.measure(chord, k, cross, beyond)) return {k, exact::nearest_double(beyond), 1.0};
  return {k, exact::nearest_double(cross), exact::nearest_double(chord.length)};
}

// The guard of one job; the tree is made for the first interval that needs it.
struct Guard {
  HullTree tree;
  bool ready = false;
};

Found search_guarded(const VectorJob& job, std::uint32_t a, std::uint32_t b) {
  auto& guard = *static_cast<Guard*>(job.guard);
  if (!guard.ready) guard.tree.reset(job.u, job.v, job.n);
  guard.ready = true;
  return guard.tree.find(a, b);
}

} // namespace

bool has_rank_unit(RankUnit unit) noexcept {
  switch (unit) {
    case RankUnit::one_by_one:
    case RankUnit::portable:
    case RankUnit::automatic: return true;
#if defined(__x86_64__)
    case RankUnit::avx2:
      return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi") != 0 && __builtin_cpu_supports("bmi2") != 0 &&
             __builtin_cpu_supports("fma") != 0;
    case RankUnit::avx512:
      return has_rank_unit(RankUnit::avx2) && __builtin_cpu_supports("avx512f") != 0 &&
             __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
             __builtin_cpu_supports("avx512vl") != 0;
#else
    case RankUnit::avx2:
    case RankUnit::avx512: return false;
#endif
  }
  return false;
}

RankUnit unit_for(RankUnit wanted, std::size_t points) noexcept {
  if (wanted != RankUnit::automatic) return wanted;
  static const bool has_avx512 = has_rank_unit(RankUnit::avx512);
  static const RankUnit narrow = has_rank_unit(RankUnit::avx2) ? RankUnit::avx2 : RankUnit::portable;
  // Wide lanes pay where most of the work is in long intervals; in short ones they only cost clock rate.
  constexpr std::size_t kLong = 8192;
  return has_avx512 && points >= kLong ? RankUnit::avx512 : narrow;
}

struct Ranker::Scratch {
  struct Part {
    std::uint32_t a, b, depth;
    double parent;
  };
  std::vector<Part> stack;
  std::vector<std::int32_t> copies;
  std::vector<std::uint32_t> pairs, reach;
  std::vector<Interval> runs;
  std::vector<Waiting> waiting;
  Guard guard;

  void reserve(std::size_t n) {
    if (pairs.size() >= n + kVectorPad) return;
    copies.resize(3 * (n + kVectorPad));
    pairs.resize(n + kVectorPad);
    reach.resize(n + kVectorPad);
    waiting.resize(waiting_intervals(n));
  }
};

Ranker::Ranker(Rational resolution_mm, RankUnit unit, double floor_counts)
    : resolution_(resolution_mm), wanted_(unit), squared_floor_(floor_counts * floor_counts),
      scratch_(std::make_unique<Scratch>()) {}
Ranker::~Ranker() = default;
Ranker::Ranker(Ranker&&) noexcept = default;
Ranker& Ranker::operator=(Ranker&&) noexcept = default;

void Ranker::rank(const RunPoints& run, std::span<double> distance, std::span<std::uint32_t> depth) {
  const std::size_t n = run.size();
  if (n == 0) return;
  for (const std::size_t end : {std::size_t{0}, n - 1}) {
    distance[end] = kInfinity;
    depth[end] = 0;
  }
  if (n < 3) return;
  scratch_->runs.assign(1, {0, static_cast<std::uint32_t>(n - 1)});
  if (wanted_ == RankUnit::one_by_one || !run.position.empty())
    rank_one_by_one(run, distance, depth);
  else
    rank_by_vectors(run, distance, depth);
}

void Ranker::rank(const std::array<std::span<const std::int32_t>, 3>& xyz, std::span<const Run> runs,
                  std::span<double> distance, std::span<std::uint32_t> depth) {
  // As many runs at once as stay in the nearest cache with all that ranking them needs.
  constexpr std::uint32_t kTogether = 1024;
  for (std::size_t r = 0; r < runs.size();) {
    auto& together = scratch_->runs;
    together.clear();
    const std::uint32_t first = runs[r].first;
    std::uint32_t points = 0;
    for (; r < runs.size() && (points == 0 || points + runs[r].count <= kTogether); ++r) {
      together.push_back({points, points + runs[r].count - 1});
      points += runs[r].count;
    }
    const auto part = [&](const auto& all, std::uint32_t from, std::uint32_t count) { return all.subspan(from, count); };
    const auto rank_part = [&](std::uint32_t from, std::uint32_t count, auto&& how) {
      how(RunPoints{part(xyz[0], from, count), part(xyz[1], from, count), part(xyz[2], from, count), {}},
          part(distance, from, count), part(depth, from, count));
    };
    if (wanted_ != RankUnit::one_by_one) {
      rank_part(first, points, [&](const RunPoints& p, auto d, auto n) { rank_by_vectors(p, d, n); });
      continue;
    }
    for (const auto [a, b] : std::vector(together))
      rank_part(first + a, b - a + 1, [&](const RunPoints& p, auto d, auto n) { rank(p, d, n); });
  }
}

// Ranks the runs listed in the scratch memory, `points` being all of theirs.
void Ranker::rank_by_vectors(const RunPoints& points, std::span<double> distance, std::span<std::uint32_t> depth) {
  Scratch& s = *scratch_;
  s.reserve(points.size());
  if (s.guard.ready) s.guard = {};
  const VectorJob job{.axes = {points.x.data(), points.y.data(), points.z.data()},
                      .n = static_cast<std::uint32_t>(points.size()),
                      .runs = s.runs.data(),
                      .run_count = static_cast<std::uint32_t>(s.runs.size()),
                      .scale_num = static_cast<double>(resolution_.num),
                      .scale_den = static_cast<double>(resolution_.den),
                      .squared_floor = squared_floor_,
                      .distance = distance.data(),
                      .depth = depth.data(),
                      .copies = s.copies.data(),
                      .pairs = s.pairs.data(),
                      .reach = s.reach.data(),
                      .waiting = s.waiting.data(),
                      .exact = search_exactly,
                      .measure = measure_exactly,
                      .guarded = search_guarded,
                      .guard = &s.guard};
  switch (unit_for(wanted_, points.size())) {
#if defined(__x86_64__)
    case RankUnit::avx512: return rank_avx512(job);
    case RankUnit::avx2: return rank_avx2(job);
#endif
    default: return rank_portable(job);
  }
}

void Ranker::rank_one_by_one(const RunPoints& run, std::span<double> distance, std::span<std::uint32_t> depth) {
  const MiddleRule rule(run.position);
  auto& stack = scratch_->stack;
  with_kernel(run, [&](const auto& kernel) {
    stack.clear();
    stack.push_back({0, static_cast<std::uint32_t>(run.size() - 1), 1, kInfinity});
    while (!stack.empty()) {
      Scratch::Part i = stack.back();
      stack.pop_back();
      while (i.b - i.a >= 2) {
        std::size_t split;
        double d = 0.0;
        if (i.parent == 0.0) {
          split = rule.middle(i.a, i.b); // a chord on which all points lie: repeated bisection
        } else {
          const auto f = farthest(kernel, rule, i.a, i.b);
          split = f.index;
          d = std::min(exact::millimetres(f.distance, resolution_), i.parent);
          const double squared = exact::nearest_double(f.distance.numerator) / exact::nearest_double(f.distance.denominator);
          if (squared > 0 && squared <= squared_floor_) {
            std::fill(distance.begin() + i.a + 1, distance.begin() + i.b, d);
            std::fill(depth.begin() + i.a + 1, depth.begin() + i.b, i.depth);
            break;
          }
        }
        distance[split] = d;
        depth[split] = i.depth;
        // The longer half waits, the shorter one is next: the stack stays below log2(n) entries.
        const auto k = static_cast<std::uint32_t>(split);
        const Scratch::Part left{i.a, k, i.depth + 1, d};
        const Scratch::Part right{k, i.b, i.depth + 1, d};
        const bool left_is_longer = k - i.a > i.b - k;
        stack.push_back(left_is_longer ? left : right);
        i = left_is_longer ? right : left;
      }
    }
  });
}

double segment_distance(const RunPoints& run, std::size_t p, std::size_t a, std::size_t b, Rational resolution) {
  // All kernels give the same numerator and denominator; three points decide which one is wide enough.
  const auto three = [&](std::span<const std::int32_t> axis) { return std::array{axis[a], axis[p], axis[b]}; };
  const auto x = three(run.x);
  const auto y = three(run.y);
  const auto z = three(run.z);
  return with_kernel({x, y, z, {}}, [&](const auto& kernel) {
    using Kernel = std::remove_cvref_t<decltype(kernel)>;
    using Squared = exact::Squared<typename Kernel::Number, typename Kernel::Length>;
    const auto chord = kernel.chord(0, 2);
    typename Kernel::Cross cross;
    typename Kernel::Beyond beyond;
    return kernel.measure(chord, 1, cross, beyond)
               ? exact::millimetres(Squared{Kernel::squared(cross), chord.length}, resolution)
               : exact::millimetres(Squared{beyond, 1}, resolution);
  });
}

} // namespace scansion
