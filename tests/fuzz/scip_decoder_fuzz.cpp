// The SCIP decoder on any bytes, in pieces. First byte: mode, echoes, single scans, gap and size of the pieces.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/hokuyo-scip/scip_decoder.hpp"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace scansion;
  if (size < 1) return 0;
  LinkCounters counters;
  ScipDecoder decoder(counters);
  ScipDecoder::Expected expected;
  expected.sensor = {"UTM-30LX", 23, 60000, 1440, 0, 1080, 540, 2400};
  expected.plan = {"DSE"[data[0] % 3U], 540, 562, 1, 0};
  expected.plan.has_echoes = (data[0] & 0x40U) != 0;
  expected.plan.is_polled = (data[0] & 0x20U) != 0;
  expected.plan.echo = static_cast<scip::EchoChoice>(size % 3);
  expected.head = expected.plan.has_echoes ? "N" : "M";
  if (expected.plan.is_polled) expected.head = expected.plan.has_echoes ? "H" : "G";
  expected.head += expected.plan.kind;
  expected.head += expected.plan.is_polled ? "0540056200" : "05400562000";
  expected.tail = ";s1";
  expected.gap_mm = (data[0] & 0x80U) != 0 ? std::optional(20.0) : std::nullopt;
  decoder.expect(std::move(expected));
  const std::size_t piece = 1U + (data[0] >> 2U) % 32U;
  LineBuffer line;
  Gap gap;
  std::span<const std::uint8_t> rest(data + 1, size - 1);
  std::uint64_t lines = 0;
  while (!rest.empty()) {
    auto bytes = rest.first(std::min(piece, rest.size()));
    rest = rest.subspan(bytes.size());
    for (;;) {
      const auto step = decoder.decode(bytes, {}, line, gap);
      if (step.used > bytes.size()) std::abort();
      bytes = bytes.subspan(step.used);
      if (step.what == Decoded::more) break;
      if (step.what == Decoded::line) {
        std::size_t points = 0;
        for (const Run& run : line.runs) points += run.count;
        if (++lines > counters.accepted || points != line.points() || points > 23) std::abort();
      }
      line.clear();
    }
    if (!bytes.empty()) std::abort();
  }
  return 0;
}
