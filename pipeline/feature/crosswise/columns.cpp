// Slopes before and after a row, for all columns at once; what bends most is then measured like a point of a profile.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/crosswise/columns.hpp"

#include "pipeline/feature/crosswise/column_samples.hpp"
#include "pipeline/feature/fit/make_point.hpp"
#include "pipeline/feature/passes/column_passes.hpp"
#include "pipeline/feature/passes/passes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace scansion {

namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr double kMostMissed = 3.6;    // spacings within a window
constexpr std::size_t kMostFlank = 64; // rows
constexpr double kMostWanted = 24.0;   // rows a side
constexpr std::uint32_t kFewest = 2;   // rows a side
constexpr double kCalmer = 0.8;        // walls are marked as if the noise were less: its estimate changes

} // namespace

Columns::Columns(const Sampling& sampling, const ColumnScale& scale) : pitch_(scale.pitch), base_(scale.base) {
  // Narrow features want narrow windows; the noise decides how narrow.
  wanted_ = FitScale::wanted_window(sampling.noise, sampling.spacing, sampling.limits.least_turning);
  window_ = std::max(kNarrowest, (wanted_ + 2) / 3);
  // Narrow windows see nothing of arcs that are wider than edges are by default.
  const FeatureLimits& limits = sampling.limits;
  if (limits.largest_arc > FeatureLimits{}.largest_arc) {
    const double rows = limits.largest_arc * limits.least_turning * std::numbers::pi / 180.0 / sampling.spacing;
    wanted_ = std::max(wanted_, static_cast<std::size_t>(std::min(kMostWanted, std::ceil(rows))));
    sees_arcs_ = wanted_ > window_;
  }
  reach_ = std::max(kReach * window_, kLeastReach);
  const std::size_t rounding = FitScale::of(sampling.noise, sampling.spacing, sampling.coarse(), sampling.limits).widest_gap;
  flank_reach_ = std::max(reach_, std::min(kMostFlank, rounding + 2 * wanted_));
  ring_.resize(2 * lag() + 3);
}

bool Columns::make_room(double low, double high) {
  const auto first = static_cast<std::int64_t>(std::ceil(low / pitch_));
  const auto last = static_cast<std::int64_t>(std::floor(high / pitch_));
  if (last < first) return false;
  const std::int64_t left = width_ == 0 ? first : std::min(first, left_);
  const std::int64_t right = width_ == 0 ? last : std::max(last, left_ + static_cast<std::int64_t>(width_) - 1);
  if (right - left >= kMostColumns) return false;
  const auto width = static_cast<std::size_t>(right - left + 1);
  if (width == width_ && left == left_) return true;
  // Room to spare, so that lines whose ends wander do not move everything each time.
  const std::int64_t spare = width_ == 0 ? 0 : 64;
  const std::int64_t new_left = left < left_ || width_ == 0 ? left - spare : left_;
  const auto new_width = static_cast<std::size_t>(right - new_left + 1 + spare);
  const auto shift = static_cast<std::size_t>(width_ == 0 ? 0 : left_ - new_left);
  const auto widen = [&](auto& values, auto none) {
    std::remove_reference_t<decltype(values)> moved(new_width, none);
    std::copy(values.begin(), values.end(), moved.begin() + static_cast<std::ptrdiff_t>(shift));
    values = std::move(moved);
  };
  for (std::int64_t r = first_; r < next_; ++r) {
    widen(row(r).height, kNone);
    for (Bends* bends : {&row(r).narrow, &row(r).wide})
      if (bends->known) {
        widen(bends->of, kNone);
        bends->peaks.assign(passes::peaks_of(new_width), std::numeric_limits<float>::infinity()); // blocks are others now
      }
    widen(row(r).source, 0U);
  }
  unknown_.resize(new_width, kNone);
  widen(roundings_, Rounding());
  widen(edges_, Edge());
  widen(marks_, static_cast<std::uint32_t>(next_));
  last_marked_ = next_;
  left_ = new_left;
  width_ = new_width;
  view_rows();
  return true;
}

void Columns::add(const Profile& profile, const Sampling& sampling, std::vector<ColumnPoint>& out) {
  if (profile.size() < 2 || !make_room(profile.s.front(), profile.s.back())) return;
  const std::int64_t r = next_++;
  first_ = std::max(first_, next_ - static_cast<std::int64_t>(ring_.size()));
  Row& newest = row(r);
  newest.c = profile.c;
  newest.line = profile.line;
  newest.narrow.known = newest.wide.known = false;
  newest.height.resize(width_);
  newest.source.resize(width_);
  rows_.add(view(newest));
  if (rows_.size() > next_ - first_) rows_.drop_oldest();
  sample_columns(profile, sampling, {left_, width_}, newest.height.data(), newest.source.data());
  mark_walls(r, sampling);
  const auto n = static_cast<std::int64_t>(window_), wide = static_cast<std::int64_t>(wanted_);
  if (r >= n) screen(r - n, window_, sampling, row(r - n).narrow);
  if (r >= wide && looks_wide(sampling)) screen(r - wide, wanted_, sampling, row(r - wide).wide);
  const auto late = static_cast<std::int64_t>(lag());
  if (r >= late) harvest(r - late, sampling, out);
}

void Columns::finish(const Sampling& sampling, std::vector<ColumnPoint>& out) {
  const auto n = static_cast<std::int64_t>(window_), late = static_cast<std::int64_t>(lag());
  for (std::int64_t r = std::max<std::int64_t>(first_, next_ - n); r < next_; ++r) screen(r, window_, sampling, row(r).narrow);
  for (std::int64_t r = std::max<std::int64_t>(first_, next_ - late); r < next_; ++r) harvest(r, sampling, out);
}

// Notes in which columns a wall may start between the two rows before row r, the newest one.
void Columns::mark_walls(std::int64_t r, const Sampling& sampling) {
  constexpr double kRounded = 1e-3; // of a limit: heights of columns are
  row(r).marked_above = kCalmer * sampling.noise;
  marked_above_ = std::max(marked_above_, row(r).marked_above);
  if (r - first_ < 3) {
    std::fill(marks_.begin(), marks_.end(), static_cast<std::uint32_t>(r));
    last_marked_ = r;
    return;
  }
  const WallTest test(kCalmer * sampling.noise, sampling.limits.least_step);
  const double ds = row(r - 1).c - row(r - 2).c;
  const auto limit = [](double rise) { return static_cast<float>((1.0 - kRounded) * rise); };
  const bool any = passes::mark_walls(
      {row(r - 3).height.data(), row(r - 2).height.data(), row(r - 1).height.data(), row(r).height.data()},
      {limit(test.least_rise(ds)), limit(test.steep_rise(ds)), static_cast<float>((1.0 + kRounded) * WallTest::kLonely)},
      static_cast<std::uint32_t>(r - 1), marks_.data(), width_);
  if (any) last_marked_ = std::max(last_marked_, r - 1);
}

// Whether a column may have a wall beyond this row: most have none, and need not be searched.
bool Columns::has_walls(std::size_t column, std::int64_t from) const noexcept {
  return !trusted_ || static_cast<std::uint32_t>(next_) - marks_[column] < static_cast<std::uint32_t>(next_ - from);
}

// As a change of slope, where one of the slopes is none.
float least_slope_change(const Sampling& sampling) noexcept {
  return static_cast<float>(std::tan(sampling.limits.least_turning * std::numbers::pi / 180.0));
}

float Columns::least_bend(std::size_t window, const Sampling& sampling) noexcept {
  const auto n = static_cast<double>(window), length = n * sampling.spacing;
  const double sigma = sampling.noise * std::sqrt(24.0 / (n * length * length));
  return std::max(least_slope_change(sampling), static_cast<float>(kLeastSignificance * sigma));
}

bool Columns::looks_wide(const Sampling& sampling) const noexcept {
  return sees_arcs_ || (wanted_ > window_ && least_bend(window_, sampling) > least_slope_change(sampling));
}

// Slope after minus slope before for row r: one weighted sum of rows.
void Columns::screen(std::int64_t r, std::size_t window, const Sampling& sampling, Bends& out) {
  const auto n = static_cast<std::int64_t>(window);
  // At least two rows a side; fewer than N at the ends of the scan.
  const std::int64_t low = std::max(first_, r - n), high = std::min(next_ - 1, r + n);
  if (r - low < 2 || high - r < 2) return;
  for (std::int64_t k = low + 1; k <= high; ++k)
    if (row(k).c - row(k - 1).c > kMostMissed * sampling.spacing) return;
  weighed_.clear();
  weights_.clear();
  const auto add_side = [&](std::int64_t from, std::int64_t to, double sign) {
    double mean = 0.0, square = 0.0;
    for (std::int64_t k = from; k <= to; ++k) mean += row(k).c;
    mean /= static_cast<double>(to - from + 1);
    for (std::int64_t k = from; k <= to; ++k) square += (row(k).c - mean) * (row(k).c - mean);
    for (std::int64_t k = from; k <= to; ++k) {
      weighed_.push_back(row(k).height.data());
      weights_.push_back(static_cast<float>(square > 0.0 ? sign * ((row(k).c - mean) / square) : 0.0));
    }
  };
  add_side(low, r - 1, -1.0);
  add_side(r + 1, high, 1.0);
  out.of.resize(width_);
  out.peaks.resize(passes::peaks_of(width_));
  out.known = true;
  rows_.set(r - first_, view(row(r)));
  passes::weigh(weighed_.data(), weights_.data(), weights_.size(), out.of.data(), out.peaks.data(), width_);
}

ColumnPoint Columns::column_point(std::int64_t r, std::size_t column, const FeaturePoint& feature) const {
  ColumnPoint point;
  point.column = left_ + static_cast<std::int64_t>(column);
  point.s = static_cast<double>(point.column) * pitch_;
  point.feature = feature;
  point.feature.partner = -1;
  point.feature.line = row(r).line;
  point.feature.sample = row(r).source[column];
  return point;
}

// The rows that a fit may use: not beyond those that bend half as much themselves, nor beyond steps.
Reach Columns::rows_of_bend(std::int64_t row, std::size_t column, const Screen& screen, bool walls) const {
  const auto reach = static_cast<std::int64_t>(reach_), near = sees_arcs_ ? screen.window : screen.window / 2;
  const auto bend = [&](std::int64_t k) { return std::abs((rows_[k].*screen.bend)[column]); };
  const float half = 0.5F * bend(row);
  const auto peak = [&](std::int64_t k) {
    return bend(k) >= half && k > 0 && k + 1 < rows_.size() && bend(k) >= bend(k - 1) && bend(k) >= bend(k + 1);
  };
  const std::int64_t least = std::max<std::int64_t>(0, row - reach), most = std::min(rows_.size() - 1, row + reach);
  std::int64_t low = row, high = row;
  while (low > least && !(walls && rows_.is_of_step(low - 1, column)))
    if (--low < row - near && peak(low)) break;
  while (high < most && !(walls && rows_.is_of_step(high, column)))
    if (++high > row + near && peak(high)) break;
  return {static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(high), 0, 0};
}

void Columns::measure_bend(std::int64_t r, std::size_t column, const Screen& screen, const Sampling& sampling,
                           const FitScale& scale, std::vector<ColumnPoint>& out) {
  const std::int64_t at = r - first_;
  const auto row = static_cast<std::uint32_t>(at);
  const bool convex = (rows_[at].*screen.bend)[column] < 0.0F;
  // The rows of one rounding see the same edge.
  if (r < roundings_[column].end && convex == roundings_[column].convex) return;
  const bool walls = has_walls(column, std::max(first_, r - static_cast<std::int64_t>(flank_reach_)));
  const Reach reach = rows_of_bend(at, column, screen, walls);
  if (row - reach.before < kFewest || reach.after - row < kFewest) return;
  const Precedent before = beside(r, column, convex);
  auto bend = before.applies(convex) ? fit(at, column, reach, walls, &before, scale) : std::nullopt;
  edges_[column] = {r, before.next()};
  if (!bend) {
    bend = fit(at, column, reach, walls, nullptr, scale);
    edges_[column].precedent = bend ? Precedent::of(*bend, scale) : Precedent();
  }
  if (!bend || is_part_of_step(*bend, scale)) return;
  if (bend->rounding > 0.0) roundings_[column] = {r + (bend->flank_after - column_.index(at)), bend->tau < 0.0};
  ColumnPoint point = column_point(r, column, make_point(*bend, 0, scale));
  const auto own = static_cast<double>(std::abs((rows_[at].*screen.bend)[column]));
  point.feature.width =
      std::log2(std::max(1.0, own * static_cast<double>(screen.window) * sampling.spacing / 4.0 / least_distance(scale.noise)));
  out.push_back(point);
}

// An edge goes on as it was in the columns beside.
Precedent Columns::beside(std::int64_t r, std::size_t column, bool convex) const noexcept {
  constexpr std::int64_t kNear = 2; // rows
  for (const std::size_t other : {column - std::min<std::size_t>(column, 1), std::min(column + 1, width_ - 1)})
    if (r - edges_[other].row <= kNear && edges_[other].precedent.applies(convex)) return edges_[other].precedent;
  return {};
}

// The bend of a column around a row, as the one before was or whatever it is.
std::optional<Bend> Columns::fit(std::int64_t row, std::size_t column, Reach reach, bool walls, const Precedent* before,
                                 const FitScale& scale) {
  const bool near = before != nullptr && !walls;
  column_.take(rows_, row, static_cast<std::int64_t>(near ? reach_ : flank_reach_), column, base_);
  const std::uint32_t k = column_.index(row);
  reach.last = column_.size() - 1;
  reach.before = column_.index(reach.before);
  reach.after = std::min(column_.index(reach.after), reach.last);
  if (k < reach.before + kFewest || k + kFewest > reach.after) return std::nullopt;
  walls_.clear();
  if (walls) bound_by_steps(k, scale, reach);
  if (k <= reach.before || k >= reach.after) return std::nullopt;
  return before != nullptr ? find_sharp_bend(column_.heights(), k, reach, before->clockwise, scale)
                           : find_bend(column_.heights(), k, reach, scale);
}

// No fit reaches beyond a step.
void Columns::bound_by_steps(std::uint32_t k, const FitScale& scale, Reach& reach) {
  find_walls(column_.heights(), 0, column_.size(), scale, walls_);
  for (const WallRun& wall : walls_) {
    if (!wall.step) continue;
    if (wall.last <= k) reach.first = std::max(reach.first, wall.last);
    if (wall.first >= k) reach.last = std::min(reach.last, wall.first);
  }
  reach.before = std::max(reach.before, reach.first);
  reach.after = std::min(reach.after, reach.last);
}

// Whether a bend of column_ lies within a step, or in what rounds its edges.
bool Columns::is_part_of_step(const Bend& bend, const FitScale& scale) {
  const Heights heights = column_.heights();
  for (std::size_t i = 0; i < walls_.size(); ++i) {
    if (!walls_[i].step || !may_round_to(heights, 0, column_.size(), walls_, i, scale, bend.s)) continue;
    found_.clear();
    ::scansion::measure_step(heights, 0, column_.size(), walls_, i, scale, found_);
    const WallRun& wall = walls_[i];
    if (bend.s >= heights.s[wall.low] - scale.pitch && bend.s <= heights.s[wall.high] + scale.pitch) return true;
    for (const FeaturePoint& edge : found_)
      if ((bend.tau < 0.0) == edge.convex() && std::abs(bend.s - edge.s) <= edge.window * scale.pitch &&
          is_part(bend.tau, bend.window, edge))
        return true;
  }
  return false;
}

// The step whose wall starts between row r and the next one.
void Columns::measure_step(std::int64_t r, std::size_t column, const FitScale& scale, std::vector<ColumnPoint>& out) {
  const std::int64_t at = r - first_;
  column_.take(rows_, at, static_cast<std::int64_t>(flank_reach_), column, base_);
  const Heights heights = column_.heights();
  const std::uint32_t end = column_.size();
  walls_.clear();
  find_walls(heights, 0, end, scale, walls_);
  const std::uint32_t first = column_.index(at);
  const auto wall = std::find_if(walls_.begin(), walls_.end(), [&](const WallRun& w) { return w.step && w.first == first; });
  if (wall == walls_.end()) return;
  found_.clear();
  ::scansion::measure_step(heights, 0, end, walls_, static_cast<std::size_t>(wall - walls_.begin()), scale, found_);
  for (const FeaturePoint& found : found_) {
    ColumnPoint point = column_point(r, column, found);
    const double height = std::abs(found_.front().w - found_.back().w);
    point.feature.width = std::log2(std::max(1.0, 0.5 * height / least_distance(scale.noise)));
    out.push_back(point);
  }
}

void Columns::view_rows() {
  rows_.clear();
  for (std::int64_t r = first_; r < next_; ++r) rows_.add(view(row(r)));
}

void Columns::harvest(std::int64_t r, const Sampling& sampling, std::vector<ColumnPoint>& out) {
  const FitScale scale = FitScale::of(sampling.noise, sampling.spacing, sampling.coarse(), sampling.limits);
  const auto near = std::max<std::int64_t>(1, static_cast<std::int64_t>(wanted_) / 2);
  narrow_ = {&ColumnRow::bend, static_cast<std::int64_t>(window_), near, least_bend(window_, sampling)};
  wide_ = {&ColumnRow::wide, static_cast<std::int64_t>(wanted_), near, least_bend(wanted_, sampling)};
  const WallTest test(scale);
  rows_.set_test(test);
  if (marked_above_ > sampling.noise) { // by a row that is held no more, perhaps
    marked_above_ = 0.0;
    for (std::int64_t k = first_; k < next_; ++k) marked_above_ = std::max(marked_above_, row(k).marked_above);
  }
  trusted_ = marked_above_ <= sampling.noise;
  const std::int64_t at = r - first_;
  const ColumnRow& centre = rows_[at];
  const ColumnRow& next = at + 1 < rows_.size() ? rows_[at + 1] : centre;
  // Every interval of a wall is larger.
  const auto wall = static_cast<float>(std::max(test.noise, 0.49 * (next.c - centre.c)));
  const std::size_t narrow = find_bends(at, row(r).narrow, narrow_, bent_);
  const std::size_t wide = looks_wide(sampling) ? find_bends(at, row(r).wide, wide_, widely_bent_) : 0;
  stepped_.resize(width_);
  const bool no_walls = trusted_ && last_marked_ <= r;
  const std::size_t stepped = no_walls ? 0 : passes::apart(next.height, centre.height, wall, stepped_.data(), width_);
  for (const std::uint32_t j : std::span(bent_).first(narrow)) measure_bend(r, j, narrow_, sampling, scale, out);
  for (const std::uint32_t j : std::span(stepped_).first(stepped))
    if (has_walls(j, r) && rows_.starts_step(at, j)) measure_step(r, j, scale, out);
  for (const std::uint32_t j : std::span(widely_bent_).first(wide))
    if (!bends_nearby(at, j)) measure_bend(r, j, wide_, sampling, scale, out);
}

// The columns in which no row near this one bends more; returns how many they are.
std::size_t Columns::find_bends(std::int64_t row, const Bends& bends, const Screen& screen,
                                std::vector<std::uint32_t>& columns) {
  if (!bends.known) return 0;
  const std::int64_t low = std::max<std::int64_t>(0, row - screen.near), high = std::min(rows_.size() - 1, row + screen.near);
  weighed_.clear();
  for (std::int64_t k = low; k <= high; ++k)
    if (k != row) weighed_.push_back(rows_[k].*screen.bend);
  const std::span<const float* const> beside = weighed_;
  const auto before = static_cast<std::size_t>(row - low);
  columns.resize(width_);
  return passes::most_bent({bends.of.data(), bends.peaks.data(), beside.first(before), beside.subspan(before)}, screen.least,
                           columns.data(), width_);
}

// Whether a row within a wide window bends clearly over the least window.
bool Columns::bends_nearby(std::int64_t row, std::size_t column) const {
  const std::int64_t low = std::max<std::int64_t>(0, row - wide_.window), high = std::min(rows_.size() - 1, row + wide_.window);
  for (std::int64_t k = low; k <= high; ++k)
    if (std::abs(rows_[k].bend[column]) >= narrow_.least) return true;
  return false;
}

} // namespace scansion
