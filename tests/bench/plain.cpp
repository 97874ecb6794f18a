// The yardstick: textbook Douglas-Peucker carried to the last point.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/plain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace scansion::bench {
namespace {

/// Squared distance of a point to a segment.
double squared_distance(const PlanePoint& p, const PlanePoint& a, const PlanePoint& b) {
  const double eu = b.u - a.u;
  const double ev = b.v - a.v;
  double du = p.u - a.u;
  double dv = p.v - a.v;
  const double length = eu * eu + ev * ev;
  if (length > 0.0) {
    const double t = std::clamp((du * eu + dv * ev) / length, 0.0, 1.0);
    du -= t * eu;
    dv -= t * ev;
  }
  return du * du + dv * dv;
}

} // namespace

void Plain::rank(const std::vector<PlanePoint>& line) {
  const std::size_t n = line.size();
  distance_.assign(n, 0.0);
  order_.resize(n);
  std::iota(order_.begin(), order_.end(), 0U);
  if (n == 0) return;
  distance_.front() = distance_.back() = std::numeric_limits<double>::infinity();
  stack_.clear();
  stack_.push_back({0, n - 1});
  while (!stack_.empty()) {
    const Interval i = stack_.back();
    stack_.pop_back();
    double farthest = 0.0;
    std::size_t split = i.a;
    for (std::size_t k = i.a + 1; k < i.b; ++k) {
      const double d = squared_distance(line[k], line[i.a], line[i.b]);
      if (d > farthest) {
        farthest = d;
        split = k;
      }
    }
    if (split == i.a) continue;
    distance_[split] = std::sqrt(farthest);
    if (i.b - split > 1) stack_.push_back({split, i.b});
    if (split - i.a > 1) stack_.push_back({i.a, split});
  }
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t p, std::uint32_t q) { return distance_[p] > distance_[q]; });
}

} // namespace scansion::bench
