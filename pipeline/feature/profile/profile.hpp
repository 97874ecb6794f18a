// One scan line as the feature stage sees it: heights over places along the line, in order, with what disturbs it masked.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/profile/frame.hpp"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace scansion {

/// Columns stand at whole multiples of a pitch along all lines of a scan.
struct ColumnScale {
  double pitch = 0.0; ///< mm
  double base = 0.0;  ///< mm: heights in columns are relative to it

  friend bool operator==(const ColumnScale&, const ColumnScale&) = default;
};

/// Samples in ascending s. The recording keeps the raw line; this is a view of it. Buffers are used again.
struct Profile {
  std::uint64_t line = 0;            ///< line index in the recording
  double c = 0.0;                    ///< mm, of its plane
  bool turned = false;               ///< was scanned towards negative s
  std::vector<double> s, w;          ///< mm
  std::vector<std::uint32_t> source; ///< index of each sample in its line; empty: they stand as in the line
  std::span<const double> distance;  ///< D in mm; infinite at the ends of runs: the line's own, or `ranked`
  std::vector<double> ranked;        ///< where samples are not as the line has them
  std::vector<std::uint32_t> ends;   ///< one past the last sample of each run, ascending
  std::uint32_t masked = 0;          ///< samples left out because s stepped back
  std::uint32_t spikes = 0;          ///< samples whose height was replaced
  std::vector<std::uint32_t> rises;  ///< sample before each interval that rises or falls by more than `rises_above`, and others
  double rises_above = std::numeric_limits<double>::infinity(); ///< mm
  ColumnScale scale;                                            ///< of the following; without a pitch: not known yet
  std::vector<float> shift;                                     ///< from an even row that begins with the first sample, pitches
  std::vector<float> height;                                    ///< mm above the base
  float least_shift = 0.0F, largest_shift = 0.0F;

  [[nodiscard]] std::size_t size() const noexcept { return s.size(); }
  [[nodiscard]] std::uint32_t number(std::size_t k) const noexcept {
    return source.empty() ? static_cast<std::uint32_t>(k) : source[k];
  }
  /// Distances of its own, to be changed, but not in number.
  [[nodiscard]] std::vector<double>& own_distances() {
    if (distance.data() != ranked.data()) ranked.assign(distance.begin(), distance.end());
    distance = ranked;
    return ranked;
  }
  void resize_distances(std::size_t size) {
    own_distances().resize(size);
    distance = ranked;
  }
  void clear() noexcept {
    masked = spikes = 0;
    turned = false;
    s.clear();
    w.clear();
    source.clear();
    distance = {};
    ranked.clear();
    ends.clear();
    forget();
  }
  /// Of what is made from places and heights.
  void forget() noexcept {
    rises_above = std::numeric_limits<double>::infinity();
    scale = {};
  }
};

/// One line: its points in counts, where its runs end, its distances in mm. Points and distances are somebody else's.
struct RawLine {
  std::uint64_t index = 0;
  Counts xyz;
  std::span<const double> distance;
  std::vector<std::uint32_t> ends;

  [[nodiscard]] std::size_t size() const noexcept { return distance.size(); }
};

/// Fills `out` from `line`: turned round when it was scanned backwards, samples masked whose s does not advance.
/// `resolution` in mm per count.
void make_profile(const RawLine& line, double resolution, const Frame& frame, Profile& out);

/// Fills in how the samples stand to columns.
void stand(Profile& profile, const ColumnScale& scale);

} // namespace scansion
