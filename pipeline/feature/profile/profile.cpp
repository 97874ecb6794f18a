// Raw lines to profiles.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/profile/profile.hpp"

#include "pipeline/feature/passes/column_passes.hpp"
#include "pipeline/feature/passes/passes.hpp"

#include <algorithm>
#include <numeric>

namespace scansion {

namespace {

void number_samples(Profile& p) {
  if (!p.source.empty()) return;
  p.source.resize(p.size());
  std::iota(p.source.begin(), p.source.end(), 0U);
}

void turn_round(Profile& p) {
  std::reverse(p.s.begin(), p.s.end());
  std::reverse(p.w.begin(), p.w.end());
  number_samples(p);
  std::reverse(p.source.begin(), p.source.end());
  std::vector<double>& distance = p.own_distances();
  std::reverse(distance.begin(), distance.end());
  const auto size = static_cast<std::uint32_t>(p.s.size());
  std::reverse(p.ends.begin(), p.ends.end());
  // Ends in reverse order were one past the last sample of each run: shift them to what follows the run before.
  if (p.ends.empty()) return;
  for (std::size_t r = 0; r + 1 < p.ends.size(); ++r) p.ends[r] = size - p.ends[r + 1];
  p.ends.back() = size;
}

// Keeps the samples that advance. Steps back are folds, overhangs or a device's slips: no function of s.
void mask_steps_back(Profile& p) {
  number_samples(p);
  std::vector<double>& distance = p.own_distances();
  std::size_t kept = 0, run = 0;
  double last = 0.0;
  for (std::size_t k = 0; k < p.s.size(); ++k) {
    while (k >= p.ends[run]) p.ends[run++] = static_cast<std::uint32_t>(kept);
    if (kept > 0 && p.s[k] <= last) {
      ++p.masked;
      continue;
    }
    last = p.s[k];
    p.s[kept] = p.s[k];
    p.w[kept] = p.w[k];
    p.source[kept] = p.source[k];
    distance[kept] = distance[k];
    ++kept;
  }
  for (; run < p.ends.size(); ++run) p.ends[run] = static_cast<std::uint32_t>(kept);
  p.s.resize(kept);
  p.w.resize(kept);
  p.source.resize(kept);
  p.resize_distances(kept);
  p.ends.erase(std::unique(p.ends.begin(), p.ends.end()), p.ends.end());
  if (!p.ends.empty() && p.ends.front() == 0) p.ends.erase(p.ends.begin());
}

// Place of the line's mean across the lines, in mm.
double place_across(const RawLine& line, double resolution, const Vector3& normal) {
  double c = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (normal[axis] == 0.0) continue;
    const std::int64_t sum = passes::sum(line.xyz[axis].data(), line.size());
    c += static_cast<double>(sum) * resolution / static_cast<double>(line.size()) * normal[axis];
  }
  return c;
}

// How many samples do not advance. Counts that run along an axis tell it as well as places do, and sooner.
std::size_t count_back(const RawLine& line, const Frame& frame, const std::vector<double>& s) {
  if (frame.along[0] == 1.0) return passes::count_back(line.xyz[0].data(), s.size());
  return passes::count_back(s.data(), s.size());
}

} // namespace

void make_profile(const RawLine& line, double resolution, const Frame& frame, Profile& out) {
  out.line = line.index;
  out.masked = out.spikes = 0;
  out.turned = false;
  const std::size_t n = line.size();
  out.s.resize(n);
  out.w.resize(n);
  out.source.clear();
  out.forget();
  passes::project({line.xyz[0].data(), line.xyz[1].data(), line.xyz[2].data()}, {resolution, frame.along, frame.up},
                  out.s.data(), out.w.data(), n);
  if (n > 0) out.c = place_across(line, resolution, frame.normal);
  out.distance = line.distance;
  out.ends.assign(line.ends.begin(), line.ends.end());
  const std::size_t back = count_back(line, frame, out.s);
  if (back == 0) return;
  if (2 * back > n - 1) {
    out.turned = true;
    turn_round(out);
    if (passes::count_back(out.s.data(), n) == 0) return;
  }
  mask_steps_back(out);
}

void stand(Profile& profile, const ColumnScale& scale) {
  if (profile.scale == scale || profile.size() == 0) return;
  const std::size_t n = profile.size();
  profile.scale = scale;
  profile.shift.resize(n);
  profile.height.resize(n);
  const passes::Shifts shifts = passes::stand(profile.s.data(), profile.w.data(), {1.0 / scale.pitch, scale.base},
                                              profile.shift.data(), profile.height.data(), n);
  profile.least_shift = shifts.least;
  profile.largest_shift = shifts.largest;
}

} // namespace scansion
