// Scan lines, runs, groups of lines and gaps: the values that travel through the pipeline.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace scansion {

/// Times and positions of one line. Each is optional and none is ever made from another.
struct Stamps {
  std::optional<std::int64_t> device_ns;         ///< the device's own clock
  std::optional<std::int64_t> host_monotonic_ns; ///< CLOCK_MONOTONIC at the last byte of the line
  std::optional<std::int64_t> host_realtime_ns;  ///< CLOCK_REALTIME at the last byte of the line
  std::optional<std::int64_t> encoder;           ///< counts

  friend bool operator==(const Stamps&, const Stamps&) = default;
};

/// A stretch of a line without invalid samples or steps over the gap limit: a polyline of its own.
struct Run {
  std::uint32_t first = 0;          ///< index of its first point in the group's point arrays
  std::uint32_t count = 0;          ///< points, at least 1
  std::uint32_t invalid_before = 0; ///< invalid samples between the previous run (or the start of the line) and this one

  friend bool operator==(const Run&, const Run&) = default;
};

struct ScanLine {
  std::uint64_t index = 0; ///< line index in the recording
  Stamps stamps;
  std::optional<std::array<double, 3>> plane; ///< a, b, c of a x + b y + c = 0 in millimetres, when the device tells
  std::uint32_t first_run = 0;                ///< index into LineGroup::runs
  std::uint32_t run_count = 0;                ///< 0 for a line without a valid point
  std::uint32_t invalid_after = 0;            ///< invalid samples after the last run

  friend bool operator==(const ScanLine&, const ScanLine&) = default;
};

/// A group of consecutive scan lines of one device: the unit of ranking, coding and writing. Points of all lines stand one
/// after the other in line order; a buffer is cleared and used again, so the steady state allocates nothing.
struct LineGroup {
  std::uint64_t number = 0; ///< group number in the recording, from 0
  std::vector<ScanLine> lines;
  std::vector<Run> runs;
  std::array<std::vector<std::int32_t>, 3> xyz; ///< counts on the recording's lattice, relative to its origin
  /// IEEE residuals in units of least precision, same length as xyz; empty unless Lattice::exact.
  std::array<std::vector<std::int64_t>, 3> ulp;

  [[nodiscard]] std::size_t points() const noexcept { return xyz[0].size(); }
  [[nodiscard]] std::span<const Run> runs_of(const ScanLine& line) const noexcept {
    return {runs.data() + line.first_run, line.run_count};
  }
  void clear() noexcept {
    lines.clear();
    runs.clear();
    for (auto& axis : xyz) axis.clear();
    for (auto& axis : ulp) axis.clear();
  }
};

/// One scan line on its way into a group, as importers and drivers make it. Cleared and used again.
struct LineBuffer {
  Stamps stamps;
  std::optional<std::array<double, 3>> plane;
  std::vector<Run> runs; ///< Run::first counts from the start of this buffer
  std::uint32_t invalid_after = 0;
  std::array<std::vector<std::int32_t>, 3> xyz;
  std::array<std::vector<std::int64_t>, 3> ulp; ///< empty unless Lattice::exact

  [[nodiscard]] std::size_t points() const noexcept { return xyz[0].size(); }
  void clear() noexcept {
    stamps = {};
    plane.reset();
    runs.clear();
    invalid_after = 0;
    for (auto& axis : xyz) axis.clear();
    for (auto& axis : ulp) axis.clear();
  }
};

/// A group closes at this many lines ...
inline constexpr std::uint32_t kGroupLines = 64;
/// ... or before it would hold more than this many points (a longer line is a group of its own).
inline constexpr std::uint32_t kGroupPoints = 1U << 18U;
/// The longest scan line that is taken.
inline constexpr std::uint32_t kMaxLinePoints = 1U << 22U;

/// Puts `line` with index `index` at the end of `group`.
void append_line(LineGroup& group, std::uint64_t index, const LineBuffer& line);

/// Lines that are missing from the stream.
struct Gap {
  std::uint64_t first = 0;            ///< index of the first missing line
  std::optional<std::uint64_t> count; ///< unknown when empty
  std::string reason;

  friend bool operator==(const Gap&, const Gap&) = default;
};

} // namespace scansion
