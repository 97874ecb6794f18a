// The decoder of described streams: records to scan lines.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/stream/decoder.hpp"

#include <algorithm>
#include <cmath>

namespace scansion::stream {
namespace {

/// A number that leaps farther is wrong rather than true: how much is missing is then unknown.
constexpr std::int64_t kBelievedLeap = 1'000'000;

std::string_view trimmed(std::string_view text) noexcept {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

} // namespace

StreamDecoder::StreamDecoder(LinkCounters& counters, Plan plan, RecordReader reader)
    : counters_(counters), plan_(std::move(plan)), reader_(std::move(reader)), rows_(kMaxRow, counters), way_(plan_.spacing) {}

void StreamDecoder::reset() {
  rows_.reset();
  held_.clear();
  is_out_of_step_ = is_over_ = false;
  open_.clear();
  done_.clear();
  is_done_ = is_in_run_ = false;
  invalid_ = records_ = 0;
  last_at_.reset();
  gap_.reset();
  if (number_) number_before_ = std::exchange(number_, std::nullopt);
  direction_ = 0;
  is_away_ = true;
  lost_while_away_.reset();
}

/// A sample that did not arrive whole: the run ends here.
void StreamDecoder::lose(Reject cause) {
  counters_.reject(cause);
  ++invalid_;
  is_in_run_ = false;
}

void StreamDecoder::close_line(const Moment& over) {
  if (open_.points() == 0 && invalid_ == 0) return;
  open_.stamps.host_monotonic_ns = over.monotonic_ns;
  open_.stamps.host_realtime_ns = over.realtime_ns;
  open_.invalid_after = invalid_;
  std::swap(open_, done_);
  open_.clear();
  is_done_ = true;
  is_in_run_ = false;
  invalid_ = records_ = 0;
  direction_ = 0;
  last_at_.reset();
  ++line_;
}

/// The stamp is the same whether the clock or the next byte tells of the pause.
void StreamDecoder::close_after_pause() {
  const Moment last = *last_at_;
  close_line({last.monotonic_ns + plan_.pause_ns, last.realtime_ns + plan_.pause_ns});
}

/// Where a line without a y stands, by its first record.
std::int32_t StreamDecoder::way_counts() {
  const double mm = way_.at({line_, record_.time_ns.value_or(0), record_.encoder.value_or(0)});
  const double counts = mm / millimetres(plan_.unit).value() / plan_.resolution.value();
  const auto most = static_cast<double>(kMostCounts);
  return static_cast<std::int32_t>(std::lround(std::clamp(counts, -most, most)));
}

/// The first record after the device was away: what it counts tells what was lost.
void StreamDecoder::begin_run() {
  if (!std::exchange(is_away_, false)) return;
  if (record_.line && number_before_ && *record_.line > *number_before_ && *record_.line - *number_before_ <= kBelievedLeap) {
    lost_while_away_ = static_cast<std::uint64_t>(*record_.line - *number_before_ - 1);
    line_ += *lost_while_away_;
  }
  // A clock that begins anew: the way goes on for as long as the host waited.
  if (record_.time_ns && time_ && *record_.time_ns < *time_) way_.go_on(1, at_.monotonic_ns - record_at_.monotonic_ns);
}

void StreamDecoder::append() {
  if (open_.points() == 0) y_ = has(plan_.fields, Role::y) ? 0 : way_counts();
  if (!is_in_run_) open_.runs.push_back({static_cast<std::uint32_t>(open_.points()), 0, std::exchange(invalid_, 0U)});
  is_in_run_ = true;
  ++open_.runs.back().count;
  open_.xyz[0].push_back(static_cast<std::int32_t>(record_.xyz[0]));
  open_.xyz[1].push_back(y_ + static_cast<std::int32_t>(record_.xyz[1]));
  open_.xyz[2].push_back(static_cast<std::int32_t>(record_.xyz[2]));
}

/// The points from `keep` on begin a new line.
void StreamDecoder::split_line(std::uint32_t keep) {
  spare_.clear();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto& from = open_.xyz[axis];
    spare_.xyz[axis].assign(from.begin() + keep, from.end());
    from.resize(keep);
  }
  std::size_t whole = 0; // runs that stay, the last of them perhaps in part
  for (Run& run : open_.runs) {
    if (run.first + run.count <= keep) {
      ++whole;
      continue;
    }
    if (run.first >= keep) {
      spare_.runs.push_back({run.first - keep, run.count, run.invalid_before});
      continue;
    }
    ++whole;
    spare_.runs.push_back({0, run.first + run.count - keep, 0});
    run.count = keep - run.first;
  }
  open_.runs.resize(whole);
  const bool was_in_run = is_in_run_;
  const std::uint32_t invalid = std::exchange(invalid_, 0U);
  const Stamps stamps = open_.stamps;
  const std::optional<Moment> at = last_at_;
  close_line(at_);
  std::swap(open_, spare_);
  open_.stamps = stamps;
  is_in_run_ = was_in_run;
  invalid_ = invalid;
  last_at_ = at;
  records_ = static_cast<std::uint32_t>(open_.points());
  if (!has(plan_.fields, Role::y)) {
    y_ = way_counts();
    std::fill(open_.xyz[1].begin(), open_.xyz[1].end(), y_);
  }
}

/// A reversal ends the line at its farthest point; what went back already belongs to the next one.
void StreamDecoder::follow_axis() {
  const auto newest = static_cast<std::uint32_t>(open_.points() - 1);
  const std::int64_t here = open_.xyz[plan_.axis][newest];
  if (newest == 0) {
    turning_ = here;
    turning_at_ = 0;
    return;
  }
  const std::int64_t off = here - turning_;
  if (direction_ == 0) {
    if (std::abs(off) < plan_.turn) return; // too near the first point to tell
    direction_ = off > 0 ? 1 : -1;
  }
  if (off * direction_ >= 0) {
    turning_ = here;
    turning_at_ = newest;
    return;
  }
  if (-off * direction_ < plan_.turn) return;
  const int back = -direction_;
  split_line(turning_at_ + 1);
  direction_ = open_.points() > 1 ? back : 0;
  turning_ = here;
  turning_at_ = static_cast<std::uint32_t>(open_.points() - 1);
}

/// The field `line` of a record: another number begins another line.
void StreamDecoder::begin_line_at(std::int64_t number) {
  if (number_ == number) return;
  if (number_) { // what was lost before the first number belongs to the first line
    close_line(at_);
    const std::int64_t leap = number - *number_;
    if (leap > 1) {
      gap_.emplace();
      gap_->reason = "lines are missing";
      if (leap <= kBelievedLeap) {
        gap_->count = static_cast<std::uint64_t>(leap - 1);
        line_ += *gap_->count;
      }
    } else if (leap < 0 && number > 1) {
      gap_.emplace();
      gap_->reason = "the device counts its lines anew";
    }
  }
  number_ = number;
}

void StreamDecoder::take_record() {
  counters_.accept();
  begin_run();
  if (plan_.pause_ns > 0 && last_at_ && at_.monotonic_ns - last_at_->monotonic_ns >= plan_.pause_ns) close_after_pause();
  if (plan_.line_break == Break::field) begin_line_at(*record_.line);
  const bool is_full = open_.points() >= kMostPoints || (plan_.line_break == Break::points && records_ >= plan_.points);
  if (is_full) close_line(at_);
  last_at_ = at_;
  ++records_;
  if (record_.is_invalid) {
    ++invalid_;
    is_in_run_ = false;
  } else {
    append();
    if (plan_.line_break == Break::reversal) follow_axis();
  }
  record_at_ = at_;
  if (record_.time_ns) open_.stamps.device_ns = time_ = record_.time_ns;
  if (record_.encoder) open_.stamps.encoder = record_.encoder;
  // The last record of a line of known length ends it at once.
  if (plan_.line_break == Break::points && records_ == plan_.points) close_line(at_);
}

bool StreamDecoder::take_row(std::span<const std::uint8_t> bytes, std::size_t& used) {
  const auto whole = rows_.next(bytes, used);
  if (const std::uint64_t overlong = counters_.rejected(Reject::overlong); overlong != overlong_) {
    overlong_ = overlong;
    ++invalid_;
    is_in_run_ = false;
  }
  if (!whole) return false;
  read_row(trimmed(*whole));
  return true;
}

void StreamDecoder::read_row(std::string_view row) {
  if (row.empty()) {
    if (plan_.line_break == Break::blank) close_line(at_);
    return;
  }
  if (plan_.line_break == Break::mark && row == plan_.mark) {
    counters_.accept();
    close_line(at_);
    return;
  }
  if (!plan_.comment.empty() && row.starts_with(plan_.comment)) return;
  record_ = {};
  if (const auto cause = reader_.read(row, record_))
    lose(*cause);
  else
    take_record();
}

/// Looks for the next record from the byte after the false beginning. What follows until then is one loss.
void StreamDecoder::lose_step(Reject cause) {
  if (!std::exchange(is_out_of_step_, true)) lose(cause);
  held_.erase(held_.begin());
}

bool StreamDecoder::take_binary(std::span<const std::uint8_t> bytes, std::size_t& used) {
  const std::size_t wanted = plan_.record_bytes();
  const std::size_t part = std::min(wanted - held_.size(), bytes.size() - used);
  const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(used);
  held_.insert(held_.end(), from, from + static_cast<std::ptrdiff_t>(part));
  used += part;
  if (!std::equal(plan_.sync.begin(),
                  plan_.sync.begin() + static_cast<std::ptrdiff_t>(std::min(plan_.sync.size(), held_.size())), held_.begin())) {
    lose_step(Reject::framing);
    return true;
  }
  if (held_.size() < wanted) return false;
  if (plan_.sum != Checksum::none && !reader_.is_sum_right(held_)) {
    lose_step(Reject::checksum);
    return true;
  }
  is_out_of_step_ = false;
  record_ = {};
  const auto fields = std::span<const std::uint8_t>(held_).subspan(plan_.sync.size(), bytes_of(plan_.fields));
  if (const auto cause = reader_.read(fields, record_))
    lose(*cause);
  else
    take_record();
  held_.clear();
  return true;
}

std::int64_t StreamDecoder::look_for_pause(const Moment& now) {
  if (plan_.pause_ns == 0 || !last_at_) return INT64_MAX;
  const std::int64_t over = last_at_->monotonic_ns + plan_.pause_ns;
  if (now.monotonic_ns < over) return over;
  close_after_pause();
  return now.monotonic_ns;
}

/// The last row of a file may do without its line feed. A row or record that broke off is a sample that did not arrive whole.
void StreamDecoder::finish(const Moment& now, bool is_lost) {
  static_cast<void>(look_for_pause(now));
  const std::string_view row = trimmed(rows_.rest());
  if (!row.empty() && !is_lost)
    read_row(row);
  else if (!row.empty() || (!held_.empty() && !is_out_of_step_))
    lose(Reject::framing);
  is_over_ = true;
}

Decoder::Step StreamDecoder::decode(std::span<const std::uint8_t> bytes, const Moment& at, LineBuffer& line, Gap& gap) {
  Step step;
  at_ = at;
  for (;;) {
    if (std::exchange(is_done_, false)) {
      std::swap(line, done_);
      step.what = Decoded::line;
      return step;
    }
    if (gap_) {
      gap = std::move(*gap_);
      gap_.reset();
      step.what = Decoded::gap;
      return step;
    }
    if (std::exchange(is_over_, false)) {
      close_line(last_at_.value_or(at));
      continue;
    }
    if (!(plan_.is_binary ? take_binary(bytes, step.used) : take_row(bytes, step.used))) return step;
  }
}

} // namespace scansion::stream
