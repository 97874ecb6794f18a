// Random and adversarial runs and groups for property tests.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/scan_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace scansion::test {

using Random = std::mt19937_64;
using Coordinates = std::array<std::vector<std::int32_t>, 3>;

inline std::int64_t pick(Random& random, std::int64_t low, std::int64_t high) {
  return low + static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(high - low + 1));
}

/// How a run looks; every kind is made on purpose to hurt some rule of the ranking.
enum class Kind : int {
  cloud,       ///< points anywhere in space
  plane_cloud, ///< points anywhere in a plane y = const
  tiny_grid,   ///< a 3 x 3 x 3 grid: duplicates, folds and ties everywhere
  two_step,    ///< a plate that toggles between two sensor steps
  flat,        ///< all on one straight line
  zigzag,      ///< alternating, constant height
  growing,     ///< alternating, growing height: splits at the end
  square_wave, ///< steps with verticals
  steps_back,  ///< x runs back by many counts
  duplicates,  ///< the same point many times
  extremes,    ///< the corners of the largest span of the fast kernels
  wide,        ///< anywhere in 32 bits
  part,        ///< smooth surface with steps and noise
  tilted,      ///< a part in a leaning plane
  long_thin,   ///< planar, far longer than wide: fine counts; ties, folds and points beside the ends of chords
  digits,      ///< nearly all values are multiples of 1000: text with significant digits
  kinds
};

inline Coordinates make_run(Random& random, Kind kind, std::size_t n) {
  Coordinates c;
  const auto add = [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    c[0].push_back(static_cast<std::int32_t>(x));
    c[1].push_back(static_cast<std::int32_t>(y));
    c[2].push_back(static_cast<std::int32_t>(z));
  };
  constexpr std::int64_t kSpan = (std::int64_t{1} << 30) - 1;
  const std::int64_t pitch = pick(random, 1, 200);
  const std::int64_t height = pick(random, 1, 5000);
  const std::int64_t lean = pick(random, -3, 3);
  const std::int64_t long_step = std::min(pitch * 10000, kSpan / static_cast<std::int64_t>(n + 7));
  std::int64_t level = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const auto i = static_cast<std::int64_t>(k);
    switch (kind) {
      case Kind::cloud: add(pick(random, -1000, 1000), pick(random, -1000, 1000), pick(random, -1000, 1000)); break;
      case Kind::plane_cloud: add(pick(random, -50000, 50000), 7, pick(random, -50000, 50000)); break;
      case Kind::tiny_grid: add(pick(random, 0, 2), pick(random, 0, 2), pick(random, 0, 2)); break;
      case Kind::two_step: add(i * pitch, 0, static_cast<std::int64_t>(random() % 2)); break;
      case Kind::flat: add(i * pitch, i * lean, 3 * i); break;
      case Kind::zigzag: add(i * pitch, 0, (i % 2) * height); break;
      case Kind::growing: add(i * pitch, 0, (i % 2 == 0 ? 1 : -1) * i * height); break;
      case Kind::square_wave: add((i / 4) * pitch, 0, ((i / 2) % 2) * height); break;
      case Kind::steps_back: add(i * pitch - (i / 7) * 9 * pitch, 0, pick(random, 0, height)); break;
      case Kind::duplicates: add(i / 5 * pitch, 0, i / 5 % 3); break;
      case Kind::extremes: add((random() % 2) * kSpan, (random() % 2) * kSpan, (random() % 2) * kSpan); break;
      case Kind::wide:
        add(static_cast<std::int32_t>(random()),
            random() % 2 == 0 ? std::numeric_limits<std::int32_t>::min() : pick(random, -9, 9),
            random() % 2 == 0 ? std::numeric_limits<std::int32_t>::max() : static_cast<std::int32_t>(random()));
        break;
      case Kind::long_thin: {
        const std::int64_t x = (i - (random() % 16 == 0 ? pick(random, 0, 6) : 0)) * long_step;
        add(random() % 4 == 0 ? x + pick(random, -3, 3) : x, 5, pick(random, 0, 4) * height * (random() % 32 == 0 ? 300 : 1));
        break;
      }
      case Kind::digits: {
        const std::int64_t z = 1000 * pick(random, -200000, 200000);
        add(i * 250000, 3, random() % 20 == 0 ? z + pick(random, -499, 500) : z);
        break;
      }
      case Kind::part:
      case Kind::tilted:
      case Kind::kinds:
        if (random() % 50 == 0) level = pick(random, -4000, 4000);
        add(i * 100 + pick(random, -1, 1), kind == Kind::tilted ? level / 3 : 40,
            level + (i % 300) * (i % 300) / 20 + pick(random, -5, 5));
        break;
    }
  }
  return c;
}

inline Kind any_kind(Random& random) {
  return static_cast<Kind>(pick(random, 0, static_cast<int>(Kind::kinds) - 1));
}

/// A line of up to `max_runs` runs with invalid samples between them.
inline LineBuffer make_line(Random& random, std::size_t max_runs, std::size_t max_points, bool ulps) {
  LineBuffer line;
  const auto runs = static_cast<std::size_t>(pick(random, 0, static_cast<std::int64_t>(max_runs)));
  for (std::size_t r = 0; r < runs; ++r) {
    const auto n = static_cast<std::size_t>(pick(random, 1, static_cast<std::int64_t>(max_points)));
    const Coordinates c = make_run(random, any_kind(random), n);
    line.runs.push_back({static_cast<std::uint32_t>(line.points()), static_cast<std::uint32_t>(n),
                         static_cast<std::uint32_t>(r == 0 ? 0 : pick(random, 0, 9))});
    for (std::size_t axis = 0; axis < 3; ++axis) {
      line.xyz[axis].insert(line.xyz[axis].end(), c[axis].begin(), c[axis].end());
      for (std::size_t i = 0; ulps && i < n; ++i) line.ulp[axis].push_back(pick(random, -2, 2) << pick(random, 0, 40));
    }
  }
  line.invalid_after = static_cast<std::uint32_t>(random() % 3 == 0 ? random() % 100 : 0);
  if (random() % 2 == 0) line.stamps.device_ns = static_cast<std::int64_t>(random());
  if (random() % 2 == 0) line.stamps.host_realtime_ns = pick(random, 0, 1LL << 60);
  if (random() % 2 == 0) line.stamps.host_monotonic_ns = pick(random, 0, 1LL << 50);
  if (random() % 2 == 0) line.stamps.encoder = pick(random, -1000, 1000);
  if (random() % 4 == 0) line.plane = {0.5, -0.25, 12.125};
  return line;
}

/// Groups with what the codec treats apart; each has enough points for it.
enum class Special : int {
  fan,     ///< a sensor that turns: whole range steps on few directions, some beams without an echo
  raster,  ///< even abscissae, gaps of invalid samples, edges that drift from line to line
  repeats, ///< random, but the same again in every line
  ruled,   ///< abscissae on rounded multiples of a pitch that is no whole number, some points missing
  specials
};

inline LineGroup make_special(Random& random, Special special, std::size_t lines, std::size_t points) {
  LineGroup group;
  const double turn = 3.0 / static_cast<double>(points);
  const auto step = pick(random, 1, 3) * 500;
  const double pitch = static_cast<double>(pick(random, 1500, 90000)) / 1024;
  const bool joined = special == Special::fan || special == Special::ruled; // what is missing does not break the run
  std::vector<std::int32_t> repeated;
  for (std::size_t i = 0; i < points; ++i) repeated.push_back(static_cast<std::int32_t>(pick(random, -1000000000, 1000000000)));
  for (std::size_t l = 0; l < lines; ++l) {
    LineBuffer line;
    std::uint32_t invalid = 0;
    for (std::size_t i = 0; i < points; ++i) {
      if (special != Special::repeats && random() % 40 == 0) {
        ++invalid;
        continue;
      }
      const bool joins = joined || invalid == 0;
      if (line.runs.empty() || !joins) line.runs.push_back({static_cast<std::uint32_t>(line.points()), 0, invalid});
      invalid = joined ? invalid : 0;
      ++line.runs.back().count;
      const auto along = static_cast<std::int32_t>(i);
      const auto y = static_cast<std::int32_t>(l * 100);
      const auto edge = along + static_cast<std::int32_t>(l / 3) > static_cast<std::int32_t>(points / 2) ? 5000 : 0;
      const auto noise = static_cast<std::int32_t>(pick(random, -5, 5));
      std::array<std::int32_t, 3> p{along * 100, y, edge + along * along / 40 + noise};
      if (special == Special::fan) {
        const auto range = static_cast<double>(step * (200 + edge / 50 + noise));
        p = {static_cast<std::int32_t>(std::llround(range * std::cos(turn * along))), y,
             static_cast<std::int32_t>(std::llround(range * std::sin(turn * along)))};
      } else if (special == Special::repeats) {
        p = {along * 100, y, repeated[i]};
      } else if (special == Special::ruled) {
        p[0] = static_cast<std::int32_t>(std::llround(pitch * along + 0.01 * static_cast<double>(l)));
      }
      for (std::size_t axis = 0; axis < 3; ++axis) line.xyz[axis].push_back(p[axis]);
    }
    line.invalid_after = joined ? 0 : invalid;
    if (!line.runs.empty() && joined) line.runs.front().invalid_before = 0;
    append_line(group, l, line);
  }
  return group;
}

} // namespace scansion::test
