// Choosing the alpha-set from the lines themselves (docs/FORMAT.md, "Levels").
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/kernels.hpp"
#include "pipeline/pipeline.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {
namespace {

// The finest level keeps about this share of the inner points, unless the noise is larger.
constexpr double kShare = 0.07;
// A group whose finest level keeps this many times more or fewer points has left the range.
constexpr double kShareRange = 4.0;
constexpr double kSigmas = 5.5;
// A smaller change of the finest tolerance is not worth an epoch: on pure noise the share alone would ask for one every group.
constexpr double kWorthMoving = 1.5;
constexpr std::uint32_t kMaxEpoch = 0xFFFF; // a 16 bit field of the payload header
// Fewer inner points say nothing about a scan.
constexpr std::size_t kEnoughPoints = 256;

// Finite distances of a sample of the points: the share of a few per cent is as well seen in thousands as in all.
void sample_distances(const GroupRanks& ranks, std::size_t sample, std::vector<double>& out) {
  const std::size_t stride = std::max<std::size_t>(1, ranks.distance.size() / sample);
  out.clear();
  for (std::size_t i = 0; i < ranks.distance.size(); i += stride)
    if (const double d = ranks.distance[i]; std::isfinite(d)) out.push_back(d);
}

// The largest finite distance; 0 without inner points.
double largest_distance(const GroupRanks& ranks) noexcept {
  double largest = 0.0;
  for (const double d : ranks.distance)
    if (std::isfinite(d)) largest = std::max(largest, d);
  return largest;
}

// Standard deviation of the noise across the line in mm, from the distances of points to the segment of their neighbours: on a
// smooth line such a distance is the second difference of the noise, halved.
double noise_sigma(const LineGroup& group, Rational resolution, std::vector<double>& scratch) {
  constexpr std::size_t kSample = 2048;
  const std::size_t stride = std::max<std::size_t>(1, group.points() / kSample);
  scratch.clear();
  for (const Run& run : group.runs) {
    const auto axis = [&](std::size_t a) { return std::span(group.xyz[a]).subspan(run.first, run.count); };
    const RunPoints points{axis(0), axis(1), axis(2), {}};
    for (std::size_t i = 1; i + 1 < run.count; i += stride)
      scratch.push_back(segment_distance(points, i, i - 1, i + 1, resolution));
  }
  if (scratch.empty()) return 0.0;
  const auto middle = scratch.begin() + static_cast<std::ptrdiff_t>(scratch.size() / 2);
  std::nth_element(scratch.begin(), middle, scratch.end());
  constexpr double kMedianToSigma = 1.4826;
  return kMedianToSigma * *middle / std::sqrt(1.5);
}

} // namespace

std::vector<double> Calibrator::calibrate(const LineGroup& group, const GroupRanks& ranks, Rational resolution_mm) {
  std::vector<double> tolerances(spec_.count);
  if (spec_.kind == LevelSpec::Kind::uniform) {
    const double d_max = largest_distance(ranks);
    const double largest = d_max > 0 ? d_max : resolution_mm.value();
    for (std::uint32_t i = 0; i < spec_.count; ++i) tolerances[i] = largest * (spec_.count - i) / spec_.count;
    return tolerances;
  }
  double finest = 0.0;
  constexpr std::size_t kSample = 8192;
  sample_distances(ranks, kSample, scratch_);
  if (!scratch_.empty()) {
    const auto kept = static_cast<std::ptrdiff_t>(kShare * static_cast<double>(scratch_.size()));
    std::nth_element(scratch_.begin(), scratch_.begin() + kept, scratch_.end(), std::greater<>());
    finest = scratch_[static_cast<std::size_t>(kept)];
  }
  finest = std::max({finest, kSigmas * noise_sigma(group, resolution_mm, scratch_), resolution_mm.value()});
  for (std::uint32_t i = spec_.count; i-- > 0;) {
    tolerances[i] = finest;
    finest *= spec_.ratio;
  }
  return tolerances;
}

const AlphaSet& Calibrator::next(const LineGroup& group, const GroupRanks& ranks, Rational resolution_mm) {
  const bool fixed =
      spec_.kind == LevelSpec::Kind::explicit_list || (spec_.kind == LevelSpec::Kind::uniform && spec_.d_max > 0);
  if (alpha_.tolerances.empty() && fixed) {
    alpha_.tolerances = spec_.explicit_tolerances;
    if (spec_.kind == LevelSpec::Kind::uniform)
      for (std::uint32_t i = 0; i < spec_.count; ++i)
        alpha_.tolerances.push_back(spec_.d_max * (spec_.count - i) / spec_.count);
  }
  if (fixed) return alpha_;

  std::size_t ends = 0; // their distances are infinite
  for (const Run& run : group.runs) ends += std::min<std::size_t>(run.count, 2);
  const std::size_t inner = group.points() - ends;
  bool change = alpha_.tolerances.empty();
  if (!change && inner >= kEnoughPoints) {
    if (!calibrated_) {
      change = true; // the set in force was made from too few points
    } else if (spec_.kind == LevelSpec::Kind::uniform) {
      const double farthest = largest_distance(ranks);
      change = farthest > alpha_.tolerances.front() || (farthest > 0 && farthest < alpha_.tolerances.front() / kShareRange);
    } else {
      const std::size_t kept = kernels::count_above(ranks.distance.data(), alpha_.tolerances.back(), ranks.distance.size());
      const double share = static_cast<double>(kept - ends) / static_cast<double>(inner);
      change = share > kShare * kShareRange || share < kShare / kShareRange;
    }
  }
  if (change) {
    std::vector<double> tolerances = calibrate(group, ranks, resolution_mm);
    calibrated_ = inner >= kEnoughPoints;
    const double moved = alpha_.tolerances.empty() ? 1.0 : tolerances.back() / alpha_.tolerances.back();
    const bool worth = moved > kWorthMoving || moved < 1 / kWorthMoving || spec_.kind == LevelSpec::Kind::uniform;
    if (alpha_.tolerances.empty()) {
      alpha_.tolerances = std::move(tolerances);
    } else if (worth && tolerances != alpha_.tolerances && alpha_.epoch < kMaxEpoch) {
      alpha_.tolerances = std::move(tolerances);
      ++alpha_.epoch;
    }
  }
  return alpha_;
}

} // namespace scansion
