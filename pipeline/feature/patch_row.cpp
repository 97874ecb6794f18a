// Samples to columns: at once where samples stand evenly, one by one elsewhere.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch_row.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace scansion {

namespace {

constexpr double kHole = 1.2;   // pitches from a column to its sample
constexpr double kPhase = 0.27; // of a pitch: samples often stand on columns or midway between them

enum class Spread : std::uint8_t { even, slight, any };

// How samples stand against an even grid from the first one on: about where it has them, in the same column, or anywhere.
// Without branches, in few bytes: for all samples of all rows.
Spread spread_of(std::span<const double> s, double per_mm) noexcept {
  constexpr float kEven = 0.25F; // pitches
  const double origin = s[0] * per_mm;
  const double above = std::floor(origin - kPhase) + kPhase;
  const auto low = static_cast<float>(above - origin), high = static_cast<float>(above + 1.0 - origin);
  std::uint32_t outside = 0, uneven = 0;
  const auto n = static_cast<std::int32_t>(s.size());
  for (std::int32_t k = 0; k < n; ++k) {
    const auto shift = static_cast<float>(s[static_cast<std::size_t>(k)] * per_mm - origin - k);
    outside |= static_cast<std::uint32_t>(shift < low) | static_cast<std::uint32_t>(shift >= high);
    uneven |= static_cast<std::uint32_t>(std::abs(shift) > kEven);
  }
  return outside != 0 ? Spread::any : uneven != 0 ? Spread::slight : Spread::even;
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
  const Spread spread = spread_of(s, per_mm);
  in_order = spread != Spread::any;
  least_step = spread == Spread::even ? 0.5 * pitch : 0.0;
  if (in_order)
    stand_in_order(base);
  else
    stand_anywhere(pitch, base);
  return true;
}

// One sample to each column.
void PatchRow::stand_in_order(double base) {
  const double* from = w.data();
  float* to = height.data();
  const std::size_t columns = height.size();
  for (std::size_t j = 0; j < columns; ++j) to[j] = static_cast<float>(from[j] - base);
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
