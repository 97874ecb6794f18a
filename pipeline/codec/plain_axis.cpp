// An axis of the rest as byte planes.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/plain_axis.hpp"

#include <algorithm>

namespace scansion {

// The first residuals of a mode.
void PlainAxis::take(std::span<const Run> runs, std::span<const PointIndex> vertices, std::span<const std::int32_t> u,
                     RestMode mode, std::size_t most) {
  grow(memory_, most);
  residuals_ = std::span(memory_).first(most);
  std::int64_t* to = memory_.data();
  const std::int64_t* const end = to + most;
  const std::int32_t* const values = u.data();
  std::size_t v = 0;
  for (const Run& run : runs) {
    const PointIndex last = run.first + run.count - 1;
    for (; vertices[v] != last; ++v) {
      PointIndex i = vertices[v] + 1;
      const PointIndex stop = std::min(vertices[v + 1], i + static_cast<PointIndex>(end - to));
      // The second point of a run has but one before it.
      if (i < stop && (mode == RestMode::left || i == run.first + 1)) {
        const PointIndex left_stop = mode == RestMode::left ? stop : i + 1;
        for (; i < left_stop; ++i) *to++ = wrap(std::int64_t{values[i]} - values[i - 1]);
      }
      for (; i < stop; ++i) *to++ = wrap(std::int64_t{values[i]} - wrap(2 * std::int64_t{values[i - 1]} - values[i - 2]));
      if (to == end) return;
    }
    ++v;
  }
}

// About how many bits the residuals are of.
std::uint64_t PlainAxis::bits() const noexcept {
  std::uint64_t bits = 0;
  for (const std::int64_t residual : residuals_) bits += log2_fixed(fold(static_cast<std::int32_t>(residual)) / 2 + 1);
  return bits;
}

void PlainAxis::put(RestMode mode, PlaneWriter& planes) {
  bytes_.assign(1, static_cast<std::byte>(mode));
  planes.put_planes(bytes_, residuals_);
}

bool PlainAxis::find(std::span<const Run> runs, std::span<const PointIndex> vertices, std::span<const std::int32_t> u,
                     std::size_t limit, PlaneWriter& planes) {
  constexpr std::size_t kPart = 1024;
  const std::size_t all = u.size() - vertices.size();
  if (limit < all / 16) return false; // next to nothing
  const std::size_t part = std::min(all, std::max<std::size_t>(256, std::min(kPart, all / 16)));
  take(runs, vertices, u, RestMode::left, part);
  const std::uint64_t left_bits = bits();
  take(runs, vertices, u, RestMode::slope, part);
  const RestMode best = bits() < left_bits ? RestMode::slope : RestMode::left;
  if (best == RestMode::left) take(runs, vertices, u, best, part);
  put(best, planes);
  if (bytes_.size() * all > limit * part + limit * part / 8) return false;
  take(runs, vertices, u, best, all);
  put(best, planes);
  return bytes_.size() < limit;
}

} // namespace scansion
