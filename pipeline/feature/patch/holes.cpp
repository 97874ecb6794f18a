// Gaps of successive rows that lie beside each other are one region; its rim tells whether it is a hole.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch/holes.hpp"

#include "pipeline/feature/patch/patch_runs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scansion {

namespace {

constexpr double kGap = 1.6;          // pitches between samples: one is missing; jitter stays below
constexpr double kOverlap = 0.3;      // of the smaller of two gaps that lie beside each other
constexpr double kLeastRows = 3.0;    // with a wide gap
constexpr double kAlike = 0.5;        // of two gaps in successive rows together, what both have
constexpr double kSureRows = 8.0;     // e-folds: so unlikely must it be that gaps meet by chance, row for row ...
constexpr double kSureSamples = 40.0; // ... and that all these samples were lost by chance
constexpr double kGain = 1.0 / 32.0;  // of a row, on the share of samples that are lost by chance
constexpr double kRim = 0.75;         // of the outline
constexpr std::uint32_t kBeside = 8;  // samples that tell the slope beside a gap
constexpr double kStep = 0.1;         // of the width: the sides of a hole lead to each other
constexpr double kLeastStep = 0.1;    // mm
constexpr double kNoise = 4.0;        // sigmas

/// Slope of up to kBeside samples from `k` on in steps of `way`, no gap between them; 0 when there are too few.
double slope_beside(const PatchRow& row, std::uint32_t k, int way, double pitch) {
  double n = 0.0, s = 0.0, w = 0.0, ss = 0.0, sw = 0.0;
  const double s0 = row.s[k], w0 = row.w[k];
  for (std::int64_t i = k; i >= 0 && i < static_cast<std::int64_t>(row.s.size()) && n < kBeside; i += way) {
    const auto at = static_cast<std::size_t>(i);
    const double ds = row.s[at] - s0, dw = row.w[at] - w0;
    if (std::abs(ds) > kGap * pitch * (n + 1.0)) break;
    n += 1.0;
    s += ds;
    w += dw;
    ss += ds * ds;
    sw += ds * dw;
  }
  const double square = n * ss - s * s;
  return n >= 3.0 && square > 0.0 ? (n * sw - s * w) / square : 0.0;
}

/// What the far side lies off the surface on this side, at the least: where one side is bent, the other may tell.
double offset(const PatchRow& row, std::uint32_t left, double pitch) {
  const double gap = row.s[left + 1] - row.s[left], rise = row.w[left + 1] - row.w[left];
  const double before = slope_beside(row, left, -1, pitch), after = slope_beside(row, left + 1, 1, pitch);
  double least = rise - 0.5 * (before + after) * gap;
  for (const double slope : {before, after})
    if (std::abs(rise - slope * gap) < std::abs(least)) least = rise - slope * gap;
  return least;
}

HoleSlab slab_of(const PatchRow& row, std::uint32_t left, double pitch) {
  HoleSlab slab;
  slab.line = row.line;
  slab.c = row.c;
  slab.s_low = row.s[left] + 0.5 * pitch;
  slab.s_high = row.s[left + 1] - 0.5 * pitch;
  slab.w_low = row.w[left];
  slab.w_high = row.w[left + 1];
  slab.first = row.number(left);
  slab.last = row.number(left + 1);
  return slab;
}

double overlap(const HoleSlab& a, const HoleSlab& b) noexcept {
  return std::min(a.s_high, b.s_high) - std::max(a.s_low, b.s_low);
}

bool are_beside(const HoleSlab& a, const HoleSlab& b) noexcept {
  return overlap(a, b) >= kOverlap * std::min(a.s_high - a.s_low, b.s_high - b.s_low);
}

/// What the gaps of a region and those in its next row have in common, and how much they are.
struct Likeness {
  double both = 0.0, either = 0.0; // mm
  double rows = 0.0;               // with a wide gap
  double samples = 0.0;            // that are missing
};

Likeness likeness_of(const std::vector<HoleSlab>& slabs, double pitch) {
  const double wide = (PatchRow::kDropout - 1.0) * pitch;
  Likeness out;
  double width_before = 0.0;
  auto before = slabs.begin(), row = slabs.begin();
  for (auto next = row; row != slabs.end(); before = row, row = next) {
    double width = 0.0, widest = 0.0, both = 0.0;
    for (; next != slabs.end() && next->row == row->row; ++next) {
      width += next->s_high - next->s_low;
      widest = std::max(widest, next->s_high - next->s_low);
      for (auto above = before; above != row; ++above) both += std::max(0.0, overlap(*above, *next));
    }
    out.samples += width / pitch;
    if (widest >= wide) out.rows += 1.0;
    if (row != slabs.begin()) {
      out.both += both;
      out.either += width_before + width - both;
    }
    width_before = width;
  }
  return out;
}

/// Are there gaps enough, each about where those of the row before are? Where a share of the samples is `lost` by chance, gaps
/// meet by chance.
bool hangs_together(const std::vector<HoleSlab>& slabs, double pitch, double lost) {
  constexpr double kLeast = 1e-6, kMost = 0.45;
  const Likeness alike = likeness_of(slabs, pitch);
  const double row = -std::log(std::clamp(2.0 * lost, kLeast, kMost)), sample = -std::log(std::clamp(lost, kLeast, kMost));
  return alike.rows >= std::max(kLeastRows, 1.0 + kSureRows / row) && alike.samples >= kSureSamples / sample &&
         alike.both >= kAlike * alike.either;
}

std::uint32_t patch_at(const PatchedRow& row, std::uint32_t sample) {
  const auto span = std::lower_bound(row.spans.begin(), row.spans.end(), sample,
                                     [](const PatchSpan& t, std::uint32_t k) { return t.last < k; });
  return span->patch;
}

} // namespace

void HoleFinder::add_rim(std::vector<RimPart>& rim, std::uint32_t patch, double length) {
  const auto known = std::find_if(rim.begin(), rim.end(), [&](const RimPart& part) { return part.patch == patch; });
  if (known != rim.end())
    known->length += length;
  else
    rim.push_back({patch, length});
}

std::size_t HoleFinder::root(std::size_t region) const noexcept {
  while (open_[region].into != kNone) region = open_[region].into;
  return region;
}

void HoleFinder::unite(std::size_t& a, std::size_t b) {
  b = root(b);
  a = a == kNone ? b : root(a);
  if (a == b) return;
  Region &to = open_[std::min(a, b)], &gone = open_[std::max(a, b)];
  to.slabs.insert(to.slabs.end(), gone.slabs.begin(), gone.slabs.end());
  gone.slabs.clear();
  for (const RimPart& part : gone.rim) add_rim(to.rim, part.patch, part.length);
  to.outline += gone.outline;
  to.is_open = to.is_open || gone.is_open;
  gone.into = a = std::min(a, b);
}

void HoleFinder::keep(Region& region, const HoleSlab& slab) {
  region.last_row = slab.row;
  if (slabs_ >= kMostSlabs && !region.is_open) {
    region.is_open = true;
    slabs_ -= region.slabs.size();
    region.slabs = {};
  }
  if (region.is_open) return;
  region.slabs.push_back(slab);
  ++slabs_;
}

// A region begins with a wide gap, or with a narrow one in the row above it.
void HoleFinder::begin(Gap& gap, const PatchedRow& above, double pitch, const Sampling& sampling) {
  gap.region = open_.size();
  Region& region = open_.emplace_back();
  region.is_open = above.row == nullptr;
  if (region.is_open || above.row->in_order) return;
  const PatchRow& row = *above.row;
  const auto n = static_cast<std::uint32_t>(row.s.size());
  const std::uint32_t from = row.s.beyond(0, n, gap.slab.s_low);
  for (std::uint32_t k = from - std::min(from, 1U); k + 1 < n && row.s[k] < gap.slab.s_high; ++k) {
    if (row.s[k + 1] - row.s[k] <= kGap * pitch) continue;
    HoleSlab slab = slab_of(row, k, pitch);
    if (!are_beside(slab, gap.slab)) continue;
    slab.row = gap.slab.row - 1;
    slab.c_low = row.c - 0.5 * sampling.spacing;
    slab.c_high = gap.slab.c_low;
    slab.off = offset(row, k, pitch);
    keep(region, slab);
    Gap& known = scratch_.emplace_back();
    known.slab = slab;
    known.region = gap.region;
  }
}

// Gives gaps their regions.
void HoleFinder::link(const PatchedRow& above, double pitch, const Sampling& sampling) {
  scratch_.clear();
  std::size_t first = 0;
  for (Gap& gap : gaps_) {
    while (first < before_.size() && before_[first].slab.s_high < gap.slab.s_low) ++first;
    for (std::size_t k = first; k < before_.size() && before_[k].slab.s_low < gap.slab.s_high; ++k)
      if (are_beside(before_[k].slab, gap.slab)) unite(gap.region, before_[k].region);
    if (gap.region == kNone && gap.wide) begin(gap, above, pitch, sampling);
  }
  before_.insert(before_.end(), scratch_.begin(), scratch_.end());
  stray_ = 0.0;
  for (const Gap& gap : gaps_)
    if (gap.region == kNone) stray_ += gap.slab.s_high - gap.slab.s_low;
  for (std::vector<Gap>* gaps : {&gaps_, &before_})
    for (Gap& gap : *gaps)
      if (gap.region != kNone) gap.region = root(gap.region);
  gaps_.erase(std::remove_if(gaps_.begin(), gaps_.end(), [](const Gap& gap) { return gap.region == kNone; }), gaps_.end());
  const auto by_region = [](const Gap& a, const Gap& b) {
    return std::pair(a.region, a.slab.s_low) < std::pair(b.region, b.slab.s_low);
  };
  std::sort(gaps_.begin(), gaps_.end(), by_region);
  std::sort(before_.begin(), before_.end(), by_region);
}

// Between `from` and `to` a region ends on this row: samples there are its rim.
void HoleFinder::cap(Region& region, const PatchedRow& row, double from, double to, double pitch) {
  if (row.row == nullptr || from < row.row->s.front() - pitch || to > row.row->s.back() + pitch) {
    region.is_open = true;
    return;
  }
  region.outline += to - from;
  const RowPlaces& s = row.row->s;
  const auto n = static_cast<std::uint32_t>(s.size());
  for (std::uint32_t k = s.at_or_beyond(0, n, from); k < n && s[k] < to; ++k) add_rim(region.rim, patch_at(row, k), pitch);
}

// Adds this row to the regions, and to their rims what lies beside it and between the two rows.
void HoleFinder::measure(const PatchedRow& above, const PatchedRow& now, double pitch, const Sampling& sampling) {
  const auto caps = [&](const std::vector<Gap>& gaps, const std::vector<Gap>& others, const PatchedRow& row) {
    auto other = others.begin();
    for (const Gap& gap : gaps) {
      while (other != others.end() && other->region < gap.region) ++other;
      double from = gap.slab.s_low;
      for (auto o = other; o != others.end() && o->region == gap.region && from < gap.slab.s_high; ++o) {
        if (o->slab.s_high <= from) continue;
        if (o->slab.s_low > from) cap(open_[gap.region], row, from, std::min(o->slab.s_low, gap.slab.s_high), pitch);
        from = o->slab.s_high;
      }
      if (from < gap.slab.s_high) cap(open_[gap.region], row, from, gap.slab.s_high, pitch);
    }
  };
  caps(gaps_, before_, above);
  caps(before_, gaps_, now);
  for (Gap& gap : gaps_) {
    Region& region = open_[gap.region];
    gap.slab.off = offset(*now.row, gap.left, pitch);
    keep(region, gap.slab);
    region.outline += 2.0 * sampling.spacing;
    for (const std::uint32_t k : {gap.left, gap.left + 1}) add_rim(region.rim, patch_at(now, k), sampling.spacing);
  }
}

void HoleFinder::add(const PatchedRow& above, const PatchedRow& now, std::int64_t number, double pitch,
                     const Sampling& sampling) {
  const PatchRow& row = *now.row;
  const double level = above.row != nullptr ? 0.5 * (above.row->c + row.c) : row.c - 0.5 * sampling.spacing;
  gaps_.clear();
  for (std::uint32_t k = 0; !row.in_order && k + 1 < row.s.size(); ++k) {
    if (row.s[k + 1] - row.s[k] <= kGap * pitch) continue;
    Gap& gap = gaps_.emplace_back();
    gap.slab = slab_of(row, k, pitch);
    gap.slab.row = number;
    gap.slab.c_low = level;
    gap.slab.c_high = row.c + 0.5 * sampling.spacing;
    gap.left = k;
    gap.wide = row.s[k + 1] - row.s[k] > PatchRow::kDropout * pitch;
  }
  link(above, pitch, sampling);
  for (Region& region : open_)
    for (auto t = region.slabs.rbegin(); t != region.slabs.rend() && t->row == number - 1; ++t) t->c_high = level;
  measure(above, now, pitch, sampling);
  end_regions(number, row.s.back() - row.s.front());
}

// Regions that this row did not touch have ended.
void HoleFinder::end_regions(std::int64_t number, double length) {
  double lost = stray_;
  for (const Region& region : open_)
    if (region.into == kNone && region.last_row != number && static_cast<double>(region.slabs.size()) < kLeastRows)
      for (const HoleSlab& t : region.slabs) lost += t.s_high - t.s_low;
  if (length > 0.0) lost_ += kGain * (std::min(1.0, lost / length) - lost_);
  std::vector<std::size_t> places(open_.size(), kNone);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < open_.size(); ++k) {
    Region& region = open_[k];
    if (region.into == kNone && region.last_row == number) {
      places[k] = kept;
      if (kept != k) open_[kept] = std::move(region);
      ++kept;
    } else if (region.into == kNone && !region.is_open) {
      region.lost = lost_;
      ended_.push_back(std::move(region));
    } else {
      slabs_ -= region.slabs.size();
    }
  }
  open_.resize(kept);
  for (Gap& gap : gaps_) gap.region = places[gap.region];
  std::sort(gaps_.begin(), gaps_.end(), [](const Gap& a, const Gap& b) { return a.slab.s_low < b.slab.s_low; });
  std::swap(gaps_, before_);
}

void HoleFinder::end_rows() {
  for (const Region& region : open_) slabs_ -= region.slabs.size();
  open_.clear();
  before_.clear();
}

void HoleFinder::follow(const PatchGraph& graph) {
  for (std::vector<Region>* regions : {&open_, &ended_}) {
    for (Region& region : *regions) {
      const auto stays = [&](const RimPart& part) { return graph.find(part.patch) == part.patch; };
      if (std::all_of(region.rim.begin(), region.rim.end(), stays)) continue;
      rim_.clear();
      for (const RimPart& part : region.rim) add_rim(rim_, graph.find(part.patch), part.length);
      region.rim.swap(rim_);
    }
  }
}

bool HoleFinder::is_hole(const Region& region, const HoleOutline& outline, double pitch, const Sampling& sampling) {
  const std::vector<HoleSlab>& slabs = region.slabs;
  if (outline.s_high - outline.s_low < (PatchRow::kDropout - 1.0) * pitch) return false;
  if (!hangs_together(slabs, pitch, region.lost)) return false;
  offs_.clear();
  for (const HoleSlab& t : slabs) offs_.push_back(t.off);
  const auto middle = offs_.begin() + static_cast<std::ptrdiff_t>(offs_.size() / 2);
  std::nth_element(offs_.begin(), middle, offs_.end());
  const double width = outline.area / (outline.c_high - outline.c_low);
  const double least = std::max(kLeastStep, kNoise * sampling.noise);
  // Around what stands inside, gaps lead from the rim to it.
  if (outline.inner_mm > 0.0) return outline.rise <= least;
  return std::abs(*middle) <= least + kStep * width;
}

void HoleFinder::tell(PatchGraph& graph, std::int64_t number, bool is_complete, const Sampling& sampling,
                      std::vector<FoundHole>& out) {
  std::size_t kept = 0;
  for (Region& region : ended_) {
    if (!is_complete && number - region.last_row <= PatchRuns::kWait + 1) {
      if (&ended_[kept] != &region) ended_[kept] = std::move(region);
      ++kept;
      continue;
    }
    slabs_ -= region.slabs.size();
    const auto most = std::max_element(region.rim.begin(), region.rim.end(),
                                       [](const RimPart& a, const RimPart& b) { return a.length < b.length; });
    if (most == region.rim.end()) continue;
    PatchNode* const node = graph.known(most->patch);
    if (node == nullptr || !node->real) continue;
    std::stable_sort(region.slabs.begin(), region.slabs.end(), [](const HoleSlab& a, const HoleSlab& b) {
      return std::pair(a.row, a.s_low) < std::pair(b.row, b.s_low);
    });
    auto outline = trace_hole(region.slabs, sampling.pitch);
    if (!outline || !is_hole(region, *outline, sampling.pitch, sampling)) continue;
    const double rim = most->length / (region.outline - outline->inner_mm);
    if (rim < kRim) continue;
    node->holes += outline->area;
    FoundHole& hole = out.emplace_back();
    hole.outline = std::move(*outline);
    hole.patch = most->patch;
    hole.confidence = std::min(1.0, rim);
    hole.lines = static_cast<std::uint64_t>(region.slabs.back().row - region.slabs.front().row + 1);
  }
  ended_.resize(kept);
}

} // namespace scansion
