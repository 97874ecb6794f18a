// Pieces of one id by their numbers, then lines that go on in each other.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/join_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <unordered_map>

namespace scansion {
namespace {

/// Points that the attributes are means of.
double seen(const FeatureLine& line) noexcept {
  return static_cast<double>(std::accumulate(line.elements.begin(), line.elements.end(), std::uint64_t{0}));
}

double weighted(double a, double n, double b, double m) noexcept {
  return n + m > 0.0 ? (n * a + m * b) / (n + m) : 0.5 * (a + b);
}

MeanDeviation together(const MeanDeviation& a, double n, const MeanDeviation& b, double m) noexcept {
  MeanDeviation out;
  out.mean = weighted(a.mean, n, b.mean, m);
  if (n + m < 2.0) return out;
  const auto squares = [](const MeanDeviation& x, double count) {
    return std::max(0.0, count - 1.0) * x.deviation * x.deviation;
  };
  const double apart = a.mean - b.mean;
  out.deviation = std::sqrt((squares(a, n) + squares(b, m) + n * m / (n + m) * apart * apart) / (n + m - 1.0));
  return out;
}

void turn(FeatureLine& line) {
  std::reverse(line.vertices.begin(), line.vertices.end());
  std::swap(line.begins, line.ends);
}

/// `later` goes on where `line` ends.
void append(FeatureLine& line, FeatureLine&& later) {
  const double n = seen(line), m = seen(later);
  if (m > n) {
    line.type = later.type;
    line.level = later.level;
  }
  line.inner_angle = together(line.inner_angle, n, later.inner_angle, m);
  line.orientation = together(line.orientation, n, later.orientation, m);
  line.turning = together(line.turning, n, later.turning, m);
  line.width = together(line.width, n, later.width, m);
  line.sharpness = weighted(line.sharpness, n, later.sharpness, m);
  line.guided_share = weighted(line.guided_share, n, later.guided_share, m);
  for (std::size_t k = 0; k < kShapeElements; ++k) line.elements[k] += later.elements[k];
  line.length_mm += later.length_mm;
  line.persistence += later.persistence;
  line.scan_lines += later.scan_lines;
  line.across_mm = std::max(line.across_mm, later.across_mm);
  if (!line.partner) line.partner = later.partner;
  line.junctions.insert(line.junctions.end(), later.junctions.begin(), later.junctions.end());
  line.met_by.insert(line.met_by.end(), later.met_by.begin(), later.met_by.end());
  line.closed_loop = line.closed_loop || later.closed_loop;
  line.ends = later.ends;
  line.ends_at = later.ends_at;
  const bool shared = !line.vertices.empty() && !later.vertices.empty() &&
                      line.vertices.back().line == later.vertices.front().line &&
                      line.vertices.back().index == later.vertices.front().index;
  line.vertices.insert(line.vertices.end(), later.vertices.begin() + (shared ? 1 : 0), later.vertices.end());
}

/// Lines by id.
using Places = std::unordered_map<std::uint64_t, std::size_t>;
Places places_of(const std::vector<FeatureLine>& lines) {
  Places places;
  for (std::size_t i = 0; i < lines.size(); ++i) places.emplace(lines[i].id, i);
  return places;
}

/// Of two lines that meet only the later one says so: here both do.
void tell_both(std::vector<FeatureLine>& lines) {
  const Places places = places_of(lines);
  for (FeatureLine& line : lines) {
    for (const LineEnd& end : line.met_by) {
      const auto found = places.find(end.line);
      if (found == places.end()) continue;
      FeatureEnd& why = end.last ? lines[found->second].ends : lines[found->second].begins;
      if (why == FeatureEnd::death || why == FeatureEnd::border) why = FeatureEnd::junction;
      line.junctions.push_back(end.line);
    }
    line.met_by.clear();
    if (!line.partner) continue;
    const auto found = places.find(*line.partner);
    if (found != places.end() && !lines[found->second].partner) lines[found->second].partner = line.id;
  }
  const std::size_t size = lines.size();
  std::vector<std::pair<std::size_t, std::uint64_t>> others;
  for (std::size_t i = 0; i < size; ++i)
    for (const std::uint64_t id : lines[i].junctions)
      if (const auto found = places.find(id); found != places.end()) others.emplace_back(found->second, lines[i].id);
  for (const auto& [i, id] : others) lines[i].junctions.push_back(id);
}

/// Which ends of lines meet. An end is 2 i for the first vertex of line i, 2 i + 1 for its last.
class Links {
public:
  Links(const std::vector<FeatureLine>& lines, const Places& place) : other_(2 * lines.size(), kNone) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      for (const bool last : {false, true}) {
        const auto& at = last ? lines[i].ends_at : lines[i].begins_at;
        const auto found = at ? place.find(at->line) : place.end();
        if (found != place.end()) meet(2 * i + (last ? 1 : 0), 2 * found->second + (at->last ? 1 : 0));
      }
    }
  }
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  [[nodiscard]] std::size_t other(std::size_t end) const noexcept { return other_[end]; }

private:
  // An end meets one other: what a damaged recording says beyond that does not hold.
  void meet(std::size_t a, std::size_t b) {
    if (a == b || other_[a] != kNone || other_[b] != kNone) return;
    other_[a] = b;
    other_[b] = a;
  }
  std::vector<std::size_t> other_;
};

/// Follows lines from end to end.
std::vector<FeatureLine> follow(std::vector<FeatureLine> lines) {
  const Places places = places_of(lines);
  const Links links(lines, places);
  std::vector<std::uint64_t> name(lines.size()); // that each goes by in the end
  std::vector<bool> used(lines.size(), false);
  std::vector<FeatureLine> out;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (used[i]) continue;
    // Back to where the chain begins, or once around a ring.
    std::size_t enter = 2 * i;
    bool ring = false;
    for (std::size_t before = links.other(enter); before != Links::kNone && !ring; before = links.other(enter)) {
      enter = before ^ 1U;
      ring = enter / 2 == i;
    }
    if (ring) enter = 2 * i;
    FeatureLine whole;
    for (std::size_t at = enter; at != Links::kNone && !used[at / 2]; at = links.other(at ^ 1U)) {
      FeatureLine& next = lines[at / 2];
      used[at / 2] = true;
      name[at / 2] = lines[i].id;
      if (at % 2 == 1) turn(next);
      if (at == enter)
        whole = std::move(next);
      else
        append(whole, std::move(next));
    }
    whole.id = name[i];
    whole.piece = 0;
    whole.begins_at.reset();
    whole.ends_at.reset();
    whole.closed_loop = whole.closed_loop || ring;
    out.push_back(std::move(whole));
  }
  const auto named = [&](std::uint64_t id) {
    const auto found = places.find(id);
    return found == places.end() ? id : name[found->second];
  };
  for (FeatureLine& line : out) {
    if (line.partner) line.partner = named(*line.partner);
    for (std::uint64_t& id : line.junctions) id = named(id);
    std::sort(line.junctions.begin(), line.junctions.end());
    line.junctions.erase(std::unique(line.junctions.begin(), line.junctions.end()), line.junctions.end());
    std::erase(line.junctions, line.id);
  }
  return out;
}

} // namespace

std::vector<FeatureLine> join_pieces(std::vector<FeatureLine> pieces) {
  std::stable_sort(pieces.begin(), pieces.end(), [](const FeatureLine& a, const FeatureLine& b) {
    return std::tie(a.id, a.piece) < std::tie(b.id, b.piece);
  });
  std::vector<FeatureLine> lines;
  for (FeatureLine& piece : pieces) {
    if (!lines.empty() && lines.back().id == piece.id)
      append(lines.back(), std::move(piece));
    else
      lines.push_back(std::move(piece));
  }
  tell_both(lines);
  return follow(std::move(lines));
}

} // namespace scansion
