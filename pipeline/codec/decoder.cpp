// Payloads to groups, level by level. Every byte is hostile.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/codec.hpp"
#include "pipeline/codec/kernels.hpp"
#include "pipeline/codec/level_values.hpp"
#include "pipeline/codec/planes.hpp"
#include "pipeline/codec/positions.hpp"
#include "pipeline/codec/rest_coder.hpp"
#include "pipeline/codec/ruling.hpp"

#include <algorithm>

namespace scansion {

struct GroupDecoder::Impl {
  GroupState state;
  PlaneReader planes;
  SymbolReader symbols;
  GroupFacts facts;
  AxisScales& scales = facts.scales;
  PayloadHeader lines;
  Bytes table;
  Ruling ruling;
  Neighbours neighbours;
  std::array<RestAxis, 3> rest_axes;
  std::size_t along = 0; ///< the axis along which lines run
  bool has_neighbours = false;
  std::vector<PointIndex> points; ///< that the payload at hand adds, ascending
  std::size_t rest_points = 0;
  std::vector<std::int64_t> residuals;

  [[nodiscard]] Result<void> read_even_ends(ByteReader& from, const LineGroup& group);
  [[nodiscard]] Result<void> read_level(ByteReader& from, const PayloadHeader& header, const LineGroup& group);
  [[nodiscard]] Result<void> read_rest(ByteReader& from, const PayloadHeader& header, const DecodedGroup& out);
  [[nodiscard]] Result<void> read_rest_axis(ByteReader& from, const LineGroup& group, std::size_t axis);
  [[nodiscard]] Result<void> read_fitted_axis(ByteReader& from, const LineGroup& group, std::size_t axis, bool with_above);
  void find_neighbours(const LineGroup& group);
  [[nodiscard]] Result<void> unfold_fan(LineGroup& group);
  [[nodiscard]] Result<void> publish(ByteReader& from, const PayloadHeader& header, DecodedGroup& out);
};

Result<void> GroupDecoder::Impl::read_even_ends(ByteReader& from, const LineGroup& group) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!scales[axis].even) continue;
    EvenStart start;
    auto& u = state.u[axis];
    for (std::int32_t* const value : {&start.first, &start.advance}) *value = wrap(from.signed_varint());
    if (!scales[axis].ruled) start.step = wrap(from.signed_varint());
    SCANSION_TRY(symbols.begin(from));
    if (scales[axis].ruled) {
      SCANSION_TRY(ruling.read(group.runs, start.first, start.advance, symbols, u));
      if (!symbols.finish()) return fail(Errc::damaged, "a ruled axis is damaged");
      continue;
    }
    visit_even_ends(group.runs, u, start, [&](PointIndex i, std::int32_t guess, std::uint32_t context) {
      u[i] = wrap(std::int64_t{guess} + symbols.next(context));
    });
    if (!symbols.finish()) return fail(Errc::damaged, "the ends of even runs are damaged");
    fill_even(group.runs, u);
  }
  return success();
}

Result<void> GroupDecoder::Impl::read_level(ByteReader& from, const PayloadHeader& header, const LineGroup& group) {
  const bool coarsest = header.level == 0;
  std::size_t limit = header.points;
  if (coarsest) {
    SCANSION_TRY(read_even_ends(from, group));
    align_runs(group, scales, state);
    for (const Run& run : group.runs) {
      state.known.push_back(run.first);
      if (run.count > 1) state.known.push_back(run.first + run.count - 1);
    }
    if (state.known.size() > limit) return fail(Errc::damaged, "a level and its header disagree on the number of points");
    limit -= state.known.size();
  }
  const std::uint8_t follow = from.byte();
  if (follow > 1) return fail(Errc::damaged, "a level tells its points in an unknown way");
  SCANSION_TRY(symbols.begin(from));
  SCANSION_TRY(read_positions(group.runs, follow != 0, state, limit, symbols));
  if (!symbols.finish() || state.fresh.size() != limit)
    return fail(Errc::damaged, "a level and its header disagree on the number of points");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (scales[axis].even) continue;
    const std::uint8_t mode = from.byte();
    if (!from.ok() || mode >= kLevelModes) return fail(Errc::damaged, "a level names an unknown prediction");
    SCANSION_TRY(symbols.begin(from));
    auto& u = state.u[axis];
    visit_level(state, group.runs, axis, coarsest, [&](PointIndex i, const LevelGuess& guess, std::uint32_t context) {
      u[i] = wrap(std::int64_t{guess[mode]} + symbols.next(context));
    });
    if (!symbols.finish()) return fail(Errc::damaged, "the coordinates of a level are damaged");
  }
  points.clear();
  for (std::size_t v = 0; v < state.vertices.size(); ++v)
    if (coarsest || state.added[v] != 0) points.push_back(state.vertices[v]);
  return success();
}

// Lines that leave the line before alone never ask for this.
void GroupDecoder::Impl::find_neighbours(const LineGroup& group) {
  if (has_neighbours) return;
  has_neighbours = true;
  std::vector<std::int32_t>& chord = rest_axes[along].chord;
  if (!scales[along].even) fill_chord(state.known, state.u[along], chord);
  neighbours.find(group, state, scales[along], scales[along].even ? state.u[along] : chord);
}

Result<void> GroupDecoder::Impl::read_fitted_axis(ByteReader& from, const LineGroup& group, std::size_t axis, bool with_above) {
  Weights weights{};
  for (std::int16_t& w : std::span(weights).first(with_above ? kWeights : kLineWeights)) {
    const std::int64_t value = from.signed_varint();
    if (value != static_cast<std::int16_t>(value)) return fail(Errc::damaged, "the rest holds an impossible weight");
    w = static_cast<std::int16_t>(value);
  }
  SCANSION_TRY(symbols.begin_long(from, rest_points));
  std::vector<std::int32_t>& u = state.u[axis];
  if (with_above) {
    find_neighbours(group);
    fill_chord(state.known, u, rest_axes[axis].chord);
  }
  take_fitted(group, state.known, with_above ? &neighbours : nullptr, weights, u, rest_axes[axis], symbols);
  if (!symbols.finish()) return fail(Errc::damaged, "the coordinates of the rest are damaged");
  return success();
}

Result<void> GroupDecoder::Impl::read_rest_axis(ByteReader& from, const LineGroup& group, std::size_t axis) {
  const std::uint8_t byte = from.byte();
  if (!from.ok() || byte >= kRestModes) return fail(Errc::damaged, "the rest names an unknown prediction");
  const auto mode = static_cast<RestMode>(byte);
  if (mode == RestMode::fitted || mode == RestMode::line) return read_fitted_axis(from, group, axis, mode == RestMode::fitted);
  auto& u = state.u[axis];
  auto& chord = rest_axes[axis].chord;
  find_neighbours(group);
  fill_chord(state.known, u, chord);
  SCANSION_TRY(planes.get_planes(from, rest_points, residuals));
  std::size_t r = 0;
  visit_rest(group, state.known, neighbours, [&](const RestLine& line, PointIndex run_first, PointIndex first, PointIndex end) {
    for (PointIndex i = first; i < end; ++i)
      u[i] = wrap(predict_plain(mode, neighbours, line, u, chord, run_first, i) + std::int64_t{wrap(residuals[r++])});
  });
  return success();
}

Result<void> GroupDecoder::Impl::read_rest(ByteReader& from, const PayloadHeader& header, const DecodedGroup& out) {
  rest_points = out.width.size() - state.known.size();
  if (rest_points != header.points) return fail(Errc::damaged, "the rest and its header disagree on the number of points");
  along = from.byte();
  if (!from.ok() || along > 2) return fail(Errc::damaged, "the rest names an axis that does not exist");
  has_neighbours = false;
  for (RestAxis& axis : rest_axes) axis.make_room(out.width.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (scales[axis].even) continue;
    SCANSION_TRY(read_rest_axis(from, out.group, axis));
  }
  return success();
}

// Ranges and directions to coordinates.
Result<void> GroupDecoder::Impl::unfold_fan(LineGroup& group) {
  const Fan& fan = facts.fan;
  auto& x = group.xyz[fan.range_axis];
  auto& y = group.xyz[fan.direction_axis];
  for (const PointIndex i : points) {
    const std::int32_t range = x[i];
    const std::int32_t direction = y[i];
    if (direction < 0 || static_cast<std::size_t>(direction) >= fan.directions.size())
      return fail(Errc::damaged, "a point lies on a direction that its fan does not have");
    x[i] = fan.coordinate(0, direction, range);
    y[i] = fan.coordinate(1, direction, range);
  }
  return success();
}

// Turns steps into counts, and reads what the steps leave over.
Result<void> GroupDecoder::Impl::publish(ByteReader& from, const PayloadHeader& header, DecodedGroup& out) {
  const bool rest = header.kind == PayloadKind::rest;
  // Where a step is all there is to a coordinate, all points are done at once in the end.
  const bool plain = !facts.exact && facts.fan.empty() && std::ranges::none_of(scales, &AxisScale::split);
  if (rest && !plain) {
    points.clear();
    for (std::size_t i = 0; i < out.width.size(); ++i)
      if (out.width[i] == DecodedGroup::kUnknown) points.push_back(static_cast<PointIndex>(i));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const AxisScale& scale = scales[axis];
    auto& to = out.group.xyz[axis];
    const auto& u = state.u[axis];
    const auto base = static_cast<std::uint32_t>(scale.base);
    if (rest && plain)
      kernels::from_steps(u.data(), base, scale.step, to.data(), to.size());
    else
      for (const PointIndex i : points) to[i] = static_cast<std::int32_t>(base + scale.step * static_cast<std::uint32_t>(u[i]));
  }
  if (!facts.fan.empty()) {
    SCANSION_TRY(unfold_fan(out.group));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!scales[axis].split) continue;
    SCANSION_TRY(planes.get_planes(from, points.size(), residuals));
    for (std::size_t p = 0; p < points.size(); ++p) {
      std::int32_t& to = out.group.xyz[axis][points[p]];
      to = wrap(to + std::int64_t{wrap(residuals[p])});
    }
  }
  for (std::size_t axis = 0; facts.exact && axis < 3; ++axis) {
    SCANSION_TRY(planes.get_planes(from, points.size(), residuals));
    for (std::size_t p = 0; p < points.size(); ++p) out.group.ulp[axis][points[p]] = residuals[p];
  }
  if (rest)
    kernels::cap(out.width.data(), header.level, out.width.size());
  else
    for (const PointIndex i : points) out.width[i] = header.level;
  return success();
}

GroupDecoder::GroupDecoder() : impl_(std::make_unique<Impl>()) {}
GroupDecoder::~GroupDecoder() = default;
GroupDecoder::GroupDecoder(GroupDecoder&&) noexcept = default;
GroupDecoder& GroupDecoder::operator=(GroupDecoder&&) noexcept = default;

Result<void> GroupDecoder::begin(ByteView lines_payload, DecodedGroup& out) {
  Impl& s = *impl_;
  SCANSION_TRY(header, check_payload(lines_payload));
  if (header.kind != PayloadKind::lines) return fail(Errc::damaged, "a group does not begin with its line table");
  // The longest line table: per line its stamps and plane, per run two counts, per direction of a fan its vector.
  constexpr std::size_t kMaxLineBytes = 96;
  constexpr std::size_t kMaxRunBytes = 10;
  constexpr std::size_t kMaxDirectionBytes = 20;
  const std::size_t directions = std::min<std::size_t>(header.points, kMaxDirections);
  const std::size_t limit =
      128 + header.line_count * kMaxLineBytes + header.points * kMaxRunBytes + directions * kMaxDirectionBytes;
  ByteReader from(lines_payload.subspan(header_size(header), header.body_size));
  SCANSION_TRY(s.planes.get_blob(from, limit, s.table));
  if (!from.at_end()) return fail(Errc::damaged, "bytes follow the line table");
  SCANSION_TRY(read_line_table(s.table, header, out.group, s.facts));
  s.lines = header;
  s.state.reset(header.points);
  for (auto& axis : out.group.xyz) axis.assign(header.points, 0);
  for (auto& axis : out.group.ulp) axis.assign(s.facts.exact ? header.points : 0, 0);
  out.width.assign(header.points, DecodedGroup::kUnknown);
  out.levels = header.levels;
  out.known_levels = 0;
  out.alpha.tolerances.clear();
  out.alpha.epoch = header.epoch;
  out.left_out = header.left_out;
  return success();
}

Result<void> GroupDecoder::add(ByteView level_payload, DecodedGroup& out) {
  Impl& s = *impl_;
  SCANSION_TRY(header, check_payload(level_payload));
  const bool rest = header.kind == PayloadKind::rest;
  if (header.kind == PayloadKind::lines || header.level != out.known_levels)
    return fail(Errc::damaged, "the levels of a group are out of order");
  if (header.stream != s.lines.stream || header.group != s.lines.group || header.levels != s.lines.levels ||
      header.first_line != s.lines.first_line || header.line_count != s.lines.line_count || header.epoch != s.lines.epoch ||
      header.points > s.lines.points)
    return fail(Errc::damaged, "a level belongs to another group");
  ByteReader from(level_payload.subspan(header_size(header), header.body_size));
  if (!rest && header.level > 0 && header.points == 0) {
    s.state.pass_level(out.group.runs);
  } else {
    SCANSION_TRY(rest ? s.read_rest(from, header, out) : s.read_level(from, header, out.group));
    SCANSION_TRY(s.publish(from, header, out));
  }
  if (!from.at_end()) return fail(Errc::damaged, "bytes follow a level");
  s.state.end_level();
  ++out.known_levels;
  out.left_out = header.left_out;
  if (!rest) out.alpha.tolerances.push_back(header.tolerance);
  return success();
}

} // namespace scansion
