// Votes of triples of points; the commonest answer, and how far stretches of the line agree on it.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/profile/backlash.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

constexpr double kMost = 1.0;          // mm, or two pitches: a larger backlash is a broken machine
constexpr double kMostSpacings = 3.0;  // between the lines of a triple
constexpr double kFlattest = 2.5;      // mm along the lines a mm across: edges that lie flatter are found across the lines
constexpr double kSteepest = 1.2;      // mm of height a mm across
constexpr double kTurning = 25.0;      // degrees between points of one edge
constexpr std::size_t kMostPairs = 64; // of neighbours of one point
constexpr double kPart = 8.0;          // coarse steps: what lies closer together along the line may share its error
constexpr double kLikely = 1.5;        // times the weight of any other answer

bool is_alike(const FeaturePoint& a, const FeaturePoint& b) noexcept {
  return a.convex() == b.convex() && a.step == b.step && std::abs(a.tau - b.tau) < kTurning;
}

double reach_of(const Sampling& sampling) noexcept {
  return std::max(kMost, 2.0 * sampling.pitch);
}

} // namespace

void BacklashEstimator::add(const Profile& profile, double taken_off, std::span<const FeaturePoint> points,
                            const Sampling& sampling) {
  if (!first_turned_) first_turned_ = profile.turned;
  std::rotate(rows_.begin(), rows_.begin() + 1, rows_.end()); // the oldest gives its memory to the newest
  Row& row = rows_.back();
  row.c = profile.c;
  row.against = is_against(profile.turned);
  row.points.assign(points.begin(), points.end());
  for (FeaturePoint& p : row.points) p.s += taken_off;
  rows_known_ = std::min(rows_known_ + 1, rows_.size());
  const auto& [before, middle, after] = rows_;
  if (rows_known_ < rows_.size() || before.against != after.against || before.against == middle.against) return;
  if (after.c - before.c > 2.0 * kMostSpacings * sampling.spacing) return;
  compare(before, middle, after, sampling);
}

void BacklashEstimator::compare(const Row& before, const Row& middle, const Row& after, const Sampling& sampling) {
  const double back = middle.c - before.c, on = after.c - middle.c;
  if (back <= 0.0 || on <= 0.0) return;
  const double share = back / (back + on); // of the line after in the mean of both
  const double most = reach_of(sampling), noise = 6.0 * sampling.noise + 0.4 * sampling.pitch;
  const auto first_near = [](const Row& row, double s) {
    return std::lower_bound(row.points.begin(), row.points.end(), s, [](const FeaturePoint& p, double at) { return p.s < at; });
  };
  for (const FeaturePoint& m : middle.points) {
    if (m.guided) continue;
    ++looked_at_;
    std::size_t pairs = 0;
    const double reach = most + kFlattest * back;
    for (auto a = first_near(before, m.s - reach); a != before.points.end() && a->s <= m.s + reach; ++a) {
      if (!is_alike(*a, m) || std::abs(a->w - m.w) > kSteepest * back + noise) continue;
      const double slant = kFlattest * (back + on);
      for (auto z = first_near(after, a->s - slant); z != after.points.end() && z->s <= a->s + slant; ++z) {
        if (!is_alike(*z, m) || std::abs(a->w + (z->w - a->w) * share - m.w) > noise) continue;
        if (++pairs > kMostPairs) break;
        const double b = m.s - (a->s + (z->s - a->s) * share);
        if (std::abs(b) > most) continue;
        const double lean = (z->s - a->s) / (back + on), least = 0.1 * sampling.pitch;
        const double variance =
            least * least + m.sigma_s * m.sigma_s + 0.25 * (a->sigma_s * a->sigma_s + z->sigma_s * z->sigma_s);
        vote({middle.against ? b : -b, m.s, 1.0 / (variance * (1.0 + lean * lean)), m.step, 0});
      }
    }
  }
}

void BacklashEstimator::vote(Vote vote) {
  vote.point = looked_at_;
  if (votes_.size() < kMostVotes) {
    votes_.push_back(vote);
    return;
  }
  votes_[next_] = vote;
  next_ = (next_ + 1) % kMostVotes;
}

// The middle of the heaviest stretch of `reach` to both sides; empty when another one weighs almost as much.
std::optional<double> BacklashEstimator::find_mode(double reach) const {
  const auto heaviest = [&](double from, double to) {
    Mode best;
    double sum = 0.0;
    for (std::size_t first = 0, last = 0; last < sorted_.size(); ++last) {
      if (sorted_[last].b >= from && sorted_[last].b <= to) sum += sorted_[last].weight;
      for (; sorted_[first].b < sorted_[last].b - 2.0 * reach; ++first)
        if (sorted_[first].b >= from && sorted_[first].b <= to) sum -= sorted_[first].weight;
      if (sum > best.weight) best = {0.5 * (std::max(sorted_[first].b, from) + sorted_[last].b), sum};
    }
    return best;
  };
  constexpr double kFar = 1e300;
  const Mode best = heaviest(-kFar, kFar);
  const Mode other = std::max(heaviest(-kFar, best.middle - 1.5 * reach), heaviest(best.middle + 1.5 * reach, kFar),
                              [](const Mode& a, const Mode& b) { return a.weight < b.weight; });
  if (best.weight < kLikely * other.weight) return std::nullopt;
  return best.middle;
}

// From the spread between parts of the line: an edge along the way across falls on the same samples of every line, and errs
// on all of them alike.
double BacklashEstimator::uncertainty(double mean, double reach, const Sampling& sampling) {
  constexpr double kStep = 0.15, kBend = 0.04; // pitches: of a part at least
  near_.clear();
  for (const Vote& v : sorted_)
    if (std::abs(v.b - mean) <= reach) near_.push_back(v);
  std::sort(near_.begin(), near_.end(), [](const Vote& a, const Vote& b) { return a.s != b.s ? a.s < b.s : a.b < b.b; });
  const double part = kPart * sampling.coarse();
  double all = 0.0, spread = 0.0, least = 0.0;
  std::size_t parts = 0;
  for (std::size_t first = 0; first < near_.size();) {
    double weight = 0.0, sum = 0.0, steps = 0.0;
    std::size_t last = first;
    for (; last < near_.size() && near_[last].s < near_[first].s + part; ++last) {
      weight += near_[last].weight;
      sum += near_[last].weight * near_[last].b;
      if (near_[last].step) steps += near_[last].weight;
    }
    const double off = sum / weight - mean;
    const double floor = (kBend + (kStep - kBend) * steps / weight) * sampling.pitch;
    all += weight;
    spread += weight * weight * off * off;
    least += weight * weight * floor * floor;
    ++parts;
    first = last;
  }
  if (parts < 2) return 1e300;
  // Two parts may agree by chance: that tells whole pitches and no less.
  constexpr double kOfTwo = 0.3; // pitches
  const double sigma = std::sqrt(std::max(spread * static_cast<double>(parts) / static_cast<double>(parts - 1), least)) / all;
  return parts == 2 ? std::max(sigma, kOfTwo * sampling.pitch) : sigma;
}

std::optional<Backlash> BacklashEstimator::value(const Sampling& sampling) {
  constexpr std::size_t kFewest = 10; // votes
  if (votes_.size() < kFewest) return std::nullopt;
  sorted_.assign(votes_.begin(), votes_.end());
  std::sort(sorted_.begin(), sorted_.end(), [](const Vote& a, const Vote& b) { return a.b != b.b ? a.b < b.b : a.s < b.s; });
  const double reach = sampling.pitch;
  const std::optional<double> mode = find_mode(reach);
  if (!mode) return std::nullopt;
  // The median, then the mean of what lies around it: steps tell whole pitches, and only their mean knows the share between.
  double all = 0.0, half = 0.0;
  for (const Vote& v : sorted_)
    if (std::abs(v.b - *mode) <= reach) all += v.weight;
  double middle = *mode;
  for (const Vote& v : sorted_) {
    if (std::abs(v.b - *mode) > reach) continue;
    middle = v.b;
    if ((half += v.weight) >= 0.5 * all) break;
  }
  double weight = 0.0, sum = 0.0;
  Backlash out;
  for (const Vote& v : sorted_) {
    if (std::abs(v.b - middle) > reach) continue;
    weight += v.weight;
    sum += v.weight * v.b;
    ++out.places;
  }
  out.mm = sum / weight;
  out.deviation_mm = uncertainty(out.mm, reach, sampling);
  // Where no edge crosses the lines, few points have neighbours, and these by chance.
  constexpr double kLeastShare = 0.15;
  const std::uint64_t since = votes_[votes_.size() < kMostVotes ? 0 : next_].point;
  const double share = static_cast<double>(out.places) / static_cast<double>(looked_at_ - since + 1);
  if (out.places < kFewest || share < kLeastShare || out.deviation_mm > sampling.pitch) return std::nullopt;
  return out;
}

} // namespace scansion
