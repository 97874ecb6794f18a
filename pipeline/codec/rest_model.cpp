// Prediction of the rest: chords, neighbours and weighted sums.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/rest_model.hpp"

#include "pipeline/codec/kernels.hpp"

namespace scansion {

void fill_chord(std::span<const PointIndex> vertices, std::span<const std::int32_t> u, std::span<std::int32_t> chord) noexcept {
  if (vertices.empty()) return;
  chord[vertices.front()] = u[vertices.front()];
  for (std::size_t v = 1; v < vertices.size(); ++v) {
    const PointIndex a = vertices[v - 1];
    const PointIndex b = vertices[v];
    kernels::slope(u[a], Chord(u, a, b).step, chord.data() + a + 1, b - a - 1);
    chord[b] = u[b];
  }
}

namespace {

// The neighbours of a line by walking: forward as long as the next is not farther, then back a little. Lines that run back and
// forth cannot make it walk far more often than they have points.
void walk(const RestLine& line, std::span<const std::int32_t> main, std::span<PointIndex> beside) noexcept {
  constexpr int kMaxBack = 8;
  PointIndex j = line.above_first;
  for (PointIndex i = line.first; i < line.end; ++i) {
    const std::int64_t here = main[i];
    const auto away = [&](PointIndex p) { return std::abs(here - main[p]); };
    while (j + 1 < line.above_end && away(j + 1) <= away(j)) ++j;
    for (int back = 0; back < kMaxBack && j > line.above_first && away(j - 1) < away(j); ++back) --j;
    beside[i] = j;
  }
}

// Two even lines with one step: the walk would find exactly these, of two points equally near the later one.
bool is_straight(const LineGroup& group, const ScanLine& line, const GroupState& state, const AxisScale& scale,
                 std::span<const std::int32_t> main, const RestLine& at) noexcept {
  if (!scale.even || line.run_count != 1) return false;
  const Run& run = group.runs[line.first_run];
  const RunAbove& above = state.above[line.first_run];
  if (above.last + 1 != at.above_end || above.first != at.above_first || run.count < 3 || above.last - above.first < 2)
    return false;
  const std::int64_t step = std::int64_t{main[run.first + 1]} - main[run.first];
  if (step == 0 || step != std::int64_t{main[above.first + 1]} - main[above.first]) return false;
  if (step * (run.count - 1) != std::int64_t{main[run.first + run.count - 1]} - main[run.first]) return false;
  if (step * (above.last - above.first) != std::int64_t{main[above.last]} - main[above.first]) return false;
  const std::int64_t offset = std::int64_t{main[run.first]} - main[above.first];
  return std::int64_t{run.first} + above.shift - above.first == nearest_steps(offset, step);
}

} // namespace

void RestAxis::fill(std::span<const Run> runs, std::span<const PointIndex> vertices, std::span<const std::int32_t> u) {
  for (auto& mean : means) mean.resize(u.size());
  const std::int32_t* __restrict const from = u.data();
  std::int32_t* __restrict const on_chord = chord.data();
  std::int32_t* __restrict const off_chord = deviation.data();
  std::int32_t* __restrict const fast = means[0].data();
  std::int32_t* __restrict const slow = means[1].data();
  const auto at_vertex = [&](PointIndex v) {
    on_chord[v] = from[v];
    off_chord[v] = 0;
  };
  std::size_t v = 0;
  for (const Run& run : runs) {
    RunningMeans now;
    at_vertex(run.first);
    for (const PointIndex last = run.first + run.count - 1; vertices[v] != last; ++v) {
      const Chord line(u, vertices[v], vertices[v + 1]);
      std::int64_t here = std::int64_t{from[vertices[v]]} * (std::int64_t{1} << Chord::kStepBits);
      for (PointIndex i = vertices[v] + 1; i < vertices[v + 1]; ++i) {
        here += line.step;
        on_chord[i] = wrap(here >> Chord::kStepBits);
        const std::int32_t off = wrap(std::int64_t{from[i]} - on_chord[i]);
        off_chord[i] = off;
        fast[i] = now.fast;
        slow[i] = now.slow;
        now.add(off);
      }
      at_vertex(vertices[v + 1]);
    }
    ++v;
  }
}

void Neighbours::find(const LineGroup& group, const GroupState& state, const AxisScale& scale,
                      std::span<const std::int32_t> main) {
  lines.clear();
  beside.resize(main.size());
  for (const ScanLine& line : group.lines) {
    if (line.run_count == 0) continue;
    const auto runs = group.runs_of(line);
    RestLine at{runs.front().first, runs.back().first + runs.back().count};
    if (!lines.empty()) {
      at.has_above = true;
      at.above_first = lines.back().first;
      at.above_end = lines.back().end;
      at.straight = is_straight(group, line, state, scale, main, at);
      if (at.straight)
        at.shift = state.above[line.first_run].shift;
      else
        walk(at, main, beside);
    }
    lines.push_back(at);
  }
}

namespace {

static_assert(kBeside == kAcross);

struct AboveTaps {
  const std::int32_t* deviation;
  const std::int32_t* value;
  const std::int32_t* size;
};

template <class Tap>
void weigh(const Weights& w, PointIndex from, PointIndex to, const std::int32_t* chord, const AboveTaps& above,
           std::int64_t* sum, std::int32_t* size, Tap&& tap) noexcept {
  const auto wide = [](std::int32_t weight, std::int32_t v) { return std::int64_t{weight} * v; };
  const auto minus = [](std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b));
  };
  for (PointIndex i = from; i < to; ++i) {
    const std::array<std::ptrdiff_t, kBeside> at = tap(i);
    std::int64_t s = 0;
    for (std::size_t k = 0; k < kBeside; ++k) {
      s += wide(w[kLineWeights + k], above.deviation[at[k]]);
      s += wide(w[kLineWeights + kBeside + k], minus(above.value[at[k]], chord[static_cast<std::ptrdiff_t>(i + k) - 1]));
    }
    sum[i] = s;
    size[i] = above.size[at[0]] + 2 * above.size[at[1]] + above.size[at[2]];
  }
}

} // namespace

void RestAxis::weigh_above(const RestLine& line, const Neighbours& neighbours, std::span<const std::int32_t> u,
                           const Weights& weights) {
  const std::size_t n = line.end - line.first;
  if (!line.has_above || n < 3) {
    above_sum.assign(n, 0);
    above_size.assign(n, 0);
    return;
  }
  above_sum.resize(n);
  above_size.resize(n);
  above_sum.front() = above_sum.back() = 0;
  above_size.front() = above_size.back() = 0;
  const AboveTaps above{deviation.data(), u.data(), size.data()};
  // Ends of lines are vertices, so the chord has a point on either side of every point that is asked for.
  std::int64_t* sum = above_sum.data() - line.first;
  std::int32_t* sizes = above_size.data() - line.first;
  const auto held = [&](std::int64_t j) {
    std::array<std::ptrdiff_t, kBeside> at;
    for (std::int64_t k = -1; k <= 1; ++k)
      at[static_cast<std::size_t>(k + 1)] =
          static_cast<std::ptrdiff_t>(std::clamp<std::int64_t>(j + k, line.above_first, line.above_end - 1));
    return at;
  };
  const PointIndex from = line.first + 1;
  const PointIndex to = line.end - 1;
  if (!line.straight) {
    weigh(weights, from, to, chord.data(), above, sum, sizes, [&](PointIndex i) { return held(neighbours.beside[i]); });
    return;
  }
  const auto inside = [&](std::int64_t i) { return static_cast<PointIndex>(std::clamp<std::int64_t>(i, from, to)); };
  const PointIndex left = inside(std::int64_t{line.above_first} + 1 - line.shift);
  const PointIndex right = std::max(left, inside(std::int64_t{line.above_end} - 1 - line.shift));
  const auto at_ends = [&](PointIndex i) { return held(neighbours.of(line, i)); };
  weigh(weights, from, left, chord.data(), above, sum, sizes, at_ends);
  if (left < right) {
    const std::ptrdiff_t j = static_cast<std::ptrdiff_t>(left) + line.shift;
    kernels::weigh_above(weights.data() + kLineWeights, {above.deviation + j, above.value + j, above.size + j},
                         chord.data() + left, sum + left, sizes + left, right - left);
  }
  weigh(weights, right, to, chord.data(), above, sum, sizes, at_ends);
}

std::array<std::int32_t, kWeights> deviations_of(const RestAxis& axis, std::span<const std::int32_t> u,
                                                 const Neighbours& neighbours, const RestLine& line, PointIndex run_first,
                                                 PointIndex i) noexcept {
  std::array<std::int32_t, kWeights> d{};
  for (std::size_t k = 0; k < kLeft; ++k) d[k] = i >= run_first + k + 1 ? axis.deviation[i - k - 1] : 0;
  for (std::size_t k = 0; k < kMeans; ++k) d[kLeft + k] = axis.means[k][i];
  if (!line.has_above) return d;
  const std::int64_t j = neighbours.of(line, i);
  const auto held = [&](std::int64_t p) {
    return static_cast<PointIndex>(std::clamp<std::int64_t>(p, line.above_first, line.above_end - 1));
  };
  for (std::size_t k = 0; k < kBeside; ++k) {
    const PointIndex p = held(j + static_cast<std::int64_t>(k) - 1);
    d[kLineWeights + k] = axis.deviation[p];
    d[kLineWeights + kBeside + k] = wrap(std::int64_t{u[p]} - axis.chord[i + k - 1]);
  }
  return d;
}

} // namespace scansion
