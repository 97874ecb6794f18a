// The complete Douglas-Peucker rearrangement of one run: distances, depths, order (paper, section 3, made exact).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/lattice.hpp"
#include "pipeline/model/scan_line.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace scansion {

/// The points of one run, as counts. Any 32 bit values; runs that span less than 2^25 counts are fastest.
struct RunPoints {
  std::span<const std::int32_t> x, y, z;
  /// Index of each point in its whole run, ascending, when the points are a subset of it (the tie rule looks at these);
  /// empty: 0, 1, 2, ...
  std::span<const std::uint32_t> position;

  [[nodiscard]] std::size_t size() const noexcept { return x.size(); }
};

/// Which code ranks; all give the same results.
enum class RankUnit : std::uint8_t {
  one_by_one, ///< point after point; what subsets of runs always take
  portable,
  avx2,
  avx512,
  automatic ///< the fastest one the processor has for the number of points
};
[[nodiscard]] bool has_rank_unit(RankUnit unit) noexcept;
/// `wanted`, or what automatic means for a job of so many points.
[[nodiscard]] RankUnit unit_for(RankUnit wanted, std::size_t points) noexcept;

/// Ranks runs. Holds scratch memory, so one object serves one thread and allocates nothing in the steady state.
///
/// Distance is that of a point to the segment of its current chord. The split goes to the farthest point; ties to the point
/// closest to the middle of the interval, then to the smaller index, decided on exact integers. D = min(split distance, D of
/// the parent). In mm, D = sqrt(RN(K) / RN(L)) * num / den, in double, each operation rounded once, where K / L is the exact
/// squared distance in counts (see squared_distance) and num / den the resolution.
class Ranker {
public:
  /// `unit` must be one that the processor has. Intervals whose farthest point is at `floor_counts` or nearer are not split:
  /// all their inner points get the distance and depth that this point would have, and so stand in order of index. 0: every
  /// interval is split.
  explicit Ranker(Rational resolution_mm, RankUnit unit = RankUnit::automatic, double floor_counts = 0.0);
  ~Ranker();
  Ranker(Ranker&&) noexcept;
  Ranker& operator=(Ranker&&) noexcept;

  /// Fills distance (mm; end points +infinity) and depth in the split tree (end points 0, first split 1). Both have
  /// run.size() elements. When the points are a subset of a run (RunPoints::position) that is closed under the tree, the
  /// values are those of the whole run.
  void rank(const RunPoints& run, std::span<double> distance, std::span<std::uint32_t> depth);

  /// The same for all runs of a group, whose points follow each other in `xyz`.
  void rank(const std::array<std::span<const std::int32_t>, 3>& xyz, std::span<const Run> runs, std::span<double> distance,
            std::span<std::uint32_t> depth);

  [[nodiscard]] Rational resolution() const noexcept { return resolution_; }
  void set_floor(double floor_counts) noexcept { squared_floor_ = floor_counts * floor_counts; }

private:
  struct Scratch;
  void rank_by_vectors(const RunPoints& points, std::span<double> distance, std::span<std::uint32_t> depth);
  void rank_one_by_one(const RunPoints& run, std::span<double> distance, std::span<std::uint32_t> depth);

  Rational resolution_;
  RankUnit wanted_;
  double squared_floor_; ///< counts
  std::unique_ptr<Scratch> scratch_;
};

/// Orders ranked points. Holds scratch memory: one object, one thread.
class RankSorter {
public:
  explicit RankSorter(RankUnit unit = RankUnit::automatic);
  /// The rearrangement j: end points 0 and n first, then by distance descending, depth ascending, index ascending. So any
  /// prefix is a state of the algorithm.
  void sort(std::span<const double> distance, std::span<const std::uint32_t> depth, std::vector<std::uint32_t>& order);

private:
  RankUnit wanted_;
  std::vector<std::uint64_t> keys_, sorted_;
  std::vector<std::uint32_t> digits_, counts_;
};

/// Exact distance in mm of point p to the segment a-b, by the one formula of the Ranker.
[[nodiscard]] double segment_distance(const RunPoints& run, std::size_t p, std::size_t a, std::size_t b, Rational resolution);

} // namespace scansion
