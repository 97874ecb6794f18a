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
/// Over a loss the clocks of sensor and host must agree to this for the sensor's to be believed.
constexpr std::int64_t kNearNs = 1'000'000'000;

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
  is_whole_ = is_skipping_ = refused_ = false;
  held_.drop();
  expected_.reset();
}

void ScipDecoder::expect(Expected expected) {
  geometry_ = scip::ScanGeometry(expected.sensor, expected.plan);
  expected_ = std::move(expected);
  has_line_ = refused_ = false;
  lost_while_away_.reset();
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
  if (expected.plan.is_polled)
    return echo.size() == head + expected.tail.size() && echo.starts_with(expected.head) && echo.ends_with(expected.tail);
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
      if (is_scan(frame)) {
        taken = take_scan(frame);
        if (taken == Taken::reply) return taken;
        break;
      }
      if (frame.status != "99") {
        counters_.accept();
        reply_ = frame;
        return Taken::reply;
      }
      taken = refuse(Reject::echo);
      break;
  }
  if (taken != Taken::nothing || !expected_) return taken;
  // A damaged end joins two messages: the second one may be whole.
  const std::size_t again = text.rfind(expected_->head);
  return again == std::string_view::npos || again == 0 ? taken : take_frame(text.substr(again));
}

bool ScipDecoder::is_scan(const scip::Frame& frame) const noexcept {
  if (!is_expected(frame.echo)) return false;
  return expected_->plan.is_polled ? frame.status == "00" && !frame.body.empty() : frame.status == "99";
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
  if (const auto cause = take_values()) return refuse(*cause);
  if (is_repeated(*stamp)) {
    if (!expected_->plan.is_polled) return refuse(Reject::value);
    counters_.accept();
    reply_ = frame; // asked for sooner than there was another one
    return Taken::reply;
  }
  counters_.accept();
  stamp_ms_ = *stamp;
  fill_line();
  return Taken::line;
}

/// Whether it is the newest scan once more.
bool ScipDecoder::is_repeated(std::int64_t stamp_ms) const noexcept {
  const bool differ = expected_->plan.period_ns(expected_->sensor) >= 2 * kMillisecondNs; // the stamps of two scans
  return differ && has_line_ && stamp_ms == (clock_ms_ & (scip::kClockPeriodMs - 1));
}

bool ScipDecoder::is_distance(std::int32_t distance) const noexcept {
  const std::int32_t most = expected_->plan.kind == 'S' ? std::min(expected_->sensor.distance_max, kTwoCharacterCeiling - 1)
                                                        : expected_->sensor.distance_max;
  return distance >= expected_->sensor.distance_min && distance <= most;
}

/// The distance of the next step, of its echoes the one that was chosen. Empty: a character that cannot be.
std::optional<std::int32_t> ScipDecoder::take_step(std::string_view& data) const {
  const scip::ScanPlan& plan = expected_->plan;
  const std::size_t width = plan.width();
  const std::size_t part = plan.kind == 'S' ? 2 : 3;
  std::optional<std::int32_t> chosen;
  std::int32_t chosen_rank = -1;
  do {
    if (chosen) data.remove_prefix(1); // the mark of a further echo
    if (data.size() < width) return std::nullopt;
    const auto distance = scip::decode_number(data.substr(0, part));
    const auto intensity = width == 6 ? scip::decode_number(data.substr(part, part)) : 0;
    if (!distance || !intensity) return std::nullopt;
    data.remove_prefix(width);
    const std::int32_t rank = !is_distance(*distance)                   ? 0
                              : plan.echo == scip::EchoChoice::nearest  ? INT32_MAX - *distance
                              : plan.echo == scip::EchoChoice::farthest ? *distance
                                                                        : *intensity + 1;
    if (rank > chosen_rank) {
      chosen = distance;
      chosen_rank = rank;
    }
  } while (plan.has_echoes && !data.empty() && data.front() == scip::kEchoMark);
  return chosen;
}

std::optional<Reject> ScipDecoder::take_values() {
  const scip::ScanPlan& plan = expected_->plan;
  const auto steps = static_cast<std::size_t>(plan.values());
  if (!plan.has_echoes && data_.size() != steps * plan.width()) return Reject::count;
  values_.clear();
  for (std::string_view data = data_; !data.empty();) {
    if (values_.size() == steps) return Reject::count;
    const auto distance = take_step(data);
    if (!distance) return Reject::value;
    values_.push_back(*distance);
  }
  return values_.size() == steps ? std::nullopt : std::optional(Reject::count);
}

void ScipDecoder::fill_line() {
  const Expected& expected = *expected_;
  LineBuffer& held = held_.buffer();
  held.clear();
  const double gap = expected.gap_mm.value_or(0.0) * scip::kCountsPerMm;
  std::uint32_t invalid = 0;
  bool is_open = false; // a run is
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const std::int32_t distance = values_[i];
    if (!is_distance(distance)) {
      ++invalid;
      is_open = false;
      continue;
    }
    const auto [x, z] = geometry_.point(i, distance);
    if (is_open && expected.gap_mm) {
      is_open = std::hypot(1.0 * x - held.xyz[0].back(), 1.0 * z - held.xyz[2].back()) <= gap;
    }
    if (!is_open) {
      held.runs.push_back({static_cast<std::uint32_t>(held.points()), 0, std::exchange(invalid, 0)});
      is_open = true;
    }
    held.xyz[0].push_back(x);
    held.xyz[1].push_back(0); // put in place when the line's number is known
    held.xyz[2].push_back(z);
    ++held.runs.back().count;
  }
  held.invalid_after = invalid;
}

/// The first line of a run. How far the way went since the run before is counted by the sensor's clock, if that went on.
void ScipDecoder::take_first_clock(std::int64_t stamp_ms, const std::optional<Moment>& before, const Moment& at) {
  if (before) {
    const std::int64_t host_ns = at.monotonic_ns - before->monotonic_ns;
    const std::int64_t forward_ns = ((stamp_ms - clock_ms_) & (scip::kClockPeriodMs - 1)) * kMillisecondNs;
    const bool is_near = expected_->kept_clock && std::abs(forward_ns - host_ns) < kNearNs;
    const std::int64_t away_ns = is_near ? forward_ns : host_ns;
    const std::int64_t period_ns = expected_->plan.period_ns(expected_->sensor);
    const auto scans = static_cast<std::uint64_t>(std::max<std::int64_t>(1, (away_ns + period_ns / 2) / period_ns));
    lost_while_away_ = scans - 1;
    way_.go_on(scans, away_ns);
    number_ += scans;
  }
  clock_ms_ = stamp_ms;
}

std::optional<std::uint64_t> ScipDecoder::take_clock(std::int64_t stamp_ms, const Moment& at) {
  const std::optional<Moment> before = std::exchange(line_at_, at);
  if (!std::exchange(has_line_, true)) {
    take_first_clock(stamp_ms, before, at);
    return 0;
  }
  // Forwards by less than half a turn of the counter, or backwards.
  const std::int64_t forward = (stamp_ms - clock_ms_) & (scip::kClockPeriodMs - 1);
  const std::int64_t waited_ns = at.monotonic_ns - before->monotonic_ns;
  const std::int64_t period_ns = expected_->plan.period_ns(expected_->sensor);
  if (forward >= scip::kClockPeriodMs / 2 || (forward > kLeapMs && waited_ns / kMillisecondNs < forward / 2)) {
    way_.go_on(static_cast<std::uint64_t>(std::max<std::int64_t>(1, (waited_ns + period_ns / 2) / period_ns)), waited_ns);
    clock_ms_ = stamp_ms;
    ++number_;
    return std::nullopt;
  }
  clock_ms_ += forward;
  const std::int64_t scans = std::max<std::int64_t>(1, (forward * kMillisecondNs + period_ns / 2) / period_ns);
  number_ += static_cast<std::uint64_t>(scans);
  return static_cast<std::uint64_t>(scans - 1);
}

void ScipDecoder::place_line() {
  LineBuffer& held = held_.buffer();
  const std::int32_t way = counts_of(way_.at({number_, clock_ms_ * kMillisecondNs, 0}));
  std::fill(held.xyz[1].begin(), held.xyz[1].end(), way);
  held.plane = {0.0, 1.0, -static_cast<double>(way) / scip::kCountsPerMm};
  held.stamps.device_ns = clock_ms_ * kMillisecondNs;
}

Decoder::Step ScipDecoder::decode(std::span<const std::uint8_t> bytes, const Moment& at, LineBuffer& line, Gap& gap) {
  Step step;
  while (!held_.is_ready()) {
    if (!collect(bytes, step.used)) return step;
    const Taken taken = take_frame(std::string_view(frame_).substr(0, frame_.size() - 1));
    if (taken == Taken::nothing) continue;
    if (taken == Taken::reply) {
      step.what = Decoded::reply;
      return step;
    }
    const auto missing = take_clock(stamp_ms_, at);
    place_line();
    held_.ready();
    const bool refused = std::exchange(refused_, false);
    if (missing == std::optional<std::uint64_t>(0)) continue;
    return HeldLine::tell(step, gap, missing,
                          !missing  ? "the sensor's clock was set anew"
                          : refused ? "scans were damaged on their way"
                                    : "scans are missing");
  }
  return held_.give(step, line);
}

} // namespace scansion
