// The first and the last interval of each wall.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/jumps.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace scansion {

namespace {

constexpr double kWallSlope = 1.7320508;     // tan 60: a wall of 80 degrees with one sample on it looks no steeper than this
constexpr std::uint32_t kMostIntervals = 16; // more are a slope that may be smooth
constexpr double kBeside = 2.5;              // pitches from a step's cut to the wall that it stands for
constexpr double kAtOnce = 1.1;              // and from that of a crease
constexpr std::size_t kBlock = 32;           // samples looked at together: hardly any is a wall

double least_wall(const Sampling& sampling) noexcept {
  return std::max(8.0 * sampling.noise, 0.09);
}

auto find_column(const auto& sorted, std::int64_t column) noexcept {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), column,
                                   [](const auto& entry, std::int64_t c) { return entry.column < c; });
  return at != sorted.end() && at->column == column ? at : sorted.end();
}

bool has(const auto& sorted, std::int64_t column) noexcept {
  return !sorted.empty() && find_column(sorted, column) != sorted.end();
}

/// Looks for steep intervals of a row.
class SteepFinder {
public:
  SteepFinder(const PatchRow& row, double least)
      : row_(row), least_(least), coarse_(static_cast<float>(kAlmost * std::max(least, kWallSlope * row.least_step))) {}

  [[nodiscard]] bool is_steep(std::uint32_t k) const noexcept {
    const double dw = std::abs(row_.w[k + 1] - row_.w[k]);
    return dw > least_ && dw > kWallSlope * (row_.s[k + 1] - row_.s[k]);
  }
  /// The next one from sample `k` on that ends no later than `last`, or `last`.
  [[nodiscard]] std::uint32_t next(std::uint32_t k, std::uint32_t last) const noexcept {
    while (k < last) {
      const auto stop = std::min<std::uint32_t>(k + kBlock, last);
      if (row_.in_order && stop < row_.height.size() && !may_be_steep(row_.height.data() + k, stop - k)) k = stop;
      while (k < stop && !is_steep(k)) ++k;
      if (k < stop) return k;
    }
    return last;
  }

private:
  static constexpr double kAlmost = 0.99; // heights by columns are rounded

  [[nodiscard]] bool may_be_steep(const float* w, std::size_t count) const noexcept {
    std::uint32_t any = 0;
    for (std::size_t i = 0; i < count; ++i) any |= static_cast<std::uint32_t>(std::abs(w[i + 1] - w[i]) > coarse_);
    return any != 0;
  }

  const PatchRow& row_;
  double least_;
  float coarse_; ///< what is no higher cannot be steep
};

} // namespace

void Jumps::find_walls(const PatchRow& row, double least) {
  walls_.clear();
  const SteepFinder steep(row, 0.5 * least);
  const double* w = row.w.data();
  std::uint32_t begin = 0;
  for (const std::uint32_t end : row.ends) {
    const std::uint32_t last = end - 1;
    for (std::uint32_t k = steep.next(begin, last); k < last;) {
      const double dw = w[k + 1] - w[k];
      std::uint32_t after = k + 1;
      while (after < last && (w[after + 1] - w[after]) * dw > 0.0 && steep.is_steep(after)) ++after;
      if (after - k <= kMostIntervals && std::abs(w[after] - w[k]) > least) {
        walls_.push_back(k);
        if (after - k > 1) walls_.push_back(after - 1);
      }
      k = steep.next(after, last);
    }
    begin = end;
  }
}

void Jumps::in_line(const PatchRow& row, const Sampling& sampling, std::vector<Cut>& cuts) {
  find_walls(row, least_wall(sampling));
  if (walls_.empty()) return;
  parting_.clear();
  for (const std::uint32_t k : walls_) {
    Cut cut;
    cut.s = 0.5 * (row.s[k] + row.s[k + 1]);
    cut.kind = BorderKind::step;
    cut.backed = false;
    parting_.push_back(cut);
  }
  std::erase_if(cuts, [&](const Cut& cut) {
    const double reach = (cut.kind == BorderKind::step ? kBeside : kAtOnce) * sampling.pitch;
    bool moved = false;
    for (Cut& wall : parting_) {
      if (std::abs(wall.s - cut.s) > reach) continue;
      wall.backed = wall.backed || cut.backed;
      moved = true;
    }
    return moved;
  });
  merged_.clear();
  std::merge(parting_.begin(), parting_.end(), cuts.begin(), cuts.end(), std::back_inserter(merged_),
             [](const Cut& a, const Cut& b) { return a.s < b.s; });
  std::swap(cuts, merged_);
}

void Jumps::find(const PatchRow& before, const PatchRow& now, const Sampling& sampling, std::vector<Wall>& out) {
  out.clear();
  const auto least = static_cast<float>(std::max(least_wall(sampling), kWallSlope * (now.c - before.c)));
  const std::int64_t first = std::max(before.first_column, now.first_column);
  const std::int64_t end = std::min(before.end_column(), now.end_column());
  if (first >= end) return;
  const float* a = before.height.data() + (first - before.first_column);
  const float* b = now.height.data() + (first - now.first_column);
  const auto columns = static_cast<std::size_t>(end - first);
  for (std::size_t i = 0; i < columns; i += kBlock) {
    const std::size_t stop = std::min(columns, i + kBlock);
    std::uint32_t any = 0;
    for (std::size_t j = i; j < stop; ++j) any |= static_cast<std::uint32_t>(std::abs(b[j] - a[j]) > least);
    if (any == 0) continue;
    for (std::size_t j = i; j < stop; ++j)
      if (std::abs(b[j] - a[j]) > least) out.push_back({first + static_cast<std::int64_t>(j), b[j] > a[j]});
  }
}

void Jumps::across(const PatchRow& before, const PatchRow& now, const PatchRow* next, double pitch, const Sampling& sampling,
                   std::vector<Cut>& cuts) {
  if (known_)
    std::swap(here_, below_);
  else
    find(before, now, sampling, here_);
  below_.clear();
  known_ = next != nullptr;
  if (known_) find(now, *next, sampling, below_);
  // Of a wall that shows samples, the first interval parts and the last one.
  parting_.clear();
  for (const Wall& wall : here_) {
    const auto up = find_column(above_, wall.column), down = find_column(below_, wall.column);
    const bool goes_on = up != above_.end() && up->rises == wall.rises && down != below_.end() && down->rises == wall.rises;
    if (goes_on) continue;
    const auto known = find_column(cuts, wall.column);
    const bool backed = known != cuts.end() && known->backed;
    parting_.push_back({static_cast<double>(wall.column) * pitch, wall.column, BorderKind::step, backed});
  }
  if (!(above_.empty() && here_.empty() && below_.empty())) {
    std::erase_if(cuts, [&](const Cut& cut) {
      const bool moved =
          cut.kind == BorderKind::step && (has(above_, cut.column) || has(here_, cut.column) || has(below_, cut.column));
      return moved || has(parting_, cut.column);
    });
  }
  if (!parting_.empty()) {
    merged_.clear();
    std::merge(cuts.begin(), cuts.end(), parting_.begin(), parting_.end(), std::back_inserter(merged_),
               [](const Cut& a, const Cut& b) { return a.column < b.column; });
    std::swap(cuts, merged_);
  }
  std::swap(above_, here_);
}

} // namespace scansion
