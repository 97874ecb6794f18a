// Payloads to groups, level by level. Every byte is hostile.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/codec.hpp"
#include "pipeline/codec/level_coder.hpp"
#include "pipeline/codec/planes.hpp"
#include "pipeline/codec/positions.hpp"
#include "pipeline/codec/rest_coder.hpp"

#include <algorithm>
#include <limits>

namespace scansion {

struct GroupDecoder::Impl {
  GroupState state;
  PlaneReader planes;
  AxisScales scales;
  bool exact = false;
  PayloadHeader lines;
  Bytes table;
  std::array<std::vector<std::int64_t>, 3> residuals;

  [[nodiscard]] bool put(std::size_t axis, PointIndex i, std::int64_t value) noexcept;
  [[nodiscard]] Result<void> read_level(ByteReader& from, const PayloadHeader& header, DecodedGroup& out);
  [[nodiscard]] Result<void> read_rest(ByteReader& from, const PayloadHeader& header, DecodedGroup& out);
  [[nodiscard]] Result<void> publish(ByteReader& from, DecodedGroup& out);
};

bool GroupDecoder::Impl::put(std::size_t axis, PointIndex i, std::int64_t value) noexcept {
  if (value < std::numeric_limits<std::int32_t>::min() || value > std::numeric_limits<std::int32_t>::max()) return false;
  state.u[axis][i] = static_cast<std::int32_t>(value);
  return true;
}

Result<void> GroupDecoder::Impl::read_level(ByteReader& from, const PayloadHeader& header, DecodedGroup& out) {
  SCANSION_TRY(read_positions(from, out.group.runs, out.width, header.level, header.points, planes, state.fresh));
  bool fits = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint8_t mode = from.byte();
    if (!from.ok() || mode >= kLevelModes) return fail(Errc::damaged, "a level names an unknown prediction");
    SCANSION_TRY(planes.get_planes(from, state.fresh.size(), residuals[axis]));
    const std::int64_t* residual = residuals[axis].data();
    const auto code = [&](const LevelPlace& at) {
      fits = put(axis, at.point, saturating_sum(predict(state, axis, static_cast<LevelMode>(mode), at), *residual++)) && fits;
    };
    const auto code_end = [&](PointIndex point, PointIndex previous) {
      const std::int64_t before = previous == point ? 0 : state.u[axis][previous];
      fits = put(axis, point, saturating_sum(before, *residual++)) && fits;
    };
    visit_level(state, out.group.runs, axis, header.level == 0, code, code_end);
  }
  if (!fits) return fail(Errc::damaged, "a level holds coordinates beyond 32 bits");
  return success();
}

Result<void> GroupDecoder::Impl::read_rest(ByteReader& from, const PayloadHeader& header, DecodedGroup& out) {
  state.fresh.clear();
  for (std::size_t i = 0; i < out.width.size(); ++i)
    if (out.width[i] == DecodedGroup::kUnknown) {
      out.width[i] = header.level;
      state.fresh.push_back(static_cast<PointIndex>(i));
    }
  if (state.fresh.size() != header.points)
    return fail(Errc::damaged, "the rest and its header disagree on the number of points");
  const std::size_t along = from.byte();
  if (along > 2) return fail(Errc::damaged, "the rest names an axis that does not exist");
  std::array<RestMode, 3> modes{};
  std::array<Weights, 3> weights{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::uint8_t mode = from.byte();
    if (mode >= kRestModes) return fail(Errc::damaged, "the rest names an unknown prediction");
    modes[axis] = static_cast<RestMode>(mode);
    if (modes[axis] != RestMode::fitted) continue;
    for (std::int16_t& w : weights[axis]) {
      const std::int64_t value = from.signed_varint();
      if (value != static_cast<std::int16_t>(value)) return fail(Errc::damaged, "the rest holds an impossible weight");
      w = static_cast<std::int16_t>(value);
    }
  }
  for (auto& axis : residuals) {
    SCANSION_TRY(planes.get_planes(from, state.fresh.size(), axis));
  }
  bool fits = true;
  std::size_t r = 0;
  visit_rest(state, out.group, along, [&](const RestPlace& at) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      fits =
          put(axis, at.point, saturating_sum(predict(state, axis, modes[axis], weights[axis], at), residuals[axis][r])) && fits;
    ++r;
  });
  if (!fits) return fail(Errc::damaged, "the rest holds coordinates beyond 32 bits");
  return success();
}

// Turns steps into counts, and reads what the steps leave over.
Result<void> GroupDecoder::Impl::publish(ByteReader& from, DecodedGroup& out) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const AxisScale& scale = scales[axis];
    const auto step = static_cast<std::int64_t>(scale.step);
    std::vector<std::int64_t>& rest = residuals[axis];
    rest.assign(scale.split ? 0 : state.fresh.size(), 0);
    if (scale.split) {
      SCANSION_TRY(planes.get_planes(from, state.fresh.size(), rest));
    }
    for (std::size_t i = 0; i < state.fresh.size(); ++i) {
      // |u| <= 2^31 and step < 2^32: the product fits.
      const std::int64_t value = saturating_sum(scale.base + step * state.u[axis][state.fresh[i]], rest[i]);
      if (value != static_cast<std::int32_t>(value)) return fail(Errc::damaged, "a coordinate is beyond 32 bits");
      out.group.xyz[axis][state.fresh[i]] = static_cast<std::int32_t>(value);
    }
  }
  for (std::size_t axis = 0; exact && axis < 3; ++axis) {
    SCANSION_TRY(planes.get_planes(from, state.fresh.size(), residuals[axis]));
    for (std::size_t i = 0; i < state.fresh.size(); ++i) out.group.ulp[axis][state.fresh[i]] = residuals[axis][i];
  }
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
  // The longest line table: per line its stamps and plane, per run two counts.
  constexpr std::size_t kMaxLineBytes = 96;
  constexpr std::size_t kMaxRunBytes = 10;
  const std::size_t limit = 64 + header.line_count * kMaxLineBytes + header.points * kMaxRunBytes;
  ByteReader from(lines_payload.subspan(kPayloadHeaderSize, header.body_size));
  SCANSION_TRY(s.planes.get_blob(from, limit, s.table));
  if (!from.at_end()) return fail(Errc::damaged, "bytes follow the line table");
  SCANSION_TRY(read_line_table(s.table, header, out.group, s.scales, s.exact));
  s.lines = header;
  s.state.reset(header.points);
  for (auto& axis : out.group.xyz) axis.assign(header.points, 0);
  for (auto& axis : out.group.ulp) axis.assign(s.exact ? header.points : 0, 0);
  out.width.assign(header.points, DecodedGroup::kUnknown);
  out.levels = header.levels;
  out.known_levels = 0;
  out.alpha = AlphaSet{.tolerances = {}, .epoch = header.epoch};
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
  ByteReader from(level_payload.subspan(kPayloadHeaderSize, header.body_size));
  SCANSION_TRY(rest ? s.read_rest(from, header, out) : s.read_level(from, header, out));
  SCANSION_TRY(s.publish(from, out));
  if (!from.at_end()) return fail(Errc::damaged, "bytes follow a level");
  s.state.merge_fresh();
  ++out.known_levels;
  out.left_out = header.left_out;
  if (!rest) out.alpha.tolerances.push_back(header.tolerance);
  return success();
}

} // namespace scansion
