// Samples to columns: at once where samples stand evenly, one by one elsewhere.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch/patch_row.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scansion {

namespace {

constexpr double kHole = 1.2;   // pitches from a column to its sample
constexpr double kPhase = 0.27; // of a pitch: samples often stand on columns or midway between them

// Whether samples stand one to each column.
bool stands_one_to_each(const Profile& p, double per_mm) noexcept {
  const double origin = p.s[0] * per_mm;
  const double above = std::floor(origin - kPhase) + kPhase;
  return p.least_shift >= static_cast<float>(above - origin) && p.largest_shift < static_cast<float>(above + 1.0 - origin);
}

// Whether they stand about where an even row has them.
bool stands_evenly(const Profile& p) noexcept {
  constexpr float kEven = 0.25F; // pitches
  return p.least_shift >= -kEven && p.largest_shift <= kEven;
}

} // namespace

bool PatchRow::take(Profile& profile) {
  if (profile.size() == 0) return false;
  const double per_mm = 1.0 / profile.scale.pitch;
  const double first = std::ceil(profile.s.front() * per_mm - kPhase), last = std::floor(profile.s.back() * per_mm + kPhase);
  if (!(last >= first) || last - first >= kMostColumns) return false;
  line = profile.line;
  c = profile.c;
  in_order = stands_one_to_each(profile, per_mm);
  least_step = in_order && stands_evenly(profile) ? least_even_step(profile.scale.pitch) : 0.0;
  s.take(profile.shift, profile.s.front(), profile.scale.pitch);
  w.take(profile.height, profile.scale.base);
  source.swap(profile.source);
  ends.swap(profile.ends);
  rises.swap(profile.rises);
  rises_above = profile.rises_above;
  holes.clear();
  first_column = static_cast<std::int64_t>(first);
  columns_ = static_cast<std::size_t>(last - first) + 1;
  if (in_order)
    columns_ = std::min(columns_, s.size());
  else
    stand_anywhere(profile.scale.pitch);
  profile.forget();
  return true;
}

void PatchRow::stand_anywhere(double pitch) {
  const auto n = static_cast<std::uint32_t>(s.size());
  const double per_mm = 1.0 / pitch, shift = kPhase + static_cast<double>(first_column) - 1.0;
  height_.resize(columns_);
  standing.assign(columns_, kNoSample);
  // Of the samples up to a column, and no further from it than a pitch, the last.
  for (std::uint32_t k = 0; k < n; ++k) {
    const auto j = static_cast<std::size_t>(std::max(0.0, s[k] * per_mm - shift));
    if (j < standing.size()) standing[j] = k;
    if (k + 1 < n && s[k + 1] - s[k] > kDropout * pitch) holes.push_back(k);
  }
  std::uint32_t before = kNoSample;
  for (std::size_t j = 0; j < standing.size(); ++j) {
    if (standing[j] == kNoSample) {
      const double place = static_cast<double>(first_column + static_cast<std::int64_t>(j)) * pitch;
      const auto is_near = [&](std::uint32_t k) { return k < n && std::abs(s[k] - place) <= kHole * pitch; };
      const std::uint32_t after = before + 1; // of kNoSample the first sample
      standing[j] = before != kNoSample && is_near(before) ? before : is_near(after) ? after : kNoSample;
    } else {
      before = standing[j];
    }
    height_[j] = standing[j] == kNoSample ? std::numeric_limits<float>::quiet_NaN() : w.above()[standing[j]];
  }
}

} // namespace scansion
