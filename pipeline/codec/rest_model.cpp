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
// forth cannot make it walk far more often than they have points. Mostly the walk keeps step with the points.
void walk(const RestLine& line, std::span<const std::int32_t> main, std::span<PointIndex> beside) noexcept {
  constexpr int kMaxBack = 8;
  PointIndex j = line.above_first;
  const PointIndex last = line.above_end - 1;
  for (PointIndex i = line.first; i < line.end;) {
    const std::int64_t here = main[i];
    const auto away = [&](PointIndex p) { return std::abs(here - main[p]); };
    std::int64_t now = away(j);
    for (std::int64_t next = 0; j < last && (next = away(j + 1)) <= now; ++j) now = next;
    std::int64_t next = 0;
    for (int back = 0; back < kMaxBack && j > line.above_first && (next = away(j - 1)) < now; ++back, --j) now = next;
    const PointIndex most = std::min(line.end - i - 1, std::max(last - j, PointIndex{1}) - 1);
    const auto more = static_cast<PointIndex>(kernels::in_step(main.data() + i + 1, main.data() + j, most));
    for (PointIndex k = 0; k <= more; ++k) beside[i + k] = j + k;
    i += more + 1;
    j += more;
  }
}

// Two even lines with one step: the walk would find exactly these, of two points equally near the later one.
bool is_straight(const LineGroup& group, const ScanLine& line, const GroupState& state, const AxisScale& scale,
                 std::span<const std::int32_t> main, const RestLine& at) noexcept {
  if (!scale.even || scale.ruled || line.run_count != 1) return false;
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
  for (auto& mean : means) grow(mean, u.size());
  const auto at_vertex = [&](PointIndex v) {
    chord[v] = u[v];
    deviation[v] = 0;
  };
  std::size_t v = 0;
  for (const Run& run : runs) {
    RunningMeans now;
    at_vertex(run.first);
    for (const PointIndex last = run.first + run.count - 1; vertices[v] != last; ++v) {
      const PointIndex from = vertices[v] + 1;
      const PointIndex end = vertices[v + 1];
      at_vertex(end);
      if (from == end) continue;
      const Chord line(u, from - 1, end);
      kernels::off_slope(u[from - 1], line.step, u.data() + from, chord.data() + from, deviation.data() + from, end - from);
      now.pass(deviation.data() + from, means[0].data() + from, means[1].data() + from, end - from);
    }
    ++v;
  }
}

void Neighbours::find(const LineGroup& group, const GroupState& state, const AxisScale& scale,
                      std::span<const std::int32_t> main) {
  lines.clear();
  grow(beside, main.size());
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

static_assert(kBeside == kAcross);

/// The points of the line before, and what is known of each point of the group up to its end.
struct RestAxis::LineAbove {
  PointIndex first, end;
  const std::int32_t* deviation;
  const std::int32_t* value;
  const std::int32_t* size;
};

// What point j and those on either side add for themselves, held at the ends; and their sizes.
void RestAxis::weigh_beside(const std::int16_t* w, const LineAbove& above, std::int64_t j, std::int64_t& sum,
                            std::int32_t& size) noexcept {
  sum = 0;
  size = 0;
  for (std::size_t k = 0; k < kBeside; ++k) {
    const std::int64_t at = std::clamp<std::int64_t>(j + static_cast<std::int64_t>(k) - 1, above.first, above.end - 1);
    sum += std::int64_t{w[k]} * above.deviation[at] + std::int64_t{w[k + kBeside]} * above.value[at];
    size += (k == 1 ? 2 : 1) * above.size[at];
  }
}

// Neighbours that lie side by side are weighed as they are asked for; others one by one, each for whoever asks for it.
void RestAxis::weigh_above(const RestLine& line, const Neighbours& neighbours, std::span<const std::int32_t> u,
                           const Weights& weights) {
  const std::size_t n = line.end - line.first;
  if (above_sum.size() < n) {
    above_sum.resize(n);
    above_size.resize(n);
  }
  if (!line.has_above || n < 3) {
    std::fill_n(above_sum.begin(), n, 0);
    std::fill_n(above_size.begin(), n, 0);
    return;
  }
  const LineAbove above{line.above_first, line.above_end, deviation.data(), u.data(), size.data()};
  const std::int16_t* const w = weights.data() + kLineWeights;
  // Ends of lines are vertices, so the chord has a point on either side of every point that is asked for.
  const PointIndex from = line.first + 1;
  const PointIndex to = line.end - 1;
  const auto taps_at = [&](std::int64_t j) { return kernels::Above{above.deviation + j, above.value + j, above.size + j}; };
  if (line.straight) {
    const auto inside = [&](std::int64_t i) { return static_cast<PointIndex>(std::clamp<std::int64_t>(i, from, to)); };
    const PointIndex left = inside(std::int64_t{above.first} + 1 - line.shift);
    const PointIndex right = std::max(left, inside(std::int64_t{above.end} - 1 - line.shift));
    const auto at_end = [&](PointIndex i) {
      weigh_beside(w, above, neighbours.of(line, i), above_sum[i - line.first], above_size[i - line.first]);
    };
    for (PointIndex i = from; i < left; ++i) at_end(i);
    for (PointIndex i = right; i < to; ++i) at_end(i);
    const std::size_t begin = left - line.first;
    kernels::weigh_beside(w, taps_at(left + line.shift), above_sum.data() + begin, above_size.data() + begin, right - left);
  } else {
    weigh_all_beside(w, above);
    const PointIndex* const beside = neighbours.beside.data() + line.first;
    for (std::size_t i = 1; i + 1 < n; ++i) {
      const std::size_t j = beside[i] - above.first;
      above_sum[i] = beside_sum[j];
      above_size[i] = beside_size[j];
    }
  }
  kernels::weigh_chord(w + kBeside, chord.data() + from, above_sum.data() + 1, to - from);
}

void RestAxis::weigh_all_beside(const std::int16_t* weights, const LineAbove& above) {
  const std::size_t n = above.end - above.first;
  if (beside_sum.size() < n) {
    beside_sum.resize(n);
    beside_size.resize(n);
  }
  if (n > 2) {
    const kernels::Above taps{above.deviation + above.first + 1, above.value + above.first + 1, above.size + above.first + 1};
    kernels::weigh_beside(weights, taps, beside_sum.data() + 1, beside_size.data() + 1, n - 2);
  }
  weigh_beside(weights, above, above.first, beside_sum.front(), beside_size.front());
  weigh_beside(weights, above, above.end - 1, beside_sum[n - 1], beside_size[n - 1]);
}

std::array<std::int32_t, kWeights> deviations_of(const RestAxis& axis, std::span<const std::int32_t> u,
                                                 const Neighbours& neighbours, const RestLine& line, PointIndex run_first,
                                                 PointIndex i) noexcept {
  std::array<std::int32_t, kWeights> d{};
  const std::int32_t* const deviation = axis.deviation.data();
  for (std::size_t k = 0; k < std::min<std::size_t>(kLeft, i - run_first); ++k) d[k] = deviation[i - k - 1];
  for (std::size_t k = 0; k < kMeans; ++k) d[kLeft + k] = axis.means[k][i] + RunningMeans::kLess[k];
  if (!line.has_above) return d;
  const std::int64_t j = neighbours.of(line, i);
  const std::int32_t* const chord = axis.chord.data() + i - 1;
  const auto put = [&](std::size_t k, std::int64_t p) {
    d[kLineWeights + k] = deviation[p];
    d[kLineWeights + kBeside + k] = wrap(std::int64_t{u[static_cast<std::size_t>(p)]} - chord[k]);
  };
  if (j > line.above_first && j + 1 < line.above_end) {
    for (std::size_t k = 0; k < kBeside; ++k) put(k, j + static_cast<std::int64_t>(k) - 1);
    return d;
  }
  for (std::size_t k = 0; k < kBeside; ++k)
    put(k, std::clamp<std::int64_t>(j + static_cast<std::int64_t>(k) - 1, line.above_first, line.above_end - 1));
  return d;
}

} // namespace scansion
