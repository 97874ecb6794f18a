// Which points of each run belong to a level.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/positions.hpp"

#include "pipeline/codec/codec.hpp"

namespace scansion {
namespace {

constexpr std::size_t kMaxVarint32 = 5;

// Inner points of a run as a half-open range.
struct Inner {
  PointIndex first, end;
};
Inner inner(const Run& run) noexcept {
  return run.count < 3 ? Inner{run.first, run.first} : Inner{run.first + 1, run.first + run.count - 1};
}

} // namespace

void write_positions(std::span<const Run> runs, std::span<const std::uint8_t> width, std::uint8_t level, PlaneWriter& planes,
                     Bytes& to) {
  Bytes counts;
  Bytes skips;
  for (const Run& run : runs) {
    std::uint64_t count = 0;
    std::uint64_t skip = 0;
    const Inner range = inner(run);
    for (PointIndex i = range.first; i < range.end; ++i) {
      if (width[i] == level) {
        put_varint(skips, skip);
        skip = 0;
        ++count;
      } else if (width[i] > level) {
        ++skip;
      }
    }
    put_varint(counts, count);
  }
  planes.put_blob(to, counts);
  planes.put_blob(to, skips);
}

Result<void> read_positions(ByteReader& from, std::span<const Run> runs, std::span<std::uint8_t> width, std::uint8_t level,
                            std::size_t count, PlaneReader& planes, std::vector<PointIndex>& fresh) {
  Bytes counts;
  Bytes skips;
  SCANSION_TRY(planes.get_blob(from, runs.size() * kMaxVarint32, counts));
  SCANSION_TRY(planes.get_blob(from, count * kMaxVarint32, skips));
  ByteReader count_of(counts);
  ByteReader skip_of(skips);
  fresh.clear();
  const auto take = [&](PointIndex i) {
    width[i] = level;
    fresh.push_back(i);
  };
  for (const Run& run : runs) {
    if (level == 0) take(run.first);
    const Inner range = inner(run);
    PointIndex i = range.first;
    for (std::uint64_t left = count_of.varint(); left > 0; --left) {
      std::uint64_t skip = skip_of.varint();
      while (i < range.end && (width[i] != DecodedGroup::kUnknown || skip-- > 0)) ++i;
      if (i >= range.end || !skip_of.ok()) return fail(Errc::damaged, "a level names points that its runs do not have");
      take(i++);
    }
    if (level == 0 && run.count > 1) take(run.first + run.count - 1);
  }
  if (!count_of.at_end() || !skip_of.at_end() || fresh.size() != count)
    return fail(Errc::damaged, "a level and its header disagree on the number of points");
  return success();
}

} // namespace scansion
