// How the points that are in no level are predicted: from the polyline, the points to the left and, if that helps, the line
// before (docs/FORMAT.md, "Rest").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/group_state.hpp"

#include <algorithm>
#include <bit>
#include <cstdlib>

namespace scansion {

/// How one axis is predicted in the rest; stored in the payload.
enum class RestMode : std::uint8_t {
  fitted = 0, ///< chord + weighted deviations of neighbours
  left = 1,   ///< the value of the point before
  slope = 2,  ///< straight on from the two points before
  above = 3,  ///< the value of the point beside it in the line before
  line = 4,   ///< as fitted, without the line before
};
inline constexpr std::size_t kRestModes = 5;

/// Deviations that the fitted modes weigh: points to the left from their own chord and running means of them; points beside in
/// the line before from their own chord, and again from the chord here.
inline constexpr std::size_t kLeft = 6;
inline constexpr std::size_t kMeans = 2;
inline constexpr std::size_t kBeside = 3;
inline constexpr std::size_t kAcross = 3;
inline constexpr std::size_t kLineWeights = kLeft + kMeans;
inline constexpr std::size_t kWeights = kLineWeights + kBeside + kAcross;
inline constexpr unsigned kWeightBits = 12;
using Weights = std::array<std::int16_t, kWeights>; ///< in units of 2^-kWeightBits

inline constexpr std::uint32_t kLargestSize = 1U << 20U;
[[nodiscard]] inline std::int32_t size_of(std::int32_t residual) noexcept {
  const std::uint32_t size = residual < 0 ? 0U - static_cast<std::uint32_t>(residual) : static_cast<std::uint32_t>(residual);
  return static_cast<std::int32_t>(std::min(size, kLargestSize));
}

/// The same of a folded residual.
[[nodiscard]] inline std::int32_t size_of_folded(std::uint32_t folded) noexcept {
  return static_cast<std::int32_t>(std::min((folded >> 1U) + (folded & 1U), kLargestSize));
}

/// What stands for the size of a residual at a vertex: half of what the chord behind it rises in a sample.
[[nodiscard]] inline std::int32_t size_of_rise(std::int32_t rise) noexcept {
  return size_of(rise) >> 1;
}

/// Running means of deviations, fast and slow, in 2^-kMeanBits counts. The point just before is left out: it has a weight of
/// its own, and a decoder that has just got it need not wait for the means. They are kept less half of what rounding down takes
/// at most, which keeps them from lying that much too low.
struct RunningMeans {
  static constexpr unsigned kMeanBits = 4;
  static constexpr unsigned kFast = 3, kSlow = 5; ///< each point counts 2^-k
  static constexpr std::array<std::int32_t, kMeans> kLess{1 << (kFast - 1), 1 << (kSlow - 1)};
  std::int32_t fast = -kLess[0], slow = -kLess[1];

  /// What is added to a sum of weights times deviations before it is shifted: to round, and what the means are kept less.
  [[nodiscard]] static std::int64_t rounding(const Weights& w) noexcept {
    return (std::int64_t{1} << (kWeightBits - 1)) + std::int64_t{w[kLeft]} * kLess[0] + std::int64_t{w[kLeft + 1]} * kLess[1];
  }

  void add(std::int32_t deviation) noexcept {
    fast = toward(fast, kFast);
    slow = toward(slow, kSlow);
    before_ = deviation;
  }
  /// Adds several, and writes what each of them finds.
  void pass(const std::int32_t* __restrict deviation, std::int32_t* __restrict fasts, std::int32_t* __restrict slows,
            std::size_t n) noexcept {
    RunningMeans now = *this; // in registers
    for (std::size_t i = 0; i < n; ++i) {
      fasts[i] = now.fast;
      slows[i] = now.slow;
      now.add(deviation[i]);
    }
    *this = now;
  }

private:
  [[nodiscard]] std::int32_t toward(std::int32_t mean, unsigned share) const noexcept {
    const std::uint32_t from = static_cast<std::uint32_t>(before_) << kMeanBits;
    const auto way = static_cast<std::int32_t>(from - static_cast<std::uint32_t>(mean));
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(mean) + static_cast<std::uint32_t>(way >> share));
  }
  std::int32_t before_ = 0;
};

/// What residuals nearby say about the size of the next: `size2` and `size3` are two and three points to the left. The one just
/// before is left out, so that a decoder can look up the table in time.
[[nodiscard]] inline std::uint32_t rest_doubt(std::int32_t size2, std::int32_t size3, std::int32_t beside,
                                              bool has_above) noexcept {
  const auto left = static_cast<std::uint32_t>(2 * std::max(size2, size3) + size2 + size3);
  return (has_above ? left + static_cast<std::uint32_t>(beside) : 2 * left) + 1;
}
/// Context of a residual: the logarithm of that, in half octaves. `doubt` is not 0.
[[nodiscard]] inline std::uint32_t rest_context(std::uint32_t doubt) noexcept {
  const auto octave = static_cast<std::uint32_t>(std::bit_width(doubt)) - 1;
  return 2 * octave + ((2 * doubt >> octave) & 1U); // NOLINT(clang-analyzer-core.UndefinedBinaryOperatorResult)
}

/// The chord from vertex a to the next one, b. Points on it are sums of one step, rounded down.
struct Chord {
  static constexpr unsigned kStepBits = 16;
  std::int64_t step; ///< from sample to sample, in 2^-kStepBits
  Chord(std::span<const std::int32_t> u, PointIndex a, PointIndex b) noexcept {
    const std::int64_t rise = (std::int64_t{u[b]} - u[a]) * (std::int64_t{1} << kStepBits);
    const std::int64_t samples = b - a;
    step = rise / samples - (rise % samples < 0 ? 1 : 0);
  }
  [[nodiscard]] std::int32_t rise() const noexcept { return wrap(step >> kStepBits); }
};

/// Writes the polyline through the values at `vertices` (first and last point of every run among them) into `chord`.
void fill_chord(std::span<const PointIndex> vertices, std::span<const std::int32_t> u, std::span<std::int32_t> chord) noexcept;

/// A line with points, and the last one before it that has some.
struct RestLine {
  PointIndex first = 0, end = 0;
  bool has_above = false;
  PointIndex above_first = 0, above_end = 0;
  bool straight = false; ///< the neighbour of point i is i + shift, held at the ends of the line before
  std::int64_t shift = 0;
};

/// The lines of a group and, for each point, its neighbour in the line before: the one whose chord is nearest on the axis along
/// which lines run, found by walking on from the last one.
struct Neighbours {
  std::vector<RestLine> lines;
  std::vector<PointIndex> beside; ///< per point; of straight lines and the first nothing is said

  /// `main`: the chord of that axis.
  void find(const LineGroup& group, const GroupState& state, const AxisScale& scale, std::span<const std::int32_t> main);
  [[nodiscard]] PointIndex of(const RestLine& line, PointIndex i) const noexcept {
    if (!line.straight) return beside[i];
    return static_cast<PointIndex>(std::clamp<std::int64_t>(i + line.shift, line.above_first, line.above_end - 1));
  }
};

/// One axis of a group in the rest, as far as it is known.
struct RestAxis {
  std::vector<std::int32_t> chord;
  std::vector<std::int32_t> deviation;                 ///< u - chord
  std::vector<std::int32_t> size;                      ///< of residuals; of the rise behind vertices
  std::array<std::vector<std::int32_t>, kMeans> means; ///< RunningMeans as each point finds them; the encoder's
  std::vector<std::int64_t> above_sum;                 ///< of the line at hand, by place in it
  std::vector<std::int32_t> above_size;
  std::vector<std::int64_t> beside_sum; ///< what each point of the line before adds for itself, scratch
  std::vector<std::int32_t> beside_size;
  std::vector<Chord> run_chords; ///< of the run at hand; the decoder's

  void make_room(std::size_t points) {
    grow(chord, points);
    grow(deviation, points);
    grow(size, points);
  }
  /// Fills chord, deviations and means, for the encoder, which has `u`.
  void fill(std::span<const Run> runs, std::span<const PointIndex> vertices, std::span<const std::int32_t> u);
  /// What the line before adds to the weighted sum of each point, and the sizes of residuals there.
  void weigh_above(const RestLine& line, const Neighbours& neighbours, std::span<const std::int32_t> u, const Weights& weights);

private:
  struct LineAbove;
  static void weigh_beside(const std::int16_t* weights, const LineAbove& above, std::int64_t j, std::int64_t& sum,
                           std::int32_t& size) noexcept;
  void weigh_all_beside(const std::int16_t* weights, const LineAbove& above);
};

/// The deviations of one point in the order of their weights.
[[nodiscard]] std::array<std::int32_t, kWeights> deviations_of(const RestAxis& axis, std::span<const std::int32_t> u,
                                                               const Neighbours& neighbours, const RestLine& line,
                                                               PointIndex run_first, PointIndex i) noexcept;

} // namespace scansion
