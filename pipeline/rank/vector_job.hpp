// What the vector kernels get and give: plain pointers, so that a unit compiled for a newer processor shares no inline code.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace scansion {

/// The chord from point a to point b; its inner points are to be ranked.
struct Interval {
  std::uint32_t a, b;
};

/// An interval that waits for its split. Its level in the tree is kept where its end follows from the class it waits in.
struct Waiting {
  std::uint32_t a;
  union {
    std::uint32_t level; ///< depth of the point that will split it
    std::uint32_t b;
  };
  double bound; ///< squared distance of the point that split its parent
};

/// The farthest inner point of an interval and its exact squared distance in counts, as two nearest doubles.
struct Found {
  std::uint32_t index;
  double numerator, denominator;
};

/// Vector loads read up to this many elements past the last point.
inline constexpr std::size_t kVectorPad = 64;
/// Spans below this keep every squared distance in 128 bits.
inline constexpr std::uint32_t kNarrowSpan = 1U << 30U;
/// Distances to chords measured per point before the work guard takes over, and the shortest interval it is worth its price
/// for.
inline constexpr std::uint64_t kGuardedWork = 48;
inline constexpr std::uint32_t kGuardedInner = 256;

/// Runs that follow each other, n points in all. Several short ones at once keep the batches full.
struct VectorJob {
  using Search = Found (*)(const VectorJob& job, std::uint32_t a, std::uint32_t b);

  const std::int32_t* axes[3]; ///< n coordinates in counts each
  std::uint32_t n;
  const Interval* runs; ///< first and last point of each
  std::uint32_t run_count;
  double scale_num, scale_den; ///< mm per count
  double squared_floor;        ///< counts; intervals that are no farther are not split

  double* distance;     ///< n, out: mm
  std::uint32_t* depth; ///< n, out

  // Scratch.
  std::int32_t* copies; ///< 3 * (n + kVectorPad)
  std::uint32_t* pairs; ///< n + kVectorPad
  std::uint32_t* reach; ///< n + kVectorPad
  Waiting* waiting;     ///< waiting_intervals(n)

  Search exact; ///< searches any interval, point after point
  /// The exact distance of point k of a run in space.
  Found (*measure)(const VectorJob& job, std::uint32_t a, std::uint32_t b, std::uint32_t k);
  Search guarded; ///< the same for long planar intervals once the work has passed its limit
  void* guard;    ///< for `guarded`

  // Set by rank_*: the coordinates to look at, padded.
  const std::int32_t* u = nullptr;
  const std::int32_t* v = nullptr;
  const std::int32_t* w = nullptr; ///< null: this axis is constant; it may be without being null
  bool wide = false;               ///< a span is kNarrowSpan or more
};

/// Short intervals have a class for each number of inner points up to this.
inline constexpr std::size_t kShortClasses = 14;
/// So many of one class wait at most: those that long intervals left since short ones were split last, in parts.
inline constexpr std::size_t kShortWaiting = std::size_t{1} << 15U;

[[nodiscard]] constexpr std::size_t waiting_intervals(std::size_t n) noexcept {
  // Up to 2 n long ones, by the least that each class has; n / k of k inner points, but short ones wait kShortWaiting at a time
  // at most.
  const std::size_t some = n / 2 * 7;
  return 2 * n + (some < kShortClasses * kShortWaiting ? some : kShortClasses * kShortWaiting) + 1024;
}

/// All give the same results.
void rank_portable(const VectorJob& job);
#if defined(__x86_64__)
void rank_avx2(const VectorJob& job);
void rank_avx512(const VectorJob& job);
#endif

} // namespace scansion
