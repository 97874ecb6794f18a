// An axis of the rest as byte planes.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/plain_axis.hpp"

#include <algorithm>

namespace scansion {
namespace {

constexpr std::size_t kPart = 1024; // points of a group that say whether to try all
constexpr std::size_t kStretches = 4;

} // namespace

// The first residuals of a mode, from the first vertex on, which lies in the first run; as many as there are and `to` holds.
std::size_t PlainAxis::take(std::span<const Run> runs, std::span<const PointIndex> vertices, std::span<const std::int32_t> u,
                            RestMode mode, std::span<std::int64_t> residuals) noexcept {
  std::int64_t* to = residuals.data();
  const std::int64_t* const end = to + residuals.size();
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
      if (to == end) return residuals.size();
    }
    ++v;
  }
  return static_cast<std::size_t>(to - residuals.data());
}

// Residuals of the first points of a small group, where lines that repeat each other must both be seen; of a large one from
// several places: its first lines may be unlike the others.
void PlainAxis::take_part(std::span<const Run> runs, std::span<const PointIndex> vertices, std::span<const std::int32_t> u,
                          RestMode mode, std::size_t most) {
  const std::size_t stretches = most < kPart ? 1 : kStretches;
  grow(memory_, most);
  std::size_t taken = 0;
  for (std::size_t s = 0; s < stretches; ++s) {
    const auto near = static_cast<PointIndex>(stretches == 1 ? 0 : (2 * s + 1) * u.size() / (2 * stretches));
    const auto begin = std::ranges::lower_bound(vertices, near);
    if (begin == vertices.end()) break;
    const auto run = std::ranges::upper_bound(runs, *begin, {}, &Run::first) - 1;
    taken += take({run, runs.end()}, {begin, vertices.end()}, u, mode,
                  std::span(memory_).subspan(taken, most * (s + 1) / stretches - taken));
  }
  residuals_ = std::span(memory_).first(taken);
}

// About how many bits the residuals are of.
std::uint64_t PlainAxis::bits() const noexcept {
  std::uint64_t bits = 0;
  for (const std::int64_t residual : residuals_) bits += log2_fixed(fold(static_cast<std::int32_t>(residual)) / 2 + 1);
  return bits;
}

void PlainAxis::put(RestMode mode, PlaneWriter& planes) {
  bytes_.assign(1, static_cast<std::byte>(mode));
  planes.put_planes(bytes_, residuals_, PlaneWriter::Effort::quick);
}

bool PlainAxis::find(std::span<const Run> runs, std::span<const PointIndex> vertices, std::span<const std::int32_t> u,
                     std::size_t limit, PlaneWriter& planes) {
  const std::size_t all = u.size() - vertices.size();
  if (limit < all / 16) return false; // next to nothing
  const std::size_t part = std::min(all, std::max<std::size_t>(256, std::min(kPart, all / 16)));
  take_part(runs, vertices, u, RestMode::left, part);
  const std::uint64_t left_bits = bits();
  take_part(runs, vertices, u, RestMode::slope, part);
  const RestMode best = bits() < left_bits ? RestMode::slope : RestMode::left;
  if (best == RestMode::left) take_part(runs, vertices, u, best, part);
  put(best, planes);
  const std::size_t taken = residuals_.size();
  // A part does not repeat itself as much as the whole does, least of all a small one.
  const std::size_t slack = limit * taken / (part < kPart ? 6 : 8);
  if (bytes_.size() * all > limit * taken + slack) return false;
  grow(memory_, all);
  residuals_ = std::span(memory_).first(take(runs, vertices, u, best, std::span(memory_).first(all)));
  put(best, planes);
  return bytes_.size() < limit;
}

} // namespace scansion
