// CCSDS 121 adaptive entropy coding by libaec.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/packers.hpp"

#ifdef SCANSION_BENCH_AEC

#include <libaec.h>

namespace scansion::bench {
namespace {

std::uint64_t encode(const std::vector<std::int32_t>& axis, std::int64_t unit) {
  // Differences below 2^32 fit for every unit above 1; with unit 1 the counts are taken as they are.
  std::vector<std::int32_t> samples = axis;
  if (unit > 1)
    for (std::int32_t& v : samples) v = static_cast<std::int32_t>((std::int64_t{v} - axis.front()) / unit);
  std::vector<unsigned char> out(8 * samples.size() + 4096);
  aec_stream stream{};
  stream.bits_per_sample = 32;
  stream.block_size = 16;
  stream.rsi = 128;
  stream.flags = AEC_DATA_SIGNED | AEC_DATA_PREPROCESS;
  stream.next_in = reinterpret_cast<const unsigned char*>(samples.data());
  stream.avail_in = 4 * samples.size();
  stream.next_out = out.data();
  stream.avail_out = out.size();
  return aec_buffer_encode(&stream) == AEC_OK ? stream.total_out : 0;
}

} // namespace

Packed pack_aec(const Groups& groups) {
  Packed packed;
  for (const LineGroup& group : groups) {
    const Shape shape = shape_of(group);
    packed.bytes += shape.bytes;
    if (!group.ulp[0].empty()) return {0, "IEEE bits"};
    for (std::size_t a = 0; a < 3; ++a) {
      if (shape.regular[a]) continue;
      const std::uint64_t bytes = encode(group.xyz[a], shape.unit[a]);
      if (bytes == 0) return {0, "encoder failed"};
      packed.bytes += bytes;
    }
  }
  return packed;
}

} // namespace scansion::bench

#else

namespace scansion::bench {

Packed pack_aec(const Groups& /*groups*/) {
  return {0, "not built: libaec-dev"};
}

} // namespace scansion::bench

#endif
