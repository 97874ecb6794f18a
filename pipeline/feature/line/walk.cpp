// Places along polylines.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/walk.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

constexpr std::size_t kAround = 3; // places to both sides that a way is taken over

double distance(const std::array<double, 3>& a, const std::array<double, 3>& b) noexcept {
  return std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
}

} // namespace

double length_in_space(const std::vector<FeatureVertex>& vertices) noexcept {
  double length = 0.0;
  for (std::size_t k = 1; k < vertices.size(); ++k) length += distance(vertices[k - 1].position, vertices[k].position);
  return length;
}

Walk::Walk(const FeatureLine& line, double step) : closed_(line.closed_loop) {
  const auto& v = line.vertices;
  if (v.empty()) return;
  const auto vertex = [&](std::size_t k) -> const FeatureVertex& { return v[k % v.size()]; };
  const std::size_t sides = v.size() - (closed_ ? 0 : 1);
  double length = length_in_space(v);
  if (closed_) length += distance(v.back().position, v.front().position);
  const double even = std::max({step, length / static_cast<double>(kMostPlaces), 1e-9});
  double done = 0.0, next = 0.0; // mm: to the side's first vertex, and to the next place
  for (std::size_t k = 0; k < sides; ++k) {
    const auto &a = vertex(k).position, &b = vertex(k + 1).position;
    const double side = distance(a, b);
    while (next < done + side) {
      const double share = (next - done) / side;
      WalkPlace& place = places_.emplace_back();
      for (std::size_t i = 0; i < 3; ++i) place.at[i] = a[i] + (b[i] - a[i]) * share;
      place.before = k;
      next += even;
    }
    done += side;
  }
  if (!closed_ || places_.empty()) places_.push_back({v.back().position, {}, v.size() - 1});
  const std::size_t n = places_.size();
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t from = closed_ ? (k + n - std::min(kAround, n - 1)) % n : k - std::min(k, kAround);
    const std::size_t to = closed_ ? (k + kAround) % n : std::min(n - 1, k + kAround);
    const double x = places_[to].at[0] - places_[from].at[0], y = places_[to].at[1] - places_[from].at[1];
    const double size = std::hypot(x, y);
    if (size > 0.0) places_[k].way = {x / size, y / size};
  }
}

std::vector<std::pair<std::size_t, std::size_t>> Walk::runs(const std::vector<bool>& kept) const {
  std::vector<std::pair<std::size_t, std::size_t>> out;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    if (!kept[k]) continue;
    if (k > 0 && kept[k - 1])
      out.back().second = k;
    else
      out.emplace_back(k, k);
  }
  const bool around = closed_ && out.size() > 1 && kept.front() && kept.back();
  if (around) {
    out.front().first = out.back().first;
    out.pop_back();
  }
  return out;
}

std::size_t Walk::count(const std::pair<std::size_t, std::size_t>& run) const noexcept {
  return run.second >= run.first ? run.second - run.first + 1 : run.second + places_.size() - run.first + 1;
}

void Walk::move(FeatureLine& line, const std::vector<std::array<double, 3>>& shift, std::size_t around) {
  const std::size_t n = places_.size();
  std::vector<bool> moved(line.vertices.size(), false);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t first = k - std::min(k, around), last = std::min(n - 1, k + around);
    std::array<double, 3> mean{};
    for (std::size_t j = first; j <= last; ++j)
      for (std::size_t i = 0; i < 3; ++i) mean[i] += shift[j][i] / static_cast<double>(last - first + 1);
    for (std::size_t i = 0; i < 3; ++i) places_[k].at[i] += mean[i];
    // A vertex goes with the first place at or behind it; those between two places go with the first of these.
    const std::size_t end = k + 1 < n ? places_[k + 1].before : line.vertices.size() - 1;
    for (std::size_t v = places_[k].before; v <= end; ++v) {
      if (moved[v] || (v == end && k + 1 < n && v != places_[k].before)) continue;
      moved[v] = true;
      for (std::size_t i = 0; i < 3; ++i)
        line.vertices[v].position[i] = std::round((line.vertices[v].position[i] + mean[i]) * line.per_mm) / line.per_mm;
    }
  }
}

FeatureLine Walk::part(const FeatureLine& line, const std::pair<std::size_t, std::size_t>& run) const {
  const WalkPlace &first = places_[run.first], &last = places_[run.second];
  const double share = static_cast<double>(count(run)) / static_cast<double>(places_.size());
  FeatureLine out = line;
  out.closed_loop = false;
  if (closed_ || run.first > 0) out.begins = FeatureEnd::death;
  if (closed_ || run.second + 1 < places_.size()) out.ends = FeatureEnd::death;
  const auto rounded = [&](const WalkPlace& place) {
    FeatureVertex vertex = line.vertices[place.before];
    for (std::size_t i = 0; i < 3; ++i) vertex.position[i] = std::round(place.at[i] * line.per_mm) / line.per_mm;
    return vertex;
  };
  out.vertices = {rounded(first)};
  const std::size_t n = line.vertices.size();
  std::size_t end = last.before;
  if (run.second < run.first || (closed_ && end < first.before)) end += n; // once around
  for (std::size_t k = first.before + 1; k <= end; ++k) out.vertices.push_back(line.vertices[k % n]);
  if (run.second != run.first && rounded(last).position != out.vertices.back().position) out.vertices.push_back(rounded(last));
  out.length_mm = length_in_space(out.vertices);
  const double shorter = line.length_mm > 0.0 ? std::min(1.0, out.length_mm / line.length_mm) : share;
  out.persistence = line.persistence * shorter;
  out.scan_lines = static_cast<std::uint64_t>(std::ceil(static_cast<double>(line.scan_lines) * shorter));
  for (std::uint32_t& count : out.elements) count = static_cast<std::uint32_t>(std::lround(count * shorter));
  return out;
}

} // namespace scansion
