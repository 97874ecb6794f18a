// Which points of a recording an export takes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/lattice.hpp"
#include "pipeline/rank/rank.hpp"
#include "pipeline/record/reader.hpp"

#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

namespace scansion {

struct Selection {
  enum class Kind : std::uint8_t { all, tolerance, reduction, level };
  Kind kind = Kind::all;
  double tolerance = 0.0;    ///< mm: keep {D > tolerance}
  Rational kept_share{1, 1}; ///< of a reduction of k percent: (100 - k) / 100
  std::uint32_t level = 0;   ///< S_level
  bool scan_scope = false;   ///< a reduction over one common order of all lines instead of each run alone
  std::uint64_t first_line = 0;
  std::uint64_t end_line = std::numeric_limits<std::uint64_t>::max(); ///< one past the last

  [[nodiscard]] bool has_line(std::uint64_t index) const noexcept { return index >= first_line && index < end_line; }
};

/// "95" or "97.5": percent of the points to leave out, 0 to 100.
[[nodiscard]] Result<Rational> parse_reduction(std::string_view percent);
/// "A:B", "A:" or ":B": lines A to B - 1.
[[nodiscard]] Result<std::pair<std::uint64_t, std::uint64_t>> parse_lines(std::string_view range);

/// Points a reduction keeps of a run of `count` points: m + 1 with m = floor(share * count), at least the end points.
[[nodiscard]] std::uint64_t kept_of_run(std::uint64_t count, Rational share) noexcept;
/// Points a reduction of the whole scan keeps: round(share * count), before end points are counted.
[[nodiscard]] std::uint64_t kept_of_scan(std::uint64_t count, Rational share) noexcept;

/// The points of one group that an export takes.
struct SelectedGroup {
  DecodedGroup decoded;
  std::vector<std::uint8_t> keep; ///< per point: 1 to take it
  double error = 0.0;             ///< mm: exact largest distance of a point left out to the polyline of those kept
};

/// Goes through a recording and says for every group what to keep. Memory follows the group; a reduction over the scan goes
/// through the recording several times.
class Selector {
public:
  /// Prepares; for a reduction over the scan this is where the work is.
  [[nodiscard]] static Result<Selector> prepare(RecordingReader& reader, const Selection& selection);

  [[nodiscard]] Result<void> select(std::size_t group, SelectedGroup& out);

private:
  Selector(RecordingReader& reader, const Selection& selection, Rational resolution)
      : reader_(&reader), selection_(selection),
        ranker_(resolution, RankUnit::automatic, reader.facts().levels.floor.in_counts(resolution)) {}
  [[nodiscard]] Result<std::uint32_t> level_needed(std::size_t group);
  [[nodiscard]] Result<void> find_common_threshold();
  void keep_by_tolerance(SelectedGroup& out);
  [[nodiscard]] Result<void> read_all(std::size_t group, DecodedGroup& out);
  void rank_known(const DecodedGroup& decoded, const Run& run);
  void keep_reduced_run(const Run& run, SelectedGroup& out);
  void keep_common_run(const Run& run, SelectedGroup& out);
  void add_error(const Run& run, SelectedGroup& out);

  RecordingReader* reader_;
  Selection selection_;
  Ranker ranker_;
  RankSorter sorter_;
  double threshold_ = 0.0; ///< of the common order: keep D > threshold_ ...
  std::uint64_t ties_ = 0; ///< ... and so many more of those with D == threshold_, in order
  // Scratch of the run being ranked.
  std::array<std::vector<std::int32_t>, 3> xyz_;
  std::vector<std::uint32_t> position_, depth_, order_;
  std::vector<double> distance_;
};

} // namespace scansion
