// Groups of ranked scan lines to payloads.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/codec.hpp"
#include "pipeline/codec/fit.hpp"
#include "pipeline/codec/level_coder.hpp"
#include "pipeline/codec/planes.hpp"
#include "pipeline/codec/positions.hpp"
#include "pipeline/codec/rest_coder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace scansion {
namespace {

using Residuals = std::vector<std::int64_t>;

// Roughly what a residual costs in bits.
std::uint64_t cost(std::int64_t residual) noexcept {
  return static_cast<std::uint64_t>(std::bit_width(zigzag(residual)));
}

std::uint64_t cost(const Residuals& residuals) noexcept {
  std::uint64_t sum = 0;
  for (const std::int64_t r : residuals) sum += cost(r);
  return sum;
}

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

} // namespace

std::uint64_t log_time_ns(const ScanLine& line) noexcept {
  constexpr std::uint64_t kNominalLine = 1'000'000;
  if (line.stamps.host_realtime_ns) return static_cast<std::uint64_t>(std::max<std::int64_t>(0, *line.stamps.host_realtime_ns));
  return line.index * kNominalLine;
}

struct GroupEncoder::Impl {
  GroupState state;
  PlaneWriter planes;
  AxisScales scales;
  Bytes table;
  std::vector<std::uint8_t> width;
  std::array<Residuals, std::max(kLevelModes, kRestModes)> trial;
  Residuals residuals;

  void load(const LineGroup& group);
  void write_level(const LineGroup& group, std::uint8_t level, Bytes& to);
  void write_rest(const LineGroup& group, Bytes& to);
  void write_leftovers(const LineGroup& group, Bytes& to);
  void put_best(std::size_t modes, Bytes& to);
  struct RestChoice {
    RestMode mode;
    Weights weights;
  };
  std::array<RestChoice, 3> choose_rest(const LineGroup& group, std::size_t along);
};

void GroupEncoder::Impl::load(const LineGroup& group) {
  state.reset(group.points());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto& v = group.xyz[axis];
    const AxisScale& scale = scales[axis] = find_scale(v);
    auto& u = state.u[axis];
    for (std::size_t i = 0; i < v.size(); ++i)
      u[i] = static_cast<std::int32_t>(scale.step == 1 ? std::int64_t{v[i]} - scale.base : scale.steps(v[i]));
  }
}

void GroupEncoder::Impl::put_best(std::size_t modes, Bytes& to) {
  std::size_t best = 0;
  std::uint64_t best_cost = cost(trial[0]);
  for (std::size_t m = 1; m < modes && best_cost > 0; ++m) {
    const std::uint64_t c = cost(trial[m]);
    if (c < best_cost) {
      best = m;
      best_cost = c;
    }
  }
  to.push_back(static_cast<std::byte>(best));
  planes.put_planes(to, trial[best]);
}

void GroupEncoder::Impl::write_level(const LineGroup& group, std::uint8_t level, Bytes& to) {
  write_positions(group.runs, width, level, planes, to);
  // The chords are brought to this level by the visit, so every axis visits on its own; a visit only looks at its own axis.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (auto& t : trial) t.clear();
    const auto& u = state.u[axis];
    const auto code = [&](const LevelPlace& at) {
      for (std::size_t m = 0; m < kLevelModes; ++m)
        trial[m].push_back(u[at.point] - predict(state, axis, static_cast<LevelMode>(m), at));
    };
    const auto code_end = [&](PointIndex point, PointIndex previous) {
      const std::int64_t residual = previous == point ? u[point] : std::int64_t{u[point]} - u[previous];
      for (std::size_t m = 0; m < kLevelModes; ++m) trial[m].push_back(residual);
    };
    visit_level(state, group.runs, axis, level == 0, code, code_end);
    put_best(kLevelModes, to);
  }
}

std::array<GroupEncoder::Impl::RestChoice, 3> GroupEncoder::Impl::choose_rest(const LineGroup& group, std::size_t along) {
  constexpr std::size_t kSample = 8192;
  const std::size_t stride = std::max<std::size_t>(1, state.fresh.size() / kSample);
  std::array<RestChoice, 3> choice{};
  std::array<WeightFit, 3> fits;
  std::size_t i = 0;
  visit_rest(state, group, along, [&](const RestPlace& at) {
    if (i++ % stride != 0) return;
    for (std::size_t axis = 0; axis < 3; ++axis)
      fits[axis].add(deviations(state, axis, at), std::int64_t{state.u[axis][at.point]} - state.chord[axis][at.point]);
  });
  for (std::size_t axis = 0; axis < 3; ++axis) choice[axis].weights = fits[axis].solve();

  std::array<std::array<std::uint64_t, kRestModes>, 3> costs{};
  i = 0;
  visit_rest(state, group, along, [&](const RestPlace& at) {
    if (i++ % stride != 0) return;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t m = 0; m < kRestModes; ++m)
        costs[axis][m] +=
            cost(state.u[axis][at.point] - predict(state, axis, static_cast<RestMode>(m), choice[axis].weights, at));
  });
  for (std::size_t axis = 0; axis < 3; ++axis)
    choice[axis].mode = static_cast<RestMode>(std::ranges::min_element(costs[axis]) - costs[axis].begin());
  return choice;
}

void GroupEncoder::Impl::write_rest(const LineGroup& group, Bytes& to) {
  const std::size_t along = main_axis(group);
  const auto choice = choose_rest(group, along);
  to.push_back(static_cast<std::byte>(along));
  for (const RestChoice& c : choice) {
    to.push_back(static_cast<std::byte>(c.mode));
    if (c.mode == RestMode::fitted)
      for (const std::int16_t w : c.weights) put_signed(to, w);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) trial[axis].clear();
  visit_rest(state, group, along, [&](const RestPlace& at) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      trial[axis].push_back(state.u[axis][at.point] - predict(state, axis, choice[axis].mode, choice[axis].weights, at));
  });
  for (std::size_t axis = 0; axis < 3; ++axis) planes.put_planes(to, trial[axis]);
}

// What the coded steps leave over: remainders of axes whose step not all values share, IEEE residuals.
void GroupEncoder::Impl::write_leftovers(const LineGroup& group, Bytes& to) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!scales[axis].split) continue;
    residuals.clear();
    for (const PointIndex i : state.fresh) residuals.push_back(scales[axis].remainder(group.xyz[axis][i]));
    planes.put_planes(to, residuals);
  }
  for (const auto& axis : group.ulp) {
    if (axis.empty()) return;
    residuals.clear();
    for (const PointIndex i : state.fresh) residuals.push_back(axis[i]);
    planes.put_planes(to, residuals);
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

  s.width.resize(points);
  std::array<double, kMaxLevels + 2> farthest{}; // per alpha-width: the largest finite D
  for (std::size_t i = 0; i < points; ++i) {
    s.width[i] = static_cast<std::uint8_t>(alpha.width(ranks.distance[i]));
    if (std::isfinite(ranks.distance[i])) farthest[s.width[i]] = std::max(farthest[s.width[i]], ranks.distance[i]);
  }

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
  for (Bytes& payload : out.payloads) payload.assign(kPayloadHeaderSize, std::byte{});

  s.load(group);
  s.table.clear();
  write_line_table(group, s.scales, !group.ulp[0].empty(), s.table);
  s.planes.put_blob(out.payloads[0], s.table);
  header.left_out = *std::ranges::max_element(farthest);
  header.points = static_cast<std::uint32_t>(points);
  seal_payload(header, out.payloads[0]);

  for (std::uint8_t k = 0; k <= levels; ++k) {
    Bytes& payload = out.payloads[k + 1U];
    s.state.fresh.clear();
    for (std::size_t i = 0; i < points; ++i)
      if (s.width[i] == k) s.state.fresh.push_back(static_cast<PointIndex>(i));
    if (k < levels)
      s.write_level(group, k, payload);
    else
      s.write_rest(group, payload);
    s.write_leftovers(group, payload);
    header.kind = k < levels ? PayloadKind::level : PayloadKind::rest;
    header.level = k;
    header.points = static_cast<std::uint32_t>(s.state.fresh.size());
    header.tolerance = k < levels ? alpha.tolerances[k] : 0.0;
    header.left_out = *std::max_element(farthest.begin() + k + 1, farthest.end());
    seal_payload(header, payload);
    s.state.merge_fresh();
  }
}

} // namespace scansion
