// Groups of ranked scan lines to payloads.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/codec.hpp"
#include "pipeline/codec/fit.hpp"
#include "pipeline/codec/kernels.hpp"
#include "pipeline/codec/level_values.hpp"
#include "pipeline/codec/plain_axis.hpp"
#include "pipeline/codec/positions.hpp"
#include "pipeline/codec/ruling.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {
namespace {

// The axis along which lines run: where first and last points of runs lie farthest apart.
std::size_t main_axis(const LineGroup& group) noexcept {
  std::array<double, 3> extent{};
  for (const Run& run : group.runs)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto& v = group.xyz[axis];
      extent[axis] += std::abs(static_cast<double>(v[run.first + run.count - 1]) - v[run.first]);
    }
  return static_cast<std::size_t>(std::ranges::max_element(extent) - extent.begin());
}

// Where the runs of an even axis begin, and how they go on, for the most part.
EvenStart even_start(std::span<const Run> runs, std::span<const std::int32_t> u, std::vector<std::int32_t>& advances) {
  EvenStart start;
  if (runs.empty()) return start;
  start.first = u[runs.front().first];
  const auto several = std::ranges::find_if(runs, [](const Run& run) { return run.count > 1; });
  if (several != runs.end()) start.step = wrap(even_step(*several, u));
  advances.clear();
  for (std::size_t r = 1; r < runs.size(); ++r) advances.push_back(wrap(std::int64_t{u[runs[r].first]} - u[runs[r - 1].first]));
  if (advances.empty()) return start;
  const auto middle = advances.begin() + static_cast<std::ptrdiff_t>(advances.size() / 2);
  std::ranges::nth_element(advances, middle);
  start.advance = *middle;
  return start;
}

} // namespace

std::uint64_t log_time_ns(const ScanLine& line) noexcept {
  if (line.stamps.host_realtime_ns) return static_cast<std::uint64_t>(std::max<std::int64_t>(0, *line.stamps.host_realtime_ns));
  return line.index * kNominalLineNs;
}

struct GroupEncoder::Impl {
  GroupState state;
  PlaneWriter planes;
  SymbolWriter symbols, alone; ///< the latter: positions that follow nobody
  GroupFacts facts;
  AxisScales& scales = facts.scales;
  FanFinder fans;
  std::array<Ruling, 3> rulings;
  Bytes table;
  Bytes body; ///< of the payload at hand
  std::array<std::vector<PointIndex>, kMaxLevels> level_points;
  std::vector<std::uint32_t> vertices;           ///< of one run, scratch
  std::array<double, kMaxLevels + 1> farthest{}; // per alpha-width: the largest finite D
  std::vector<std::int32_t> ends;
  bool followed = true; ///< the level before follows the line before
  struct Trial {
    std::array<std::int32_t, kLevelModes> residual;
    std::uint32_t context;
  };
  std::vector<Trial> trial;
  Neighbours neighbours;
  std::array<RestAxis, 3> rest_axes;
  WeightFit fit;
  RunResiduals run_residuals;
  std::vector<std::int64_t> leftovers;
  PlainAxis plain;

  void sort_levels(const LineGroup& group, const GroupRanks& ranks, const AlphaSet& alpha);
  void load(const LineGroup& group);
  void find_ruling(const LineGroup& group, std::size_t axis);
  void find_fan(const LineGroup& group);
  [[nodiscard]] std::int64_t remainder(const LineGroup& group, std::size_t axis, PointIndex i) const noexcept;
  void write_even_ends(const LineGroup& group, Bytes& to);
  void write_level_positions(const LineGroup& group, std::uint8_t level, Bytes& to);
  void write_level(const LineGroup& group, std::uint8_t level, Bytes& to);
  void write_rest(const LineGroup& group, Bytes& to);
  void write_rest_axis(const LineGroup& group, std::size_t axis, Bytes& to);
  void write_leftovers(const LineGroup& group, bool rest, bool coarsest, Bytes& to);
  template <class Visit>
  void visit_new(const LineGroup& group, bool rest, bool coarsest, Visit&& visit);
};

// Which level each point is of.
void GroupEncoder::Impl::sort_levels(const LineGroup& group, const GroupRanks& ranks, const AlphaSet& alpha) {
  const std::size_t levels = alpha.tolerances.size();
  for (auto& points : level_points) points.clear();
  farthest.fill(0.0);
  const double finest = alpha.tolerances.back();
  double rest = 0.0;
  grow(vertices, group.points());
  for (const Run& run : group.runs) {
    if (run.count < 3) continue;
    const double* const d = ranks.distance.data() + run.first + 1;
    const std::size_t found = kernels::above(d, finest, vertices.data(), run.count - 2, rest);
    for (std::size_t v = 0; v < found; ++v) {
      const std::size_t k = alpha.width(d[vertices[v]]);
      level_points[k].push_back(run.first + 1 + vertices[v]);
      farthest[k] = std::max(farthest[k], d[vertices[v]]);
    }
  }
  farthest[levels] = rest;
}

void GroupEncoder::Impl::load(const LineGroup& group) {
  state.reset(group.points());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    scales[axis] = find_scale(group.xyz[axis], group.runs, ends);
    if (scales[axis].even) {
      ends_to_steps(group.xyz[axis], scales[axis], group.runs, state.axis(axis));
      continue;
    }
    to_steps(group.xyz[axis], scales[axis], state.axis(axis));
    if (!scales[axis].split) find_ruling(group, axis);
  }
  facts.exact = !group.ulp[0].empty();
  find_fan(group);
}

void GroupEncoder::Impl::find_ruling(const LineGroup& group, std::size_t axis) {
  scales[axis].ruled = scales[axis].even = rulings[axis].find(group.runs, state.axis(axis));
}

// A fan lies in a plane: two axes turn, the third is even and goes on slowly.
void GroupEncoder::Impl::find_fan(const LineGroup& group) {
  Fan& fan = facts.fan;
  fan.clear();
  std::size_t even = 3;
  std::int64_t least = std::numeric_limits<std::int64_t>::max();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!scales[axis].even || group.points() == 0) continue;
    // An even axis has its extremes at the ends of runs.
    std::int32_t low = std::numeric_limits<std::int32_t>::max();
    std::int32_t high = std::numeric_limits<std::int32_t>::min();
    for (const Run& run : group.runs)
      for (const std::int32_t v : {group.xyz[axis][run.first], group.xyz[axis][run.first + run.count - 1]}) {
        low = std::min(low, v);
        high = std::max(high, v);
      }
    if (std::int64_t{high} - low >= least) continue;
    least = std::int64_t{high} - low;
    even = axis;
  }
  if (std::ranges::count_if(scales, &AxisScale::even) != 1) return;
  fan.range_axis = even == 0 ? 1 : 0;
  fan.direction_axis = even == 2 ? 1 : 2;
  fans.find(group.xyz[fan.range_axis], group.xyz[fan.direction_axis], fan);
  if (fan.empty()) return;
  for (const std::size_t part : {0U, 1U}) {
    const std::size_t axis = part == 0 ? fan.range_axis : fan.direction_axis;
    const auto& values = part == 0 ? fans.ranges : fans.directions;
    scales[axis] = find_scale(values, group.runs, ends);
    if (scales[axis].split) scales[axis] = {scales[axis].base, 1, false, false, false};
    to_steps(values, scales[axis], state.axis(axis));
    if (!scales[axis].even) find_ruling(group, axis);
    scales[axis].split = !fans.exact[part];
  }
}

// By how much a point lies beside what its steps say.
std::int64_t GroupEncoder::Impl::remainder(const LineGroup& group, std::size_t axis, PointIndex i) const noexcept {
  const Fan& fan = facts.fan;
  if (fan.empty() || (axis != fan.range_axis && axis != fan.direction_axis)) return scales[axis].remainder(group.xyz[axis][i]);
  return fans.off[axis == fan.range_axis ? 0 : 1][i];
}

void GroupEncoder::Impl::write_even_ends(const LineGroup& group, Bytes& to) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!scales[axis].even) continue;
    symbols.clear();
    const EvenStart start = even_start(group.runs, state.u[axis], ends);
    for (const std::int32_t value : {start.first, start.advance}) put_signed(to, value);
    if (scales[axis].ruled) {
      rulings[axis].write(group.runs, state.u[axis], start.first, start.advance, symbols);
      symbols.write(to);
      continue;
    }
    put_signed(to, start.step);
    visit_even_ends(group.runs, state.u[axis], start, [&](PointIndex i, std::int32_t guess, std::uint32_t context) {
      symbols.put(wrap(std::int64_t{state.u[axis][i]} - guess), context);
    });
    symbols.write(to);
  }
}

// Following the line before pays where edges go on from line to line, and costs where vertices come and go with the noise.
void GroupEncoder::Impl::write_level_positions(const LineGroup& group, std::uint8_t level, Bytes& to) {
  alone.clear();
  write_alone(level_points[level], state, alone);
  // A level whose coarser one did not follow hardly ever does: its vertices are more like noise.
  if (followed) {
    symbols.clear();
    write_following(group.runs, level_points[level], state, symbols);
    followed = symbols.estimate() <= alone.estimate();
  }
  if (!followed) take_alone(group.runs, level_points[level], state);
  to.push_back(std::byte{followed});
  (followed ? symbols : alone).write(to);
}

void GroupEncoder::Impl::write_level(const LineGroup& group, std::uint8_t level, Bytes& to) {
  if (level == 0) {
    followed = true;
    write_even_ends(group, to);
    align_runs(group, scales, state);
    for (const Run& run : group.runs) {
      state.known.push_back(run.first);
      if (run.count > 1) state.known.push_back(run.first + run.count - 1);
    }
  }
  write_level_positions(group, level, to);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (scales[axis].even) continue;
    const auto& u = state.u[axis];
    trial.clear();
    std::array<std::uint64_t, kLevelModes> costs{};
    visit_level(state, group.runs, axis, level == 0, [&](PointIndex i, const LevelGuess& guess, std::uint32_t context) {
      Trial& t = trial.emplace_back();
      t.context = context;
      for (std::size_t m = 0; m < kLevelModes; ++m) {
        t.residual[m] = wrap(std::int64_t{u[i]} - guess[m]);
        costs[m] += log2_fixed(fold(t.residual[m]) / 2 + 1);
      }
    });
    const auto best = static_cast<std::size_t>(std::ranges::min_element(costs) - costs.begin());
    to.push_back(static_cast<std::byte>(best));
    symbols.clear();
    for (const Trial& t : trial) symbols.put(t.residual[best], t.context);
    symbols.write(to);
  }
}

void GroupEncoder::Impl::write_rest(const LineGroup& group, Bytes& to) {
  const std::size_t along = facts.fan.empty() ? main_axis(group) : facts.fan.direction_axis;
  to.push_back(static_cast<std::byte>(along));
  const std::size_t points = group.points();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (scales[axis].even) continue;
    rest_axes[axis].make_room(points);
  }
  if (scales[along].even && !scales[along].ruled)
    fill_even(group.runs, state.u[along]);
  else if (!scales[along].even)
    fill_chord(state.known, state.u[along], rest_axes[along].chord);
  neighbours.find(group, state, scales[along], scales[along].even ? state.axis(along) : std::span(rest_axes[along].chord));
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!scales[axis].even) write_rest_axis(group, axis, to);
}

void GroupEncoder::Impl::write_rest_axis(const LineGroup& group, std::size_t axis, Bytes& to) {
  constexpr std::size_t kSample = 2048;
  const std::span<const std::int32_t> u = state.axis(axis);
  RestAxis& at = rest_axes[axis];
  // Of a small group fewer are enough: there the fit is a large part of all work.
  constexpr std::size_t kSmallGroup = 12'288;
  const std::size_t stride = u.size() < kSmallGroup ? 16 : std::max<std::size_t>(6, u.size() / kSample);
  PointIndex sample = 0;
  at.fill(group.runs, state.known, u);
  fit.clear();
  visit_rest(group, state.known, neighbours, [&](const RestLine& line, PointIndex run_first, PointIndex from, PointIndex end) {
    for (; sample < end; sample += static_cast<PointIndex>(stride))
      if (sample >= from) fit.add(deviations_of(at, u, neighbours, line, run_first, sample), at.deviation[sample]);
  });
  const auto [weights, with_above] = fit.solve();
  symbols.clear();
  put_fitted(group, state.known, with_above ? &neighbours : nullptr, weights, u, at, run_residuals, symbols);
  const auto used = std::span(weights).first(with_above ? kWeights : kLineWeights);
  // Fitted residuals are written when byte planes are not clearly smaller: what they take is known to some hundredths before.
  const std::size_t fitted = symbols.estimate() / 8 + 2 * used.size();
  if (plain.find(group.runs, state.known, u, fitted - fitted / 64, planes)) {
    to.insert(to.end(), plain.bytes().begin(), plain.bytes().end());
    return;
  }
  to.push_back(static_cast<std::byte>(with_above ? RestMode::fitted : RestMode::line));
  for (const std::int16_t w : used) put_signed(to, w);
  symbols.write_long(to);
}

// The points that a level adds, ascending.
template <class Visit>
void GroupEncoder::Impl::visit_new(const LineGroup& group, bool rest_of_all, bool coarsest, Visit&& visit) {
  if (rest_of_all)
    visit_rest(group, state.known, neighbours, [&](const RestLine&, PointIndex, PointIndex from, PointIndex end) {
      for (PointIndex i = from; i < end; ++i) visit(i);
    });
  else
    for (std::size_t v = 0; v < state.vertices.size(); ++v)
      if (coarsest || state.added[v] != 0) visit(state.vertices[v]);
}

// What the coded steps leave over: remainders of axes whose step not all values share, IEEE residuals.
void GroupEncoder::Impl::write_leftovers(const LineGroup& group, bool rest_of_all, bool coarsest, Bytes& to) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!scales[axis].split) continue;
    leftovers.clear();
    visit_new(group, rest_of_all, coarsest, [&](PointIndex i) { leftovers.push_back(remainder(group, axis, i)); });
    planes.put_planes(to, leftovers);
  }
  for (const auto& axis : group.ulp) {
    if (axis.empty()) return;
    leftovers.clear();
    visit_new(group, rest_of_all, coarsest, [&](PointIndex i) { leftovers.push_back(axis[i]); });
    planes.put_planes(to, leftovers);
  }
}

GroupEncoder::GroupEncoder() : impl_(std::make_unique<Impl>()) {}
GroupEncoder::~GroupEncoder() = default;
GroupEncoder::GroupEncoder(GroupEncoder&&) noexcept = default;
GroupEncoder& GroupEncoder::operator=(GroupEncoder&&) noexcept = default;

void GroupEncoder::encode(const LineGroup& group, const GroupRanks& ranks, const AlphaSet& alpha, std::uint32_t stream,
                          EncodedGroup& out) {
  Impl& s = *impl_;
  const std::size_t points = group.points();
  const auto levels = static_cast<std::uint8_t>(alpha.tolerances.size());
  s.sort_levels(group, ranks, alpha);

  out.number = static_cast<std::uint32_t>(group.number);
  out.first_line = group.lines.front().index;
  out.line_count = static_cast<std::uint32_t>(group.lines.size());
  out.first_time_ns = log_time_ns(group.lines.front());
  out.last_time_ns = log_time_ns(group.lines.back());
  out.payloads.resize(levels + 2U);
  PayloadHeader header{.levels = levels,
                       .stream = stream,
                       .group = out.number,
                       .line_count = static_cast<std::uint16_t>(out.line_count),
                       .epoch = static_cast<std::uint16_t>(alpha.epoch),
                       .first_line = out.first_line,
                       .first_time_ns = out.first_time_ns,
                       .last_time_ns = out.last_time_ns};

  s.load(group);
  s.table.clear();
  write_line_table(group, s.facts, s.table);
  s.body.clear();
  s.planes.put_blob(s.body, s.table);
  header.left_out = *std::ranges::max_element(s.farthest);
  header.points = static_cast<std::uint32_t>(points);
  seal_payload(header, s.body, out.payloads[0]);

  std::size_t known = 0;
  for (std::uint8_t k = 0; k <= levels; ++k) {
    const bool rest = k == levels;
    s.body.clear();
    if (!rest && k > 0 && s.level_points[k].empty()) {
      s.state.pass_level(group.runs);
    } else {
      if (rest)
        s.write_rest(group, s.body);
      else
        s.write_level(group, k, s.body);
      s.write_leftovers(group, rest, k == 0, s.body);
    }
    header.kind = rest ? PayloadKind::rest : PayloadKind::level;
    header.level = k;
    header.points = static_cast<std::uint32_t>((rest ? points : s.state.vertices.size()) - known);
    header.tolerance = rest ? 0.0 : alpha.tolerances[k];
    header.left_out = rest ? 0.0 : *std::max_element(s.farthest.begin() + k + 1, s.farthest.end());
    seal_payload(header, s.body, out.payloads[k + 1U]);
    known += header.points;
    s.state.end_level();
  }
}

} // namespace scansion
