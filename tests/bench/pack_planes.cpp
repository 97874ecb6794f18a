// Delta, zigzag, byte planes, zstd -3: what an experienced programmer writes in an afternoon.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/packers.hpp"

#include <algorithm>
#include <numeric>
#include <zstd.h>

namespace scansion::bench {
namespace {

template <class T>
bool is_regular(const LineGroup& group, const std::vector<T>& axis) {
  return std::ranges::all_of(group.runs, [&](const Run& run) {
    for (std::uint32_t k = run.first + 2; k < run.first + run.count; ++k)
      if (std::int64_t{axis[k]} - axis[k - 1] != std::int64_t{axis[k - 1]} - axis[k - 2]) return false;
    return true;
  });
}

std::int64_t unit_of(const std::vector<std::int32_t>& axis) {
  std::int64_t unit = 0;
  for (const std::int32_t v : axis) unit = std::gcd(unit, std::int64_t{v} - axis.front());
  return std::max<std::int64_t>(unit, 1);
}

/// Differences along each run, and from first point to first point of runs.
template <class T>
std::vector<std::int64_t> deltas_of(const LineGroup& group, const std::vector<T>& axis) {
  std::vector<std::int64_t> deltas;
  deltas.reserve(axis.size());
  std::int64_t first = 0;
  for (const Run& run : group.runs) {
    std::int64_t before = first;
    first = axis[run.first];
    for (std::uint32_t k = run.first; k < run.first + run.count; ++k) {
      deltas.push_back(axis[k] - before);
      before = axis[k];
    }
  }
  return deltas;
}

} // namespace

std::uint64_t planes_bytes(std::span<const std::int64_t> values) {
  std::vector<std::uint64_t> folded;
  folded.reserve(values.size());
  std::uint64_t largest = 0;
  for (const std::int64_t v : values) {
    folded.push_back((static_cast<std::uint64_t>(v) << 1U) ^ static_cast<std::uint64_t>(v >> 63U));
    largest |= folded.back();
  }
  std::string planes;
  for (unsigned shift = 0; shift < 64 && (largest >> shift) != 0; shift += 8)
    for (const std::uint64_t v : folded) planes.push_back(static_cast<char>(v >> shift & 0xFFU));
  std::string out(ZSTD_compressBound(planes.size()), '\0');
  return 1 + ZSTD_compress(out.data(), out.size(), planes.data(), planes.size(), 3); // and the number of planes
}

Shape shape_of(const LineGroup& group) {
  Shape shape;
  std::vector<std::int64_t> side;
  const auto put = [&](auto value_of_run) {
    std::int64_t before = 0;
    for (const Run& run : group.runs) {
      const std::int64_t value = value_of_run(run);
      side.push_back(value - before);
      before = value;
    }
  };
  put([](const Run& run) { return std::int64_t{run.count}; });
  for (const ScanLine& line : group.lines) side.push_back(std::int64_t{line.run_count} - 1);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto& axis = group.xyz[a];
    shape.regular[a] = is_regular(group, axis);
    shape.unit[a] = unit_of(axis);
    side.push_back(shape.unit[a]);
    if (!shape.regular[a]) continue;
    put([&](const Run& run) { return std::int64_t{axis[run.first]}; });
    put([&](const Run& run) { return run.count < 2 ? 0 : std::int64_t{axis[run.first + 1]} - axis[run.first]; });
  }
  shape.bytes = planes_bytes(side);
  return shape;
}

Packed pack_planes(const Groups& groups) {
  Packed packed;
  for (const LineGroup& group : groups) {
    const Shape shape = shape_of(group);
    packed.bytes += shape.bytes;
    for (std::size_t a = 0; a < 3; ++a)
      if (!shape.regular[a]) packed.bytes += planes_bytes(deltas_of(group, group.xyz[a]));
    for (const auto& axis : group.ulp)
      if (!axis.empty()) packed.bytes += planes_bytes(deltas_of(group, axis));
  }
  return packed;
}

} // namespace scansion::bench
