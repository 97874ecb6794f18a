// The first and the last interval of each wall.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/jumps.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

constexpr double kWallSlope = 1.7320508;     // tan 60: a wall of 80 degrees with one sample on it looks no steeper than this
constexpr std::uint32_t kMostIntervals = 16; // more are a slope that may be smooth
constexpr double kBeside = 2.5;              // pitches from a step's cut to the wall that it stands for
constexpr double kAtOnce = 1.1;              // and from that of a crease
constexpr double kHole = 1.2;                // pitches from a column to its sample
constexpr double kPhase = 0.27;              // of a pitch: samples often stand on columns or midway between them

double least_wall(const Sampling& sampling) noexcept {
  return std::max(8.0 * sampling.noise, 0.09);
}

auto find_column(const auto& sorted, std::int64_t column) noexcept {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), column,
                                   [](const auto& entry, std::int64_t c) { return entry.column < c; });
  return at != sorted.end() && at->column == column ? at : sorted.end();
}

bool has(const auto& sorted, std::int64_t column) noexcept {
  return find_column(sorted, column) != sorted.end();
}

} // namespace

void PatchRow::find_columns(double pitch) {
  if (!standing.empty() || s.empty()) return;
  const auto n = static_cast<std::uint32_t>(s.size());
  first_column = static_cast<std::int64_t>(std::ceil(s.front() / pitch - kPhase));
  const auto last = static_cast<std::int64_t>(std::floor(s.back() / pitch + kPhase));
  std::uint32_t k = 0;
  for (std::int64_t j = first_column; j <= last; ++j) {
    // The last one up to it.
    const double place = static_cast<double>(j) * pitch, limit = place + kPhase * pitch;
    while (k < n && s[k] <= limit) ++k;
    const auto near = [&](std::uint32_t i) { return std::abs(s[i] - place) <= kHole * pitch; };
    standing.push_back(k > 0 && near(k - 1) ? k - 1 : k < n && near(k) ? k : kNoSample);
  }
}

std::int64_t pair_columns(const PatchRow& before, const PatchRow& now, std::vector<ColumnPair>& pairs) {
  pairs.clear();
  if (before.s.empty() || now.s.empty()) return 0;
  const std::int64_t first = std::min(before.first_column, now.first_column);
  const std::int64_t end = std::max(before.end_column(), now.end_column());
  for (std::int64_t j = first; j < end; ++j) pairs.push_back({before.at(j), now.at(j)});
  return first;
}

void Jumps::in_line(const PatchRow& row, const Sampling& sampling, std::vector<Cut>& cuts) {
  const double least = least_wall(sampling);
  walls_.clear();
  std::uint32_t begin = 0;
  for (const std::uint32_t end : row.ends) {
    for (std::uint32_t k = begin; k + 1 < end;) {
      const double dw = row.w[k + 1] - row.w[k];
      const auto is_wall = [&](std::uint32_t i) {
        const double d = row.w[i + 1] - row.w[i];
        return std::abs(d) > 0.5 * least && d * dw > 0.0 && std::abs(d) > kWallSlope * (row.s[i + 1] - row.s[i]);
      };
      if (!is_wall(k)) {
        ++k;
        continue;
      }
      std::uint32_t after = k + 1;
      while (after + 1 < end && is_wall(after)) ++after;
      if (after - k <= kMostIntervals && std::abs(row.w[after] - row.w[k]) > least) {
        walls_.push_back(k);
        if (after - k > 1) walls_.push_back(after - 1);
      }
      k = after;
    }
    begin = end;
  }
  if (walls_.empty()) return;
  merged_.clear();
  for (const std::uint32_t k : walls_) {
    Cut cut;
    cut.s = 0.5 * (row.s[k] + row.s[k + 1]);
    cut.kind = BorderKind::step;
    cut.backed = false;
    merged_.push_back(cut);
  }
  const std::size_t walls = merged_.size();
  for (const Cut& cut : cuts) {
    bool moved = false;
    for (std::size_t i = 0; i < walls; ++i) {
      if (std::abs(merged_[i].s - cut.s) > (cut.kind == BorderKind::step ? kBeside : kAtOnce) * sampling.pitch) continue;
      merged_[i].backed = merged_[i].backed || cut.backed;
      moved = true;
    }
    if (!moved) merged_.push_back(cut);
  }
  std::sort(merged_.begin(), merged_.end(), [](const Cut& a, const Cut& b) { return a.s < b.s; });
  std::swap(cuts, merged_);
}

void Jumps::find(const PatchRow& before, const PatchRow& now, std::int64_t first, const std::vector<ColumnPair>& pairs,
                 const Sampling& sampling, std::vector<Wall>& out) {
  out.clear();
  const double least = std::max(least_wall(sampling), kWallSlope * (now.c - before.c));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].before == ColumnPair::kNone || pairs[i].now == ColumnPair::kNone) continue;
    const double dw = now.w[pairs[i].now] - before.w[pairs[i].before];
    if (std::abs(dw) > least) out.push_back({first + static_cast<std::int64_t>(i), dw > 0.0});
  }
}

void Jumps::across(const PatchRow& before, const PatchRow& now, const PatchRow* next, std::int64_t first,
                   const std::vector<ColumnPair>& pairs, double pitch, const Sampling& sampling, std::vector<Cut>& cuts) {
  find(before, now, first, pairs, sampling, here_);
  below_.clear();
  if (next != nullptr) {
    const std::int64_t start = pair_columns(now, *next, pairs_);
    find(now, *next, start, pairs_, sampling, below_);
  }
  // Of a wall that shows samples, the first interval parts and the last one.
  parting_.clear();
  for (const Wall& wall : here_) {
    const auto up = find_column(above_, wall.column), down = find_column(below_, wall.column);
    const bool goes_on = up != above_.end() && up->rises == wall.rises && down != below_.end() && down->rises == wall.rises;
    if (!goes_on) parting_.push_back(wall);
  }
  merged_.clear();
  for (const Cut& cut : cuts) {
    const bool moved =
        cut.kind == BorderKind::step && (has(above_, cut.column) || has(here_, cut.column) || has(below_, cut.column));
    if (!moved && !has(parting_, cut.column)) merged_.push_back(cut);
  }
  for (const Wall& wall : parting_) {
    const auto known = find_column(cuts, wall.column);
    const bool backed = known != cuts.end() && known->backed;
    merged_.push_back({static_cast<double>(wall.column) * pitch, wall.column, BorderKind::step, backed});
  }
  std::sort(merged_.begin(), merged_.end(), [](const Cut& a, const Cut& b) { return a.column < b.column; });
  std::swap(cuts, merged_);
  std::swap(above_, here_);
}

} // namespace scansion
