// The first and the last interval of each wall.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch/jumps.hpp"

#include "pipeline/feature/passes/passes.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace scansion {

namespace {

constexpr double kWallSlope = 1.7320508;     // tan 60: a wall of 80 degrees with one sample on it looks no steeper than this
constexpr std::uint32_t kMostIntervals = 16; // more are a slope that may be smooth
constexpr double kBeside = 2.5;              // pitches from a step's cut to the wall that it stands for
constexpr double kAtOnce = 1.1;              // and from that of a crease

double least_wall(const Sampling& sampling) noexcept {
  return std::max(8.0 * sampling.noise, sampling.limits.least_step);
}

// Goes through what is sorted by column, asked for columns in ascending order.
template <typename Entry>
class Walk {
public:
  explicit Walk(const std::vector<Entry>& sorted) noexcept : at_(sorted.data()), end_(at_ + sorted.size()) {}
  /// Null: there is none.
  [[nodiscard]] const Entry* at(std::int64_t column) noexcept {
    while (at_ != end_ && at_->column < column) ++at_;
    return at_ != end_ && at_->column == column ? at_ : nullptr;
  }

private:
  const Entry* at_;
  const Entry* end_;
};

} // namespace

double Jumps::least_rise(const Sampling& sampling, double least_step) noexcept {
  constexpr double kAlmost = 0.99; // what is lower is not steep, however it is rounded
  return kAlmost * std::max(0.5 * least_wall(sampling), kWallSlope * least_step);
}

void Jumps::find_walls(const PatchRow& row, const Sampling& sampling) {
  walls_.clear();
  const double least = least_wall(sampling);
  const RowPlaces& s = row.s;
  const RowHeights& w = row.w;
  const double high = 0.5 * least;
  const auto is_steep = [&](std::uint32_t k) {
    const double dw = std::abs(w[k + 1] - w[k]);
    return dw > high && dw > kWallSlope * (s[k + 1] - s[k]);
  };
  const double limit = least_rise(sampling, row.least_step);
  std::span<const std::uint32_t> rises = row.rises;
  if (row.rises_above > limit) {
    high_.resize(s.size());
    rises =
        std::span(high_).first(passes::apart(w.above() + 1, w.above(), static_cast<float>(limit), high_.data(), s.size() - 1));
  }
  auto end = row.ends.begin();
  std::uint32_t after = 0;
  for (const std::uint32_t k : rises) {
    if (k < after) continue; // part of the wall before
    while (k >= *end) ++end;
    const std::uint32_t last = *end - 1;
    if (k == last || !is_steep(k)) continue;
    const double dw = w[k + 1] - w[k];
    after = k + 1;
    while (after < last && (w[after + 1] - w[after]) * dw > 0.0 && is_steep(after)) ++after;
    if (after - k > kMostIntervals || std::abs(w[after] - w[k]) <= least) continue;
    walls_.push_back(k);
    if (after - k > 1) walls_.push_back(after - 1);
  }
}

void Jumps::in_line(const PatchRow& row, const Sampling& sampling, std::vector<Cut>& cuts) {
  find_walls(row, sampling);
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
  const float* a = before.heights() + (first - before.first_column);
  const float* b = now.heights() + (first - now.first_column);
  const auto columns = static_cast<std::size_t>(end - first);
  high_.resize(columns);
  const std::size_t count = passes::apart(b, a, least, high_.data(), columns);
  for (std::size_t i = 0; i < count; ++i) out.push_back({first + high_[i], b[high_[i]] > a[high_[i]]});
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
  Walk above(above_), below(below_);
  Walk known(cuts);
  for (const Wall& wall : here_) {
    const Wall *const up = above.at(wall.column), *const down = below.at(wall.column);
    const bool goes_on = up != nullptr && up->rises == wall.rises && down != nullptr && down->rises == wall.rises;
    if (goes_on) continue;
    const Cut* const cut = known.at(wall.column);
    const bool backed = cut != nullptr && cut->backed;
    parting_.push_back({static_cast<double>(wall.column) * pitch, wall.column, BorderKind::step, backed});
  }
  if (!here_.empty()) {
    Walk here(here_);
    Walk parting(parting_);
    std::erase_if(cuts, [&](const Cut& cut) {
      return (cut.kind == BorderKind::step && here.at(cut.column) != nullptr) || parting.at(cut.column) != nullptr;
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
