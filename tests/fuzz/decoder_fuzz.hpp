// Feeds a decoder any bytes in pieces and looks at what every decoder promises.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/port/decoder.hpp"

#include <cstdlib>
#include <utility>

namespace scansion::test {

/// Aborts unless the line is one that may be.
inline void check_line(const LineBuffer& line, const LinkCounters& counters, std::size_t most_points) {
  std::size_t points = 0;
  for (const Run& run : line.runs) {
    if (run.count == 0 || run.first != points) std::abort();
    points += run.count;
  }
  if (points != line.points() || points != line.xyz[2].size() || points > most_points || (points > 0 && counters.accepted == 0))
    std::abort();
}

/// `replied` is called at each reply; false ends the run. `most_points`: of a line. Sizes of odd pieces end in a loss.
template <class Replied>
void feed(Decoder& decoder, const LinkCounters& counters, std::span<const std::uint8_t> rest, std::size_t piece,
          std::size_t most_points, Replied replied) {
  LineBuffer line;
  Gap gap;
  Moment at;
  bool is_over = false;
  while (!std::exchange(is_over, rest.empty())) {
    auto bytes = rest.first(std::min(piece, rest.size()));
    rest = rest.subspan(bytes.size());
    at.monotonic_ns += 1'000'000;
    if (bytes.empty()) decoder.finish(at, piece % 2 != 0);
    for (;;) {
      const auto step = decoder.decode(bytes, at, line, gap);
      if (step.used > bytes.size()) std::abort();
      bytes = bytes.subspan(step.used);
      if (step.what == Decoded::more) break;
      if (step.what == Decoded::reply && !replied()) return;
      if (step.what == Decoded::line) check_line(line, counters, most_points);
      line.clear();
    }
    if (!bytes.empty()) std::abort();
  }
}

} // namespace scansion::test
