// The decoder of SCIP 2.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/hokuyo-scip/scip_decoder.hpp"

#include "drivers/hokuyo-scip/scip_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace scansion {
namespace {

constexpr std::int64_t kMillisecondNs = 1'000'000;
/// Of two characters the largest also says "or more".
constexpr std::int32_t kTwoCharacterCeiling = 4095;
/// A clock that leaps further than this while the host waited for less than half of it was set anew.
constexpr std::int64_t kLeapMs = 10'000;

bool is_digit(char c) noexcept {
  return c >= '0' && c <= '9';
}

std::int32_t counts_of(double mm) noexcept {
  constexpr double kMost = 2e9;
  return static_cast<std::int32_t>(std::lround(std::clamp(mm * scip::kCountsPerMm, -kMost, kMost)));
}

} // namespace

void ScipDecoder::reset() {
  frame_.clear();
  is_whole_ = is_skipping_ = is_line_held_ = refused_ = false;
  expected_.reset();
}

void ScipDecoder::expect(Expected expected) {
  geometry_ = scip::ScanGeometry(expected.sensor, expected.plan);
  expected_ = std::move(expected);
  number_ = 0;
  has_line_ = refused_ = false;
}

bool ScipDecoder::collect(std::span<const std::uint8_t> bytes, std::size_t& used) {
  if (std::exchange(is_whole_, false)) frame_.clear();
  while (used < bytes.size()) {
    const auto rest = bytes.subspan(used);
    const void* at = std::memchr(rest.data(), '\n', rest.size());
    const std::size_t part =
        at == nullptr ? rest.size() : static_cast<std::size_t>(static_cast<const std::uint8_t*>(at) - rest.data()) + 1;
    used += part;
    if (!is_skipping_ && frame_.size() + part > kMaxFrame) {
      static_cast<void>(refuse(Reject::overlong));
      is_skipping_ = true;
      frame_ = "?";
    }
    if (!is_skipping_) {
      frame_.append(reinterpret_cast<const char*>(rest.data()), part);
    } else { // of what is skipped only its end matters
      const bool is_empty_line = part == 1 && at != nullptr && frame_.back() == '\n';
      frame_ = is_empty_line ? "\n\n" : at != nullptr ? "?\n" : "?";
    }
    if (at == nullptr) return false;
    // An empty line ends a message; empty lines between messages mean nothing.
    const bool is_end = frame_.size() < 2 || frame_[frame_.size() - 2] == '\n';
    if (!is_end) continue;
    if (frame_.size() < 2 || std::exchange(is_skipping_, false)) {
      frame_.clear();
      continue;
    }
    is_whole_ = true;
    return true;
  }
  return false;
}

ScipDecoder::Taken ScipDecoder::refuse(Reject cause) noexcept {
  counters_.reject(cause);
  refused_ = true;
  return Taken::nothing;
}

bool ScipDecoder::is_expected(std::string_view echo) const noexcept {
  if (!expected_) return false;
  const Expected& expected = *expected_;
  const std::size_t head = expected.head.size();
  return echo.size() == head + 2 + expected.tail.size() && echo.starts_with(expected.head) && echo.ends_with(expected.tail) &&
         is_digit(echo[head]) && is_digit(echo[head + 1]);
}

ScipDecoder::Taken ScipDecoder::take_frame(std::string_view text) {
  scip::Frame frame;
  Taken taken = Taken::nothing;
  switch (scip::parse_frame(text, frame)) {
    case scip::FrameFault::framing: taken = refuse(Reject::framing); break;
    case scip::FrameFault::checksum: taken = refuse(Reject::checksum); break;
    case scip::FrameFault::none:
      if (frame.status != "99") {
        counters_.accept();
        reply_ = frame;
        return Taken::reply;
      }
      taken = is_expected(frame.echo) ? take_scan(frame) : refuse(Reject::echo);
      break;
  }
  if (taken != Taken::nothing || !expected_) return taken;
  // A damaged end joins two messages: the second one may be whole.
  const std::size_t again = text.rfind(expected_->head);
  return again == std::string_view::npos || again == 0 ? taken : take_frame(text.substr(again));
}

ScipDecoder::Taken ScipDecoder::take_scan(const scip::Frame& frame) {
  std::string_view body = frame.body;
  const auto time = scip::take_summed(body);
  if (!time) return refuse(Reject::checksum);
  const auto stamp = time->size() == 4 ? scip::decode_number(*time) : std::nullopt;
  if (!stamp) return refuse(Reject::value);
  data_.clear();
  while (!body.empty()) {
    const auto part = scip::take_summed(body);
    if (!part) return refuse(Reject::checksum);
    if (part->size() > scip::kBlock || data_.size() % scip::kBlock != 0) return refuse(Reject::count);
    data_.append(*part);
  }
  const scip::ScanPlan& plan = expected_->plan;
  if (data_.size() != static_cast<std::size_t>(plan.values()) * plan.width()) return refuse(Reject::count);
  if (!take_values(data_)) return refuse(Reject::value);
  stamp_ms_ = *stamp;
  counters_.accept();
  fill_line();
  return Taken::line;
}

bool ScipDecoder::take_values(std::string_view data) {
  const std::size_t width = expected_->plan.width();
  const std::size_t part = width == 6 ? 3 : width;
  values_.clear();
  for (std::size_t at = 0; at < data.size(); at += width) {
    const auto distance = scip::decode_number(data.substr(at, part));
    if (!distance) return false;
    if (width == 6 && !scip::decode_number(data.substr(at + part, part))) return false;
    values_.push_back(*distance);
  }
  return true;
}

void ScipDecoder::fill_line() {
  const Expected& expected = *expected_;
  held_.clear();
  const std::int32_t most = expected.plan.kind == 'S' ? std::min(expected.sensor.distance_max, kTwoCharacterCeiling - 1)
                                                      : expected.sensor.distance_max;
  const double gap = expected.gap_mm.value_or(0.0) * scip::kCountsPerMm;
  std::uint32_t invalid = 0;
  bool is_open = false; // a run is
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const std::int32_t distance = values_[i];
    if (distance < expected.sensor.distance_min || distance > most) {
      ++invalid;
      is_open = false;
      continue;
    }
    const auto [x, z] = geometry_.point(i, distance);
    if (is_open && expected.gap_mm) {
      is_open = std::hypot(1.0 * x - held_.xyz[0].back(), 1.0 * z - held_.xyz[2].back()) <= gap;
    }
    if (!is_open) {
      held_.runs.push_back({static_cast<std::uint32_t>(held_.points()), 0, std::exchange(invalid, 0)});
      is_open = true;
    }
    held_.xyz[0].push_back(x);
    held_.xyz[1].push_back(0); // put in place when the line's number is known
    held_.xyz[2].push_back(z);
    ++held_.runs.back().count;
  }
  held_.invalid_after = invalid;
}

std::optional<std::uint64_t> ScipDecoder::take_clock(std::int64_t stamp_ms, const Moment& at) {
  const Moment before = std::exchange(line_at_, at);
  if (!std::exchange(has_line_, true)) {
    clock_ms_ = first_clock_ms_ = stamp_ms;
    return 0;
  }
  // Forwards by less than half a turn of the counter, or backwards.
  const std::int64_t forward = (stamp_ms - clock_ms_) & (scip::kClockPeriodMs - 1);
  const std::int64_t waited_ms = (at.monotonic_ns - before.monotonic_ns) / kMillisecondNs;
  if (forward >= scip::kClockPeriodMs / 2 || (forward > kLeapMs && waited_ms < forward / 2)) {
    // Lines so far keep their way; the clock begins anew.
    first_clock_ms_ = stamp_ms - (clock_ms_ - first_clock_ms_);
    clock_ms_ = stamp_ms;
    return std::nullopt;
  }
  clock_ms_ += forward;
  const std::int64_t period_ns = expected_->plan.period_ns(expected_->sensor);
  const std::int64_t scans = (forward * kMillisecondNs + period_ns / 2) / period_ns;
  return scans > 1 ? static_cast<std::uint64_t>(scans - 1) : 0;
}

Decoder::Step ScipDecoder::decode(std::span<const std::uint8_t> bytes, const Moment& at, LineBuffer& line, Gap& gap) {
  Step step;
  while (!is_line_held_) {
    if (!collect(bytes, step.used)) return step;
    const Taken taken = take_frame(std::string_view(frame_).substr(0, frame_.size() - 1));
    if (taken == Taken::nothing) continue;
    if (taken == Taken::reply) {
      step.what = Decoded::reply;
      return step;
    }
    const bool is_first = !has_line_;
    const auto missing = take_clock(stamp_ms_, at);
    number_ += (is_first ? 0 : 1) + missing.value_or(0);
    const double way = expected_->spacing.way_mm(number_, (clock_ms_ - first_clock_ms_) * kMillisecondNs, 0);
    std::fill(held_.xyz[1].begin(), held_.xyz[1].end(), counts_of(way));
    held_.plane = {0.0, 1.0, -static_cast<double>(counts_of(way)) / scip::kCountsPerMm};
    held_.stamps.device_ns = clock_ms_ * kMillisecondNs;
    is_line_held_ = true;
    const bool refused = std::exchange(refused_, false);
    if (missing == std::optional<std::uint64_t>(0)) continue;
    gap.count = missing;
    gap.reason = !missing  ? "the sensor's clock was set anew"
                 : refused ? "scans were damaged on their way"
                           : "scans are missing";
    step.what = Decoded::gap;
    return step;
  }
  is_line_held_ = false;
  std::swap(line, held_);
  step.what = Decoded::line;
  return step;
}

} // namespace scansion
