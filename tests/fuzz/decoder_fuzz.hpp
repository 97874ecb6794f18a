// Feeds a decoder any bytes in pieces and looks at what every decoder promises.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/port/decoder.hpp"

#include <cstdlib>

namespace scansion::test {

/// `replied` is called at each reply; false ends the run. `most_points`: of a line.
template <class Replied>
void feed(Decoder& decoder, const LinkCounters& counters, std::span<const std::uint8_t> rest, std::size_t piece,
          std::size_t most_points, Replied replied) {
  LineBuffer line;
  Gap gap;
  Moment at;
  while (!rest.empty()) {
    auto bytes = rest.first(std::min(piece, rest.size()));
    rest = rest.subspan(bytes.size());
    at.monotonic_ns += 1'000'000;
    for (;;) {
      const auto step = decoder.decode(bytes, at, line, gap);
      if (step.used > bytes.size()) std::abort();
      bytes = bytes.subspan(step.used);
      if (step.what == Decoded::more) break;
      if (step.what == Decoded::reply && !replied()) return;
      if (step.what == Decoded::line) {
        std::size_t points = 0;
        for (const Run& run : line.runs) {
          if (run.count == 0 || run.first != points) std::abort();
          points += run.count;
        }
        if (points != line.points() || points != line.xyz[2].size() || points > most_points ||
            (points > 0 && counters.accepted == 0))
          std::abort();
      }
      line.clear();
    }
    if (!bytes.empty()) std::abort();
  }
}

} // namespace scansion::test
