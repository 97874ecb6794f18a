// Samples to columns: at once where samples stand evenly, one by one elsewhere.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch_row.hpp"

#include "pipeline/feature/passes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scansion {

namespace {

constexpr double kHole = 1.2;   // pitches from a column to its sample
constexpr double kPhase = 0.27; // of a pitch: samples often stand on columns or midway between them

// How samples stand against columns: one to each, about where the grid from the first sample has them (even), or somewhere.
passes::Standing standing_of(const std::vector<double>& s, double per_mm) noexcept {
  constexpr float kEven = 0.25F; // pitches
  const double origin = s[0] * per_mm;
  const double above = std::floor(origin - kPhase) + kPhase;
  return passes::standing(
      s.data(), {per_mm, static_cast<float>(above - origin), static_cast<float>(above + 1.0 - origin), kEven}, s.size());
}

} // namespace

bool PatchRow::take(Profile& profile, double pitch, double base) {
  if (profile.size() == 0) return false;
  const double per_mm = 1.0 / pitch;
  const double first = std::ceil(profile.s.front() * per_mm - kPhase), last = std::floor(profile.s.back() * per_mm + kPhase);
  if (!(last >= first) || last - first >= kMostColumns) return false;
  line = profile.line;
  c = profile.c;
  s.swap(profile.s);
  w.swap(profile.w);
  source.swap(profile.source);
  ends.swap(profile.ends);
  holes.clear();
  first_column = static_cast<std::int64_t>(first);
  const auto columns = static_cast<std::size_t>(last - first) + 1;
  height.resize(columns);
  const auto [one_to_each, even] = standing_of(s, per_mm);
  in_order = one_to_each;
  least_step = one_to_each && even ? 0.5 * pitch : 0.0;
  if (in_order)
    passes::lower(w.data(), base, height.data(), columns);
  else
    stand_anywhere(pitch, base);
  return true;
}

void PatchRow::stand_anywhere(double pitch, double base) {
  const auto n = static_cast<std::uint32_t>(s.size());
  const double per_mm = 1.0 / pitch, shift = kPhase + static_cast<double>(first_column) - 1.0;
  standing.assign(height.size(), kNoSample);
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
    height[j] = standing[j] == kNoSample ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(w[standing[j]] - base);
  }
}

} // namespace scansion
