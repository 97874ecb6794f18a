// Lines walked in even steps; what the other scan has beside each step; stretches that stay; their ends joined.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/crossed.hpp"

#include "pipeline/feature/line/join_pieces.hpp"
#include "pipeline/feature/line/plan_grid.hpp"
#include "pipeline/feature/line/walk.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

namespace scansion {

namespace {

constexpr double kBeside = 2.0;            // steps: two lines so near are one edge
constexpr double kPast = 1.0;              // steps along it: beyond its end a line has nothing beside it
constexpr double kAbove = 2.0;             // steps of height between them
constexpr double kSure = 60.0;             // steps: a line that the other scan denies for the most part is longer
constexpr double kGap = 5.0, kPart = 20.0; // steps: what it denies between these goes. Less may be its gap, more is there
constexpr std::size_t kCalm = 3;           // places to both sides over which lines are brought together
constexpr double kAlike = 0.866;           // cosine of 30 degrees between their ways
constexpr double kBetter = 1.15;           // times surer: what is taken from the other scan
constexpr double kPerStep = 2.0;           // places of a walk
constexpr double kShort = 3.0;             // steps: a stretch that is cut out of a line is longer
constexpr double kJoin = 2.0;              // steps between ends that are joined
constexpr double kBend = 0.2;              // cosine between the ways out of two ends that are joined: corners may be right ones

/// One of the scans, its lines as walks.
struct Side {
  explicit Side(FoundByScan scan, double step) : found(std::move(scan)) {
    for (const FeatureLine& line : found.lines) walks.emplace_back(line, step);
    for (const Walk& walk : walks) {
      kept.emplace_back(walk.places().size(), true);
      shift.emplace_back(walk.places().size());
    }
  }
  /// How far off a place on a line that runs there may be: edges along the scan lines are found between these.
  [[nodiscard]] double doubt(const WalkPlace& place) const noexcept {
    constexpr double kLeast = 0.2;
    const double sine = std::abs(place.way[0] * found.along[1] - place.way[1] * found.along[0]);
    return found.step_mm / std::max(kLeast, sine);
  }

  FoundByScan found;
  std::vector<Walk> walks;
  std::vector<std::vector<bool>> kept;
  std::vector<std::vector<std::array<double, 3>>> shift; ///< of each place, towards what both scans say
};

bool convex(const FeatureLine& line) noexcept {
  return line.type == FeatureType::convex || line.type == FeatureType::step_top || line.type == FeatureType::ridge;
}

/// Finds what runs beside a place.
class Beside {
public:
  Beside(const Side& side, double step)
      : side_(side), reach_(kBeside * step), above_(kAbove * step), past_(kPast * step), grid_(reach_) {
    for (std::uint32_t i = 0; i < side.walks.size(); ++i) {
      const auto& places = side.walks[i].places();
      for (std::uint32_t k = 0; k < places.size(); ++k) grid_.add(places[k].at[0], places[k].at[1], {i, k});
    }
    grid_.close();
  }
  /// The nearest of one polarity that runs alike; of places that stay only, when asked for these.
  [[nodiscard]] const PlanGrid::Item* find(const WalkPlace& place, bool is_convex, bool staying) const {
    const PlanGrid::Item* best = nullptr;
    double nearest = reach_ * reach_;
    grid_.visit(place.at[0], place.at[1], [&](const PlanGrid::Item& item) {
      const WalkPlace& other = side_.walks[item.line].places()[item.place];
      if (convex(side_.found.lines[item.line]) != is_convex || (staying && !side_.kept[item.line][item.place])) return;
      if (std::abs(other.at[2] - place.at[2]) > above_) return;
      if (std::abs(other.way[0] * place.way[0] + other.way[1] * place.way[1]) < kAlike) return;
      const double x = other.at[0] - place.at[0], y = other.at[1] - place.at[1];
      if (x * x + y * y > nearest || std::abs(x * place.way[0] + y * place.way[1]) > past_) return;
      nearest = x * x + y * y;
      best = &item;
    });
    return best;
  }

private:
  const Side& side_;
  double reach_, above_, past_;
  PlanGrid grid_;
};

/// From a place to where the other scan has the line beside it, by its share in both.
std::array<double, 3> towards(const WalkPlace& place, const WalkPlace& other, double share) noexcept {
  const double x = other.at[0] - place.at[0], y = other.at[1] - place.at[1];
  const double along = x * other.way[0] + y * other.way[1];
  return {share * (x - along * other.way[0]), share * (y - along * other.way[1]), share * (other.at[2] - place.at[2])};
}

/// Takes away stretches of a line that the other scan denies: it looked there and found nothing.
void take_denied(const std::vector<bool>& denied, double walk_step, double step, std::vector<bool>& kept) {
  for (std::size_t k = 0; k < denied.size();) {
    std::size_t end = k;
    while (end < denied.size() && denied[end]) ++end;
    const double length = static_cast<double>(end - k) * walk_step;
    if (length > kGap * step && length < kPart * step)
      std::fill(kept.begin() + static_cast<std::ptrdiff_t>(k), kept.begin() + static_cast<std::ptrdiff_t>(end), false);
    k = end + 1;
  }
  const auto count = static_cast<std::size_t>(std::count(denied.begin(), denied.end(), true));
  const bool is_short = static_cast<double>(denied.size()) * walk_step < kSure * step;
  if (is_short && 2 * count > denied.size()) std::fill(kept.begin(), kept.end(), false);
}

/// What the other scan says of the lines of this one: both are measurements, and their mean is surer than either. The length
/// that both found.
double consult(Side& side, const Side& other, const Beside& beside, double step, double walk_step) {
  const double own = side.found.step_mm * side.found.step_mm, others = other.found.step_mm * other.found.step_mm;
  constexpr double kCoarser = 1.5; // times: a coarser scan may miss what this one sees
  const bool may_deny = other.found.step_mm <= kCoarser * side.found.step_mm;
  double common = 0.0;
  std::vector<bool> denied;
  for (std::size_t i = 0; i < side.walks.size(); ++i) {
    const auto& places = side.walks[i].places();
    denied.assign(places.size(), false);
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (const PlanGrid::Item* item = beside.find(places[k], convex(side.found.lines[i]), false)) {
        side.shift[i][k] = towards(places[k], other.walks[item->line].places()[item->place], own / (own + others));
        common += walk_step;
      } else {
        denied[k] = may_deny && other.found.covers(places[k].at[0], places[k].at[1]);
      }
    }
    take_denied(denied, walk_step, step, side.kept[i]);
  }
  return common;
}

/// Takes away places of `first` that `second` measures better.
void choose(Side& first, const Side& second, const Beside& beside) {
  for (std::size_t i = 0; i < first.walks.size(); ++i) {
    bool gone = false; // the last place: the next one goes more easily, so that a line at even angles is in one piece
    for (std::size_t k = 0; k < first.kept[i].size(); ++k) {
      const WalkPlace& place = first.walks[i].places()[k];
      const PlanGrid::Item* other = beside.find(place, convex(first.found.lines[i]), false);
      if (other == nullptr || !second.kept[other->line][other->place]) {
        gone = false;
        continue;
      }
      const double theirs = second.doubt(second.walks[other->line].places()[other->place]);
      const double ours = first.doubt(place);
      gone = gone ? theirs < kBetter * ours : kBetter * theirs < ours;
      if (gone) first.kept[i][k] = false;
    }
  }
}

/// Takes away places of `second` beside what stays of `first`.
void give_way(Side& second, const Beside& beside) {
  for (std::size_t i = 0; i < second.walks.size(); ++i)
    for (std::size_t k = 0; k < second.kept[i].size(); ++k)
      if (beside.find(second.walks[i].places()[k], convex(second.found.lines[i]), true) != nullptr) second.kept[i][k] = false;
}

/// Changes runs of places that are shorter than `least` and stand between others; `value`: what they are.
void fill_short(std::vector<bool>& kept, bool value, std::size_t least) {
  for (std::size_t k = 0; k < kept.size();) {
    std::size_t end = k + 1;
    while (end < kept.size() && kept[end] == kept[k]) ++end;
    if (kept[k] == value && end - k < least && k > 0 && end < kept.size())
      std::fill(kept.begin() + static_cast<std::ptrdiff_t>(k), kept.begin() + static_cast<std::ptrdiff_t>(end), !value);
    k = end;
  }
}

struct Stretch {
  FeatureLine line;
  int side = 0;
};

/// The stretches of lines that stay, numbered on, and what they say of lines of their scan by the new numbers.
void cut(Side& side, int number, std::size_t least, std::vector<Stretch>& out) {
  std::unordered_map<std::uint64_t, std::size_t> now; // the longest stretch of each line
  const std::size_t begin = out.size();
  const auto add = [&](FeatureLine line) {
    const auto [at, is_new] = now.emplace(line.id, out.size());
    if (!is_new && line.length_mm > out[at->second].line.length_mm) at->second = out.size();
    out.push_back({std::move(line), number});
  };
  for (std::size_t i = 0; i < side.walks.size(); ++i) {
    const std::vector<bool>& kept = side.kept[i];
    if (std::all_of(kept.begin(), kept.end(), [](bool k) { return k; })) {
      add(std::move(side.found.lines[i]));
      continue;
    }
    for (const auto& run : side.walks[i].runs(kept))
      if (side.walks[i].count(run) >= least) add(side.walks[i].part(side.found.lines[i], run));
  }
  const auto renamed = [&](std::uint64_t id) {
    const auto at = now.find(id);
    return at == now.end() ? 0 : at->second + 1;
  };
  for (std::size_t k = begin; k < out.size(); ++k) {
    FeatureLine& line = out[k].line;
    line.id = k + 1;
    if (line.partner) line.partner = renamed(*line.partner);
    if (line.partner == 0) line.partner.reset();
    for (std::uint64_t& id : line.junctions) id = renamed(id);
    std::erase(line.junctions, 0);
  }
}

/// Where a stretch ends, and the way out of it.
struct FreeEnd {
  std::size_t stretch = 0;
  bool last = false;
  std::array<double, 3> at{}, out{};
};

FreeEnd end_of(const FeatureLine& line, std::size_t stretch, bool last, double back) {
  const auto& v = line.vertices;
  FreeEnd end{stretch, last, last ? v.back().position : v.front().position, {}};
  // The way out from the first vertex that is far enough for one.
  for (std::size_t k = 1; k < v.size(); ++k) {
    const auto& from = last ? v[v.size() - 1 - k].position : v[k].position;
    for (std::size_t i = 0; i < 3; ++i) end.out[i] = end.at[i] - from[i];
    if (std::hypot(end.out[0], end.out[1], end.out[2]) >= back) break;
  }
  const double size = std::max(1e-9, std::hypot(end.out[0], end.out[1], end.out[2]));
  for (double& x : end.out) x /= size;
  return end;
}

struct Bridge {
  double length = 0.0;
  std::size_t a = 0, b = 0; // free ends
};

/// Ends of both scans go on in each other, nearest first, each in one.
void bridge(std::vector<Stretch>& stretches, double step) {
  std::vector<FreeEnd> ends;
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    if (stretches[i].line.closed_loop || stretches[i].line.vertices.size() < 2) continue;
    for (const bool last : {false, true}) ends.push_back(end_of(stretches[i].line, i, last, step));
  }
  const double reach = kJoin * step;
  PlanGrid grid(reach);
  for (std::uint32_t e = 0; e < ends.size(); ++e) grid.add(ends[e].at[0], ends[e].at[1], {e, 0});
  grid.close();
  std::vector<Bridge> found;
  for (std::size_t a = 0; a < ends.size(); ++a) {
    grid.visit(ends[a].at[0], ends[a].at[1], [&](const PlanGrid::Item& item) {
      const std::size_t b = item.line;
      const FreeEnd &p = ends[a], &q = ends[b];
      if (b <= a || stretches[p.stretch].side == stretches[q.stretch].side) return;
      if (convex(stretches[p.stretch].line) != convex(stretches[q.stretch].line)) return;
      const std::array<double, 3> way{q.at[0] - p.at[0], q.at[1] - p.at[1], q.at[2] - p.at[2]};
      const double length = std::hypot(way[0], way[1], way[2]);
      const double opposed = p.out[0] * q.out[0] + p.out[1] * q.out[1] + p.out[2] * q.out[2];
      if (length <= reach && opposed < kBend) found.push_back({length, a, b});
    });
  }
  std::sort(found.begin(), found.end(),
            [](const Bridge& x, const Bridge& y) { return std::tie(x.length, x.a, x.b) < std::tie(y.length, y.a, y.b); });
  std::vector<bool> used(ends.size(), false);
  for (const Bridge& bridge : found) {
    if (used[bridge.a] || used[bridge.b]) continue;
    used[bridge.a] = used[bridge.b] = true;
    const FreeEnd &p = ends[bridge.a], &q = ends[bridge.b];
    FeatureLine& line = stretches[p.stretch].line;
    (p.last ? line.ends_at : line.begins_at) = LineEnd{stretches[q.stretch].line.id, q.last};
  }
}

} // namespace

bool FoundByScan::covers(double x, double y) const noexcept {
  const double s = x * along[0] + y * along[1], c = y * along[0] - x * along[1];
  auto run = std::lower_bound(scanned.begin(), scanned.end(), c - step_mm,
                              [](const ScannedRun& r, double low) { return r.across < low; });
  for (; run != scanned.end() && run->across <= c + step_mm; ++run)
    if (s >= run->from && s <= run->to) return true;
  return false;
}

CrossedLines merge_crossed(FoundByScan first, FoundByScan second) {
  const double step = std::max(first.step_mm, second.step_mm);
  if (!(step > 0.0)) return {}; // neither has a line
  const double walk_step = step / kPerStep;
  CrossedLines out;
  for (const FeatureLine& line : first.lines) out.first_mm += line.length_mm;
  for (const FeatureLine& line : second.lines) out.second_mm += line.length_mm;
  Side a(std::move(first), walk_step), b(std::move(second), walk_step);
  constexpr auto least = static_cast<std::size_t>(kShort * kPerStep);
  const Beside beside_a(a, step), beside_b(b, step);
  out.common_mm = consult(a, b, beside_b, step, walk_step);
  consult(b, a, beside_a, step, walk_step);
  choose(a, b, beside_b);
  for (auto& kept : a.kept) fill_short(kept, false, least);
  give_way(b, beside_a);
  for (auto& kept : b.kept) fill_short(kept, true, least);
  for (Side* side : {&a, &b})
    for (std::size_t i = 0; i < side->walks.size(); ++i) side->walks[i].move(side->found.lines[i], side->shift[i], kCalm);
  std::vector<Stretch> stretches;
  cut(a, 0, least, stretches);
  cut(b, 1, least, stretches);
  bridge(stretches, step);
  for (Stretch& stretch : stretches) out.lines.push_back(std::move(stretch.line));
  out.lines = join_pieces(std::move(out.lines));
  for (FeatureLine& line : out.lines) line.length_mm = std::max(line.length_mm, length_in_space(line.vertices));
  return out;
}

} // namespace scansion
