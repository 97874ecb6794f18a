// The points that a level keeps, as anybody would store polylines: differences of indexes and values, packed by xz.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/varint.hpp"
#include "tests/bench/packers.hpp"
#include "tests/bench/process.hpp"
#include "tests/bench/scratch.hpp"

namespace scansion::bench {
namespace {

/// Bytes of a kind stand together: indexes, then the values of each axis that is not regular.
struct Streams {
  std::array<std::int64_t, 3> first{}; ///< of the run before
  Bytes indexes;
  std::array<Bytes, 3> values;
};

void put_run(const LineGroup& group, const GroupRanks& ranks, const Run& run, double tolerance_mm, const Shape& shape,
             Streams& to) {
  std::uint32_t at = run.first;
  std::array<std::int64_t, 3> before = to.first;
  for (std::size_t a = 0; a < 3; ++a) to.first[a] = group.xyz[a][run.first];
  for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
    if (ranks.distance[i] <= tolerance_mm) continue;
    put_varint(to.indexes, i - at);
    at = i;
    for (std::size_t a = 0; a < 3; ++a) {
      if (shape.regular[a]) continue;
      put_signed(to.values[a], group.xyz[a][i] - before[a]);
      before[a] = group.xyz[a][i];
    }
  }
}

} // namespace

Packed pack_kept_xz(const Groups& groups, std::span<const GroupRanks> ranks, double tolerance_mm) {
  Streams streams;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Shape shape = shape_of(groups[g]);
    for (const Run& run : groups[g].runs) put_run(groups[g], ranks[g], run, tolerance_mm, shape, streams);
  }
  std::string all;
  for (const Bytes* stream : {&streams.indexes, &streams.values[0], &streams.values[1], &streams.values[2]})
    all.append(reinterpret_cast<const char*>(stream->data()), stream->size());
  const ScratchFolder folder;
  const std::string file = folder.file("kept");
  if (!write_file(file, all)) return {0, "no room"};
  const Ended ended = run_program({"xz", "-9e", "-c", file});
  if (ended.status != 0) return {0, "not found: xz"};
  return {ended.out.size(), {}};
}

} // namespace scansion::bench
