// Axis, means and confirmation of tracks.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/link/track.hpp"

#include "pipeline/feature/link/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <vector>

namespace scansion {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
// Half openings of the cone of influence, by the points that tell where a track goes: 1, up to 3, more.
const double kNewborn = std::tan(68.0 * kDegree);
const double kYoung = std::tan(50.0 * kDegree);
const double kGrown = std::tan(30.0 * kDegree);

} // namespace

void TrackMeans::start(const FeaturePoint& point) noexcept {
  tau = point.tau;
  beta = point.orientation();
  width = point.width;
}

void TrackMeans::follow(const FeaturePoint& point) noexcept {
  constexpr double kGain = 0.3;
  tau += kGain * (point.tau - tau);
  beta += kGain * (point.orientation() - beta);
  width += kGain * (point.width - width);
}

Course Track::course_at(std::size_t i) const noexcept {
  constexpr std::size_t kReach = 4;
  const std::size_t low = i > kReach ? i - kReach : 0, high = std::min(points.size() - 1, i + kReach);
  const TrackPoint &a = points[low], &b = points[high];
  return {std::abs(s_of(b) - s_of(a)), std::abs(c_of(b) - c_of(a))};
}

void Track::cut_guided_end() {
  while (!points.empty() && points.back().feature.guided) points.pop_back();
}

Axis axis_of(const Track& track, TrackEnd end) {
  constexpr double kYoungTrust = 0.7;
  const std::size_t n = std::min(kAxisPoints, track.points.size());
  const TrackPoint* const apex = end == TrackEnd::back ? &track.points.back() : &track.points.front();
  const std::ptrdiff_t inwards = end == TrackEnd::back ? -1 : 1;
  const auto point = [&](std::size_t i) -> const TrackPoint& { return apex[inwards * static_cast<std::ptrdiff_t>(i)]; };
  Axis axis{apex->q, apex->w, apex->r, 0.0, 0.0, n == 1 ? kNewborn : n <= 3 ? kYoung : kGrown};
  if (n == 2) {
    const double dr = apex->r - point(1).r;
    axis.slope_q = kYoungTrust * (apex->q - point(1).q) / dr;
    axis.slope_w = kYoungTrust * (apex->w - point(1).w) / dr;
  } else if (n > 2) {
    double mr = 0.0, mq = 0.0, mw = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      mr += point(i).r;
      mq += point(i).q;
      mw += point(i).w;
    }
    const double share = 1.0 / static_cast<double>(n);
    mr *= share;
    mq *= share;
    mw *= share;
    double rr = 0.0, rq = 0.0, rw = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double dr = point(i).r - mr;
      rr += dr * dr;
      rq += dr * (point(i).q - mq);
      rw += dr * (point(i).w - mw);
    }
    if (rr > 0.0) {
      axis.slope_q = rq / rr;
      axis.slope_w = rw / rr;
    }
  }
  return axis;
}

bool is_confirmed(const Track& track, double least_turning) {
  constexpr std::size_t kFewest = 4, kPoints = 5;
  // What turns little must be seen more often: noise and the polygons of smooth surfaces turn little too.
  constexpr std::size_t kFairPoints = 6, kWeakPoints = 9;
  constexpr double kAboveLeast = 1.0, kWeak = 20.0, kStrong = 30.0, kSharpness = 1.5;
  const std::size_t n = track.points.size();
  if (n < kFewest) return false;
  const auto span = static_cast<double>(std::abs(track.points.back().step - track.points.front().step) + 1);
  if (static_cast<double>(n) < 0.5 * span) return false;
  Evidence evidence;
  bool smooth = true;
  for (const TrackPoint& p : track.points) {
    evidence.add(p.feature);
    smooth = smooth && p.feature.smooth;
  }
  if (evidence.is_arc()) return false;
  if (evidence.is_sure()) return true;
  if (n < kPoints || !(smooth || evidence.sharpness() >= kSharpness)) return false;
  static thread_local std::vector<double> turning;
  turning.clear();
  for (const TrackPoint& p : track.points) turning.push_back(std::abs(p.feature.tau));
  std::nth_element(turning.begin(), turning.begin() + static_cast<std::ptrdiff_t>(n / 2), turning.end());
  const double middle = turning[n / 2];
  if (middle < least_turning + kAboveLeast) return false;
  return evidence.is_edge() || n >= (middle < kWeak ? kWeakPoints : middle < kStrong ? kFairPoints : kPoints);
}

} // namespace scansion
