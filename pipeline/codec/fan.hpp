// Sensors that turn: every point lies on one of a few directions from the origin, at a whole number of range steps. Two axes of
// such a group hold range and direction in place of the coordinates (docs/FORMAT.md, "Fans").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/varint.hpp"
#include "pipeline/model/scan_line.hpp"

#include <array>
#include <span>
#include <vector>

namespace scansion {

inline constexpr std::size_t kMaxDirections = 1U << 16U;

struct Fan {
  std::size_t range_axis = 0;     ///< the axis that holds ranges; its coordinate comes from the first part of a direction
  std::size_t direction_axis = 1; ///< the axis that holds indexes of directions
  unsigned shift = 0;
  std::int64_t turn = 0;                               ///< 2^31 times the cosine of the usual angle between directions
  std::vector<std::array<std::int64_t, 2>> directions; ///< counts a range step, in units of 2^-shift

  [[nodiscard]] bool empty() const noexcept { return directions.empty(); }
  void clear() noexcept { directions.clear(); }
  /// Coordinate `part` (0: of the range axis) of a range on a direction, which must exist.
  [[nodiscard]] std::int32_t coordinate(std::size_t part, std::int32_t direction, std::int32_t range) const noexcept {
    const auto product = static_cast<std::uint64_t>(directions[static_cast<std::size_t>(direction)][part]) *
                         static_cast<std::uint64_t>(std::int64_t{range});
    const std::uint64_t half = (std::uint64_t{1} << shift) >> 1U;
    return static_cast<std::int32_t>(static_cast<std::int64_t>(product + half) >> shift);
  }
};

/// Looks for a fan in a group. One object, one thread; memory is used again.
class FanFinder {
public:
  /// Fills `fan` and, per point, its range and direction; leaves `fan` empty when the points are no fan.
  void find(std::span<const std::int32_t> x, std::span<const std::int32_t> y, Fan& fan);

  std::vector<std::int32_t> ranges, directions;
  std::array<std::vector<std::int32_t>, 2> off; ///< per part: by how much each point lies beside what range and direction say
  std::array<bool, 2> exact{};                  ///< per part: all points come out right

private:
  struct Point {
    double turn; ///< grows with the angle
    double size;
    std::uint32_t index;
  };
  /// An end of a stretch of angles.
  struct End {
    double turn, size;
  };
  struct Bucket {
    End low{3, 0}, high{-3, 0}; ///< of the points in it, the outermost ones
    End longest{0, 0};
    std::int32_t direction = 0;
  };
  struct Between {
    double low = -1e300, high = 1e300;
    double best = 0; ///< what the farthest point says alone
  };
  struct Vector {
    std::array<Between, 2> parts;
    std::int32_t best_range = 0;
  };
  [[nodiscard]] static bool are_apart(const End& a, const End& b) noexcept;
  [[nodiscard]] bool cut_by_buckets();
  void cut_sorted();
  [[nodiscard]] bool sort_out(std::span<const std::int32_t> x, std::span<const std::int32_t> y);
  void sort_by_angle();
  [[nodiscard]] bool fit(std::span<const std::int32_t> x, std::span<const std::int32_t> y, Fan& fan);

  void find_turn(Fan& fan);

  double step_ = 0; ///< counts a range step
  std::vector<double> turns_;
  std::vector<Point> points_, by_index_;
  std::vector<std::uint64_t> keys_, sorted_keys_; ///< angle, then index
  std::vector<std::uint32_t> bucket_at_;          ///< by angle: which of
  std::vector<Bucket> buckets_;
  std::vector<Vector> vectors_; ///< per direction
  std::size_t count_ = 0;       ///< of directions
};

void write_fan(const Fan& fan, Bytes& to);
/// `limit`: the most directions it may have.
[[nodiscard]] Result<void> read_fan(ByteReader& from, std::size_t limit, Fan& fan);

} // namespace scansion
