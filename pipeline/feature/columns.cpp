// Slopes before and after a row, for all columns at once; what bends most is then measured like a point of a profile.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/columns.hpp"

#include "pipeline/feature/detector.hpp"

#include <cmath>
#include <limits>

namespace scansion {

namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr float kLeastSlopeChange = 0.1228F; // tan 7 degrees
constexpr double kMostMissed = 3.6;          // spacings within a window
constexpr std::size_t kBlock = 32;           // columns
constexpr std::size_t kMostFlank = 64;       // rows

} // namespace

Columns::Columns(const Sampling& sampling) : pitch_(sampling.pitch) {
  // Narrow features want narrow windows; the noise decides how narrow.
  wanted_ = FitScale::wanted_window(sampling.noise, sampling.spacing);
  window_ = std::max(kNarrowest, (wanted_ + 2) / 3);
  reach_ = std::max(kReach * window_, kLeastReach);
  const std::size_t rounding = FitScale::of(sampling.noise, sampling.spacing, sampling.coarse()).widest_gap();
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
  for (Row& r : ring_) {
    for (auto* values : {&r.height, &r.bend}) {
      std::vector<float> moved(new_width, kNone);
      std::copy(values->begin(), values->end(), moved.begin() + static_cast<std::ptrdiff_t>(shift));
      *values = std::move(moved);
    }
    std::vector<std::uint32_t> source(new_width, 0);
    std::copy(r.source.begin(), r.source.end(), source.begin() + static_cast<std::ptrdiff_t>(shift));
    r.source = std::move(source);
  }
  left_ = new_left;
  width_ = new_width;
  return true;
}

void Columns::resample(const Profile& profile, const Sampling& sampling, Row& out) const {
  constexpr double kWidest = 3.5; // pitches between samples
  std::fill(out.height.begin(), out.height.end(), kNone);
  const double jump = std::max(6.0 * sampling.noise, 1.5 * sampling.pitch);
  const double* const s = profile.s.data();
  const double* const w = profile.w.data();
  float* const height = out.height.data() - left_;
  std::uint32_t* const source = out.source.data() - left_;
  std::uint32_t k = 0;
  for (const std::uint32_t end : profile.ends) {
    const auto first = static_cast<std::int64_t>(std::ceil(s[k] / pitch_));
    const auto last = static_cast<std::int64_t>(std::floor(s[end - 1] / pitch_));
    for (std::int64_t j = first; j <= last; ++j) {
      const double place = static_cast<double>(j) * pitch_;
      while (k + 2 < end && s[k + 1] < place) ++k;
      if (k + 1 >= end) break;
      const double ds = s[k + 1] - s[k], dw = w[k + 1] - w[k], t = place - s[k];
      if (ds > kWidest * sampling.pitch) continue;
      const bool nearer = t < ds - t;
      height[j] = static_cast<float>((std::abs(dw) > jump ? (nearer ? w[k] : w[k + 1]) : w[k] + dw * (t / ds)) - base_);
      source[j] = profile.source[nearer ? k : k + 1];
    }
    k = end;
  }
}

void Columns::add(const Profile& profile, const Sampling& sampling, std::vector<ColumnPoint>& out) {
  if (profile.size() < 2 || !make_room(profile.s.front(), profile.s.back())) return;
  if (next_ == 0) base_ = profile.w[0];
  const std::int64_t r = next_++;
  first_ = std::max(first_, next_ - static_cast<std::int64_t>(ring_.size()));
  Row& newest = row(r);
  newest.c = profile.c;
  newest.line = profile.line;
  resample(profile, sampling, newest);
  std::fill(newest.bend.begin(), newest.bend.end(), kNone);
  const auto n = static_cast<std::int64_t>(window_);
  if (r >= n) screen(r - n, sampling);
  const auto late = static_cast<std::int64_t>(lag());
  if (r >= late) harvest(r - late, sampling, out);
}

void Columns::finish(const Sampling& sampling, std::vector<ColumnPoint>& out) {
  const auto n = static_cast<std::int64_t>(window_), late = static_cast<std::int64_t>(lag());
  for (std::int64_t r = std::max<std::int64_t>(first_, next_ - n); r < next_; ++r) screen(r, sampling);
  for (std::int64_t r = std::max<std::int64_t>(first_, next_ - late); r < next_; ++r) harvest(r, sampling, out);
}

// Slope after minus slope before for row r: one weighted sum of rows.
void Columns::screen(std::int64_t r, const Sampling& sampling) {
  Row& centre = row(r);
  const auto n = static_cast<std::int64_t>(window_);
  // At least two rows a side; fewer than N at the ends of the scan.
  const std::int64_t low = std::max(first_, r - n), high = std::min(next_ - 1, r + n);
  if (r - low < 2 || high - r < 2) return;
  const auto weigh = [&](std::int64_t from, std::int64_t to, std::vector<double>& weights) {
    double mean = 0.0, square = 0.0;
    for (std::int64_t k = from; k <= to; ++k) mean += row(k).c;
    mean /= static_cast<double>(to - from + 1);
    for (std::int64_t k = from; k <= to; ++k) square += (row(k).c - mean) * (row(k).c - mean);
    weights.clear();
    for (std::int64_t k = from; k <= to; ++k) weights.push_back(square > 0.0 ? (row(k).c - mean) / square : 0.0);
  };
  for (std::int64_t k = low + 1; k <= high; ++k)
    if (row(k).c - row(k - 1).c > kMostMissed * sampling.spacing) return;
  weigh(low, r - 1, before_);
  weigh(r + 1, high, after_);
  float* bend = centre.bend.data();
  std::fill(centre.bend.begin(), centre.bend.end(), 0.0F);
  const auto accumulate = [&](std::int64_t k, double weight) {
    const float* height = row(k).height.data();
    const auto factor = static_cast<float>(weight);
    for (std::size_t j = 0; j < width_; ++j) bend[j] += factor * height[j];
  };
  for (std::int64_t k = low; k < r; ++k) accumulate(k, -before_[static_cast<std::size_t>(k - low)]);
  for (std::int64_t k = r + 1; k <= high; ++k) accumulate(k, after_[static_cast<std::size_t>(k - r - 1)]);
}

// Copies a column around row r into s_, w_ without its holes, and notes its steepest_ interval.
void Columns::copy_column(std::int64_t r, std::size_t column, std::int64_t reach) {
  const std::int64_t low = std::max(first_, r - reach), high = std::min(next_ - 1, r + reach);
  s_.resize(static_cast<std::size_t>(high - low + 1));
  w_.resize(s_.size());
  std::size_t n = 0, slot = static_cast<std::size_t>(low) % ring_.size();
  float before = kNone, steepest = 0.0F;
  for (std::int64_t k = low; k <= high; ++k, slot = slot + 1 == ring_.size() ? 0 : slot + 1) {
    const float height = ring_[slot].height[column];
    if (std::isnan(height)) continue;
    s_[n] = ring_[slot].c;
    w_[n++] = static_cast<double>(height) + base_;
    steepest = std::max(steepest, std::abs(height - before)); // a NaN is not greater
    before = height;
  }
  s_.resize(n);
  w_.resize(n);
  steepest_ = static_cast<double>(steepest);
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

void Columns::measure_bend(std::int64_t r, std::size_t column, const Sampling& sampling, const FitScale& scale,
                           std::vector<ColumnPoint>& out) {
  // The fit does not pass rows that bend half as much themselves, nor steps.
  const float own = std::abs(row(r).bend[column]);
  const auto reach = static_cast<std::int64_t>(reach_);
  const auto n = static_cast<std::int64_t>(window_);
  std::int64_t low = r, high = r;
  const WallTest test(scale);
  const auto peak = [&](std::int64_t k) {
    if (std::abs(k - r) <= n / 2 || !has(k - 1) || !has(k + 1)) return false;
    const float b = std::abs(row(k).bend[column]);
    return b >= 0.5F * own && b >= std::abs(row(k - 1).bend[column]) && b >= std::abs(row(k + 1).bend[column]);
  };
  while (low - 1 >= std::max(first_, r - reach) && !is_of_step(low - 1, column, test))
    if (peak(--low)) break;
  while (high + 1 <= std::min(next_ - 1, r + reach) && !is_of_step(high, column, test))
    if (peak(++high)) break;
  if (r - low < 2 || high - r < 2) return;
  copy_column(r, column, static_cast<std::int64_t>(flank_reach_));
  const auto index = [&](double c) {
    return static_cast<std::uint32_t>(std::lower_bound(s_.begin(), s_.end(), c) - s_.begin());
  };
  const auto last = static_cast<std::uint32_t>(s_.size() - 1);
  Reach bounds{index(row(low).c), std::min(index(row(high).c), last), 0, last};
  const std::uint32_t k = index(row(r).c);
  if (k < bounds.before + 2 || k + 2 > bounds.after) return;
  bound_by_steps(row(r).c, scale, bounds);
  if (k <= bounds.before || k >= bounds.after) return;
  const auto bend = find_bend({s_, w_}, k, bounds, scale);
  if (!bend || is_part_of_step(*bend, scale)) return;
  ColumnPoint point = column_point(r, column, make_point(*bend, 0, scale));
  point.feature.width = std::log2(std::max(1.0, std::abs(static_cast<double>(own)) * static_cast<double>(window_) *
                                                    sampling.spacing / 4.0 / least_distance(scale.noise)));
  out.push_back(point);
}

// No fit reaches beyond a step.
void Columns::bound_by_steps(double c, const FitScale& scale, Reach& reach) {
  found_.clear();
  walls_.clear();
  if (steepest_ <= WallTest(scale).weak) return;
  steps_.find({s_, w_}, 0, static_cast<std::uint32_t>(s_.size()), scale, found_, walls_);
  for (const WallRun& wall : walls_) {
    if (!wall.step) continue;
    if (s_[wall.last] <= c) reach.first = std::max(reach.first, wall.last);
    if (s_[wall.first] >= c) reach.last = std::min(reach.last, wall.first);
  }
  reach.before = std::max(reach.before, reach.first);
  reach.after = std::min(reach.after, reach.last);
}

// Whether a bend of the column in s_, w_ lies within a step, or in what rounds its edges.
bool Columns::is_part_of_step(const Bend& bend, const FitScale& scale) const {
  const bool within = std::any_of(walls_.begin(), walls_.end(), [&](const WallRun& wall) {
    return wall.step && bend.s >= s_[wall.low] - scale.pitch && bend.s <= s_[wall.high] + scale.pitch;
  });
  return within || std::any_of(found_.begin(), found_.end(), [&](const FeaturePoint& edge) {
           return (bend.tau < 0.0) == edge.convex() && std::abs(bend.s - edge.s) <= edge.window * scale.pitch &&
                  is_part(bend.tau, bend.window, edge);
         });
}

// Rise from row r to the next one; not a number: one of them has no height there.
double Columns::rise(std::int64_t r, std::size_t column) const {
  if (!has(r) || !has(r + 1)) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(row(r + 1).height[column]) - static_cast<double>(row(r).height[column]);
}

// Whether a wall that rises or falls goes on from row r to the next one.
bool Columns::grows(std::int64_t r, std::size_t column, bool rising, const WallTest& test) const {
  return has(r) && has(r + 1) && test.grows(row(r + 1).c - row(r).c, rise(r, column), rising);
}

// Whether a wall that seeds itself between rows low and high is a step, and no slope with samples enough.
bool Columns::is_step(std::int64_t low, std::int64_t high, std::size_t column, const WallTest& test) const {
  if (high - low <= static_cast<std::int64_t>(kMostIntervals)) return true;
  if (high - low > static_cast<std::int64_t>(kMostRounded)) return false;
  std::int64_t steepest = low;
  for (std::int64_t k = low + 1; k < high; ++k)
    if (std::abs(rise(k, column)) > std::abs(rise(steepest, column))) steepest = k;
  return test.is_upright(row(steepest + 1).c - row(steepest).c, rise(steepest, column), rise(steepest - 1, column),
                         rise(steepest + 1, column));
}

// Whether the interval from row r to the next one is the first of a wall that is a step.
bool Columns::starts_step(std::int64_t r, std::size_t column, const WallTest& test) const {
  const bool rising = rise(r, column) > 0.0;
  if (grows(r - 1, column, rising, test)) return false;
  bool seeded = false;
  std::int64_t k = r;
  do {
    seeded = seeded || test.seeds(row(k + 1).c - row(k).c, rise(k, column), rise(k - 1, column), rise(k + 1, column));
    ++k;
  } while (grows(k, column, rising, test) && k - r <= static_cast<std::int64_t>(kMostRounded));
  return seeded && is_step(r, k, column, test);
}

// Whether the interval from row r to the next one is a steep one of a wall that is a step.
bool Columns::is_of_step(std::int64_t r, std::size_t column, const WallTest& test) const {
  const double dw = rise(r, column);
  if (!(std::abs(dw) > test.strong && std::abs(dw) > WallTest::kSlope * (row(r + 1).c - row(r).c))) return false;
  std::int64_t low = r, high = r + 1;
  const auto few = [&] { return high - low <= static_cast<std::int64_t>(kMostRounded); };
  while (few() && grows(low - 1, column, dw > 0.0, test)) --low;
  while (few() && grows(high, column, dw > 0.0, test)) ++high;
  return is_step(low, high, column, test);
}

// The step whose wall starts between row r and the next one.
void Columns::measure_step(std::int64_t r, std::size_t column, const FitScale& scale, std::vector<ColumnPoint>& out) {
  copy_column(r, column, static_cast<std::int64_t>(flank_reach_));
  found_.clear();
  walls_.clear();
  const auto first = static_cast<std::uint32_t>(std::lower_bound(s_.begin(), s_.end(), row(r).c) - s_.begin());
  steps_.find({s_, w_}, 0, static_cast<std::uint32_t>(s_.size()), scale, found_, walls_, first);
  for (const FeaturePoint& found : found_) {
    ColumnPoint point = column_point(r, column, found);
    const double height = std::abs(found_.front().w - found_.back().w);
    point.feature.width = std::log2(std::max(1.0, 0.5 * height / least_distance(scale.noise)));
    out.push_back(point);
  }
}

void Columns::harvest(std::int64_t r, const Sampling& sampling, std::vector<ColumnPoint>& out) {
  const FitScale scale = FitScale::of(sampling.noise, sampling.spacing, sampling.coarse());
  const auto n = static_cast<double>(window_);
  const double length = n * sampling.spacing;
  const auto least = std::max(kLeastSlopeChange,
                              static_cast<float>(kLeastSignificance * scale.noise * std::sqrt(24.0 / (n * length * length))));
  const auto near = std::max<std::int64_t>(1, static_cast<std::int64_t>(wanted_) / 2);
  const Row& centre = row(r);
  const bool wall_possible = has(r + 1);
  const WallTest test(scale);
  // Every interval of a wall is larger.
  const double apart = wall_possible ? row(r + 1).c - centre.c : 0.0;
  const auto wall = static_cast<float>(std::max(test.noise, 0.49 * apart));
  const float* const below = wall_possible ? row(r + 1).height.data() : centre.height.data();
  // Most blocks show nothing.
  for (std::size_t block = 0; block < width_; block += kBlock) {
    const std::size_t end = std::min(width_, block + kBlock);
    int seen = 0;
    for (std::size_t j = block; j < end; ++j)
      seen |=
          static_cast<int>(std::abs(centre.bend[j]) >= least) | static_cast<int>(std::abs(below[j] - centre.height[j]) > wall);
    if (seen == 0) continue;
    for (std::size_t j = block; j < end; ++j) {
      if (std::abs(centre.bend[j]) >= least && bends_most(r, j, near)) measure_bend(r, j, sampling, scale, out);
      if (std::abs(below[j] - centre.height[j]) > wall && starts_step(r, j, test)) measure_step(r, j, scale, out);
    }
  }
}

// Whether no row within `near` of row r bends more the same way; the first of equal ones does.
bool Columns::bends_most(std::int64_t r, std::size_t column, std::int64_t near) const {
  const float own = row(r).bend[column];
  for (std::int64_t k = r - near; k <= r + near; ++k) {
    if (k == r || !has(k)) continue;
    const float other = row(k).bend[column] * (own < 0.0F ? -1.0F : 1.0F);
    if (k < r ? other >= std::abs(own) : other > std::abs(own)) return false;
  }
  return true;
}

} // namespace scansion
