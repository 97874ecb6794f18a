// Which points of a recording an export takes.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/export/selection.hpp"

#include "pipeline/export/common_threshold.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

namespace scansion {
namespace {

__extension__ using U128 = unsigned __int128;

// Where a run's points are in the group, as spans the ranking takes.
RunPoints whole_run(const LineGroup& group, const Run& run) {
  const auto axis = [&](std::size_t a) { return std::span(group.xyz[a]).subspan(run.first, run.count); };
  return {axis(0), axis(1), axis(2), {}};
}

Result<std::uint64_t> parse_index(std::string_view text, std::string_view range) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size())
    return fail(Errc::usage, "lines '", range, "' are not A:B, A: or :B with whole numbers");
  return value;
}

} // namespace

Result<Rational> parse_reduction(std::string_view percent) {
  const auto wrong = [&] { return fail(Errc::usage, "reduction '", percent, "' is not a percentage from 0 to 100"); };
  if (percent == "0" || percent == "0.0") return Rational{1, 1};
  const auto parsed = parse_rational(percent);
  if (!parsed || parsed.value().den > (std::int64_t{1} << 40)) return wrong();
  const std::int64_t whole = 100 * parsed.value().den;
  const std::int64_t left = whole - parsed.value().num;
  if (left < 0 || parsed.value().num < 0) return wrong();
  if (left == 0) return Rational{0, 1};
  return make_rational(left, whole);
}

Result<std::pair<std::uint64_t, std::uint64_t>> parse_lines(std::string_view range) {
  const std::size_t colon = range.find(':');
  if (colon == std::string_view::npos) return fail(Errc::usage, "lines '", range, "' are not A:B, A: or :B");
  std::uint64_t first = 0;
  std::uint64_t end = std::numeric_limits<std::uint64_t>::max();
  if (colon > 0) {
    SCANSION_TRY(value, parse_index(range.substr(0, colon), range));
    first = value;
  }
  if (colon + 1 < range.size()) {
    SCANSION_TRY(value, parse_index(range.substr(colon + 1), range));
    end = value;
  }
  if (end <= first) return fail(Errc::usage, "lines '", range, "' are empty: B is the first line not taken");
  return std::pair{first, end};
}

std::uint64_t kept_of_run(std::uint64_t count, Rational share) noexcept {
  const auto m = static_cast<std::uint64_t>(static_cast<U128>(count) * static_cast<std::uint64_t>(share.num) /
                                            static_cast<std::uint64_t>(share.den));
  return std::min(count, std::max<std::uint64_t>(std::min<std::uint64_t>(count, 2), m + 1));
}

std::uint64_t kept_of_scan(std::uint64_t count, Rational share) noexcept {
  const auto den = static_cast<std::uint64_t>(share.den);
  return static_cast<std::uint64_t>((2 * static_cast<U128>(count) * static_cast<std::uint64_t>(share.num) + den) /
                                    (U128{2} * den));
}

Result<Selector> Selector::prepare(RecordingReader& reader, const Selection& selection) {
  SCANSION_TRY(resolution, resolution_mm(reader.facts().lattice));
  Selector selector(reader, selection, resolution);
  const RecordingFacts& facts = reader.facts();
  const bool lossless = facts.stored_levels == facts.level_count + 1;
  if (selection.kind == Selection::Kind::level && selection.level >= facts.stored_levels)
    return fail(Errc::usage, "level ", std::to_string(selection.level), " is not stored; the recording has levels 0 to ",
                std::to_string(facts.stored_levels - 1));
  if (selection.kind == Selection::Kind::reduction && !lossless)
    return fail(Errc::usage, "a reduction needs every point, and this recording was cut to level ",
                std::to_string(facts.stored_levels - 1));
  if (selection.kind == Selection::Kind::reduction && selection.scan_scope) {
    SCANSION_TRY(selector.find_common_threshold());
  }
  return selector;
}

// A selection by tolerance is answered from the coarsest level that holds all of it.
Result<std::uint32_t> Selector::level_needed(std::size_t group) {
  const RecordingFacts& facts = reader_->facts();
  const std::uint32_t stored = facts.stored_levels;
  switch (selection_.kind) {
    case Selection::Kind::level: return selection_.level;
    case Selection::Kind::all:
    case Selection::Kind::reduction: return stored - 1;
    case Selection::Kind::tolerance: break;
  }
  for (std::uint32_t k = 0; k < std::min(stored, facts.level_count); ++k) {
    SCANSION_TRY(header, reader_->read_header(group, k + 1));
    if (selection_.tolerance >= header.tolerance) return k;
  }
  if (stored == facts.level_count + 1) return stored - 1;
  return fail(Errc::usage, "this tolerance needs every point, and the recording was cut to level ", std::to_string(stored - 1));
}

void Selector::rank_known(const DecodedGroup& decoded, const Run& run) {
  if (decoded.lossless()) {
    distance_.resize(run.count);
    depth_.resize(run.count);
    ranker_.rank(whole_run(decoded.group, run), distance_, depth_);
    position_.resize(run.count);
    std::iota(position_.begin(), position_.end(), 0U);
    return;
  }
  position_.clear();
  for (auto& axis : xyz_) axis.clear();
  for (std::uint32_t i = 0; i < run.count; ++i) {
    if (decoded.width[run.first + i] == DecodedGroup::kUnknown) continue;
    position_.push_back(i);
    for (std::size_t axis = 0; axis < 3; ++axis) xyz_[axis].push_back(decoded.group.xyz[axis][run.first + i]);
  }
  distance_.resize(position_.size());
  depth_.resize(position_.size());
  ranker_.rank({xyz_[0], xyz_[1], xyz_[2], position_}, distance_, depth_);
}

void Selector::keep_by_tolerance(SelectedGroup& out) {
  out.error = out.decoded.left_out;
  for (const Run& run : out.decoded.group.runs) {
    rank_known(out.decoded, run);
    for (std::size_t i = 0; i < position_.size(); ++i) {
      const bool keep = distance_[i] > selection_.tolerance;
      out.keep[run.first + position_[i]] = keep ? 1 : 0;
      // Largest D left out = exact error, as long as everything above the tolerance is kept.
      if (!keep) out.error = std::max(out.error, distance_[i]);
    }
  }
}

void Selector::keep_reduced_run(const Run& run, SelectedGroup& out) {
  const std::uint64_t count = kept_of_run(run.count, selection_.kept_share);
  rank_known(out.decoded, run);
  sorter_.sort(distance_, depth_, order_);
  for (std::uint64_t i = 0; i < count; ++i) out.keep[run.first + order_[i]] = 1;
}

void Selector::keep_common_run(const Run& run, SelectedGroup& out) {
  rank_known(out.decoded, run);
  std::uint64_t tied = 0;
  for (std::uint32_t i = 0; i < run.count; ++i) {
    out.keep[run.first + i] = distance_[i] > threshold_ ? 1 : 0;
    if (distance_[i] == threshold_) ++tied;
  }
  const std::uint64_t take = std::min(tied, ties_);
  ties_ -= take;
  if (take == 0) return;
  sorter_.sort(distance_, depth_, order_);
  const auto first = std::ranges::find_if(order_, [&](std::uint32_t i) { return distance_[i] == threshold_; });
  for (auto i = first; i != first + static_cast<std::ptrdiff_t>(take); ++i) out.keep[run.first + *i] = 1;
}

void Selector::add_error(const Run& run, SelectedGroup& out) {
  const RunPoints points = whole_run(out.decoded.group, run);
  std::uint32_t left = 0;
  for (std::uint32_t i = 1; i < run.count; ++i) {
    if (out.keep[run.first + i] == 0) continue;
    for (std::uint32_t p = left + 1; p < i; ++p)
      out.error = std::max(out.error, segment_distance(points, p, left, i, ranker_.resolution()));
    left = i;
  }
}

Result<void> Selector::find_common_threshold() {
  CommonThreshold search;
  DecodedGroup decoded;
  while (true) {
    for (std::size_t g = 0; g < reader_->groups().size(); ++g) {
      SCANSION_TRY(read_all(g, decoded));
      for (const ScanLine& line : decoded.group.lines) {
        if (!selection_.has_line(line.index)) continue;
        for (const Run& run : decoded.group.runs_of(line)) {
          rank_known(decoded, run);
          search.add(distance_);
        }
      }
    }
    if (search.finish_pass(selection_.kept_share)) break;
  }
  threshold_ = search.threshold();
  ties_ = search.ties();
  return success();
}

Result<void> Selector::read_all(std::size_t group, DecodedGroup& out) {
  return reader_->read_group(group, reader_->facts().stored_levels - 1, out);
}

Result<void> Selector::select(std::size_t group, SelectedGroup& out) {
  SCANSION_TRY(level, level_needed(group));
  SCANSION_TRY(reader_->read_group(group, level, out.decoded));
  out.keep.assign(out.decoded.group.points(), 0);
  out.error = 0.0;
  switch (selection_.kind) {
    case Selection::Kind::all:
    case Selection::Kind::level:
      for (std::size_t i = 0; i < out.keep.size(); ++i) out.keep[i] = out.decoded.width[i] != DecodedGroup::kUnknown ? 1 : 0;
      out.error = out.decoded.left_out;
      return success();
    case Selection::Kind::tolerance: keep_by_tolerance(out); return success();
    case Selection::Kind::reduction: break;
  }
  for (const ScanLine& line : out.decoded.group.lines) {
    if (!selection_.has_line(line.index)) continue;
    for (const Run& run : out.decoded.group.runs_of(line)) {
      if (selection_.scan_scope)
        keep_common_run(run, out);
      else
        keep_reduced_run(run, out);
      add_error(run, out);
    }
  }
  return success();
}

} // namespace scansion
