// Groups of lines as 16 bit grey images.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/packers.hpp"

#include <algorithm>
#include <limits>

namespace scansion::bench {
namespace {

constexpr std::int64_t kLargest = std::numeric_limits<std::uint16_t>::max();

using Rows = std::vector<std::span<const std::int32_t>>;

Rows rows_of(const LineGroup& group, std::size_t axis) {
  Rows rows;
  for (const ScanLine& line : group.lines) {
    const auto runs = group.runs_of(line);
    if (runs.empty()) continue;
    const std::size_t end = runs.back().first + runs.back().count;
    rows.push_back(std::span(group.xyz[axis]).subspan(runs.front().first, end - runs.front().first));
  }
  return rows;
}

/// What is taken off each row so that all of them fit; empty when they do not.
std::vector<std::int64_t> bases_of(const Rows& rows, std::int64_t unit) {
  const std::int64_t largest = kLargest * unit;
  std::vector<std::int64_t> bases;
  std::int64_t low = std::numeric_limits<std::int64_t>::max();
  std::int64_t high = std::numeric_limits<std::int64_t>::min();
  bool rows_fit = true;
  for (const auto& row : rows) {
    const auto [least, most] = std::ranges::minmax(row);
    bases.push_back(least);
    low = std::min(low, std::int64_t{least});
    high = std::max(high, std::int64_t{most});
    rows_fit = rows_fit && std::int64_t{most} - least <= largest;
  }
  if (high - low <= largest) return std::vector<std::int64_t>(rows.size(), low);
  return rows_fit ? bases : std::vector<std::int64_t>();
}

} // namespace

std::string images_of(const LineGroup& group, const Shape& shape, std::vector<Image>& images) {
  images.clear();
  if (!group.ulp[0].empty()) return "IEEE bits";
  for (std::size_t a = 0; a < 3; ++a) {
    if (shape.regular[a]) continue;
    const Rows rows = rows_of(group, a);
    const std::vector<std::int64_t> bases = bases_of(rows, shape.unit[a]);
    if (bases.empty()) return std::string(1, static_cast<char>('x' + a)) + " over 16 bit";
    Image& image = images.emplace_back();
    for (const auto& row : rows) image.width = std::max(image.width, static_cast<std::uint32_t>(row.size()));
    image.height = static_cast<std::uint32_t>(rows.size());
    for (std::size_t r = 0; r < rows.size(); ++r) {
      for (const std::int32_t v : rows[r]) image.pixels.push_back(static_cast<std::uint16_t>((v - bases[r]) / shape.unit[a]));
      image.pixels.resize((r + 1) * image.width, image.pixels.back());
    }
    std::vector<std::int64_t> steps = bases;
    for (std::size_t r = steps.size() - 1; r > 0; --r) steps[r] -= steps[r - 1];
    image.side_bytes = planes_bytes(steps);
  }
  return {};
}

Packed pack_images(const Groups& groups, std::uint64_t (*encode)(const Image&)) {
  Packed packed;
  std::vector<Image> images;
  for (const LineGroup& group : groups) {
    const Shape shape = shape_of(group);
    packed.bytes += shape.bytes;
    packed.skipped = images_of(group, shape, images);
    if (!packed.skipped.empty()) return packed;
    for (const Image& image : images) {
      const std::uint64_t bytes = encode(image);
      if (bytes == 0) {
        packed.skipped = "encoder failed";
        return packed;
      }
      packed.bytes += bytes + image.side_bytes;
    }
  }
  return packed;
}

} // namespace scansion::bench
