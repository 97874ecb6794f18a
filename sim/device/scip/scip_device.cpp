// A SCIP 2 line scanner: its life, its clock and its scan messages.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/scip/scip_device.hpp"

#include "drivers/hokuyo-scip/scip_text.hpp"

#include <algorithm>
#include <cstdio>

namespace scansion {
namespace {

constexpr std::int64_t kMillisecondNs = 1'000'000;
constexpr std::int32_t kTwoCharacterCeiling = 4095;

/// 0 to 99.
std::string two_digits(std::int32_t value) {
  return {static_cast<char>('0' + value / 10 % 10), static_cast<char>('0' + value % 10)};
}

} // namespace

ScipDevice::ScipDevice(LineSource source, ScipPlan plan)
    : source_(std::move(source)), plan_(std::move(plan)), random_(plan_.seed, 0, 1),
      is_streaming_from_before_(plan_.starts_streaming) {
  const PlayedBox& box = source_.box();
  place_ = {(box.min_along + box.max_along) / 2.0, box.max_z + plan_.standoff_mm};
  if (plan_.rate) plan_.model.turns_a_minute = static_cast<std::int32_t>(std::max(1.0, *plan_.rate * 60.0 + 0.5));
}

void ScipDevice::power_up(std::int64_t now_ns) {
  power_up_ns_ = now_ns;
  clock_offset_ms_ = plan_.clock_ms;
  scans_ = 0;
  input_.clear();
  replies_.clear();
  measuring_.reset();
  is_lit_ = is_in_clock_mode_ = sleeps_ = false;
  is_in_scip1_ = plan_.starts_in_scip1;
  baud_ = plan_.baud;
  if (!std::exchange(is_streaming_from_before_, false)) return;
  char request[32];
  std::snprintf(request, sizeof request, "MD%04d%04d01000;old", plan_.model.first, plan_.model.last);
  take_request(request, now_ns);
  replies_.clear(); // given long ago
}

void ScipDevice::disconnected(std::int64_t /*now_ns*/) {
  input_.clear();
  replies_.clear();
  if (plan_.stops_on_disconnect) put_out_light();
}

void ScipDevice::put_out_light() {
  measuring_.reset();
  is_lit_ = false;
}

std::int64_t ScipDevice::period_ns() const noexcept {
  return plan_.rate ? static_cast<std::int64_t>(1e9 / *plan_.rate) : 60'000'000'000 / plan_.model.turns_a_minute;
}

std::uint32_t ScipDevice::clock_at(std::int64_t now_ns) const noexcept {
  const std::int64_t run_ns = plan_.at_maximum ? scans_ * period_ns() : now_ns - power_up_ns_;
  const double ms = static_cast<double>(run_ns) / kMillisecondNs * (1.0 + plan_.drift_ppm * 1e-6);
  const std::int64_t whole = clock_offset_ms_ + static_cast<std::int64_t>(ms);
  return static_cast<std::uint32_t>(whole & (scip::kClockPeriodMs - 1));
}

void ScipDevice::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  constexpr std::size_t kLongest = 256;
  for (const std::uint8_t byte : bytes) {
    const bool is_second_of_two = std::exchange(was_return_, byte == '\r') && byte == '\n';
    if (byte != '\n' && byte != '\r') {
      if (input_.size() < kLongest) input_ += static_cast<char>(byte);
      continue;
    }
    if (is_second_of_two) continue;
    std::string request;
    std::swap(request, input_);
    if (!request.empty() || is_in_scip1_) take_request(request, now_ns); // SCIP 1.1 answers an empty line, too
  }
}

std::int64_t ScipDevice::next_at() const {
  if (!replies_.empty()) return 0;
  if (!measuring_) return kNoTime;
  return plan_.at_maximum ? 0 : measuring_->next_ns;
}

bool ScipDevice::send(std::int64_t now_ns, std::vector<std::uint8_t>& out) {
  if (!replies_.empty()) {
    out.insert(out.end(), replies_.front().begin(), replies_.front().end());
    replies_.pop_front();
    return true;
  }
  message_.clear();
  if (!scan_message(now_ns, message_)) return false;
  if (bad_sums_ > 0.0 && random_.uniform() < bad_sums_) {
    // A character of the data changes and its sum does not.
    const std::size_t at = message_.size() / 2;
    if (message_[at] != '\n' && message_[at + 1] != '\n') message_[at] = message_[at] == '0' ? '1' : '0';
  }
  out.insert(out.end(), message_.begin(), message_.end());
  return true;
}

bool ScipDevice::look(std::int64_t now_ns) {
  auto more = source_.next(line_);
  if (!more || !more.assume_value()) return false;
  scip_scan(line_, source_, plan_.model, place_, samples_);
  last_look_ns_ = now_ns;
  return true;
}

bool ScipDevice::look_once(std::int64_t now_ns) {
  if (samples_.empty() || plan_.at_maximum || last_look_ns_ < power_up_ns_) {
    ++scans_;
    return look(now_ns) || !samples_.empty();
  }
  // The sensor turns on whether anybody asks or not, and the part moves under it.
  constexpr std::int64_t kMostTurns = 10'000;
  const std::int64_t turns = (now_ns - last_look_ns_) / period_ns();
  for (std::int64_t turn = 0; turn < std::min(turns, kMostTurns); ++turn) {
    if (!look(last_look_ns_ + period_ns())) break;
    ++scans_;
  }
  return true;
}

bool ScipDevice::scan_message(std::int64_t now_ns, std::string& text) {
  if (!measuring_ || (!plan_.at_maximum && now_ns < measuring_->next_ns)) return false;
  Measuring& measuring = *measuring_;
  const std::int64_t turns = measuring.skip + 1;
  const std::int64_t scan_ns = measuring.next_ns - measuring.late_ns - period_ns();
  measuring.late_ns = static_cast<std::int64_t>(plan_.jitter_ms * random_.uniform() * kMillisecondNs);
  measuring.next_ns = scan_ns + period_ns() * (turns + 1) + measuring.late_ns;
  if (status_fault_ != 0) {
    scans_ += turns;
    const std::string status = two_digits(status_fault_);
    text = measuring.head + "00" + measuring.tail + "\n" + status + scip::sum_of(status) + "\n\n";
    if (status_fault_ >= 50 && status_fault_ <= 97) put_out_light();
    return true;
  }
  for (std::int64_t turn = 0; turn < turns; ++turn) { // the part moves on under a skipped scan, too
    if (!look(now_ns)) {
      measuring.next_ns = kNoTime; // the part is through: nothing more to see
      return false;
    }
  }
  if (!measuring.is_endless) --measuring.remaining;
  text = measuring.head + two_digits(measuring.is_endless ? 0 : measuring.remaining) + measuring.tail + "\n99b\n";
  append_scan(text, measuring, scan_ns);
  scans_ += turns;
  if (!measuring.is_endless && measuring.remaining == 0) put_out_light();
  return true;
}

void ScipDevice::append_block(std::string& text, std::string_view data) const {
  for (std::size_t at = 0; at < data.size(); at += scip::kBlock) {
    const std::string_view part = data.substr(at, scip::kBlock);
    text.append(part);
    text += scip::sum_of(part);
    text += '\n';
  }
}

void ScipDevice::append_sample(const Measuring& measuring, const ScipSample& sample) {
  for (std::size_t i = 0; i < (measuring.has_echoes ? sample.count : 1); ++i) {
    const auto distance = static_cast<std::uint32_t>(sample.echoes[i].distance);
    if (i > 0) data_ += scip::kEchoMark;
    if (measuring.kind == 'S')
      scip::encode_number(data_, std::min<std::uint32_t>(distance, kTwoCharacterCeiling), 2);
    else
      scip::encode_number(data_, distance, 3);
    if (measuring.kind == 'E') scip::encode_number(data_, static_cast<std::uint32_t>(sample.echoes[i].intensity), 3);
  }
}

void ScipDevice::append_scan(std::string& text, const Measuring& measuring, std::int64_t scan_ns) {
  data_.clear();
  scip::encode_number(data_, clock_at(scan_ns), 4);
  text += data_;
  text += scip::sum_of(data_);
  text += '\n';
  data_.clear();
  for (std::int32_t step = measuring.start; step <= measuring.end; step += measuring.cluster) {
    // Of a cluster the smallest distance that is one; a code when there is none.
    const ScipSample* best = &samples_[static_cast<std::size_t>(step - plan_.model.first)];
    for (std::int32_t k = step; k < std::min(step + measuring.cluster, measuring.end + 1); ++k) {
      const ScipSample& sample = samples_[static_cast<std::size_t>(k - plan_.model.first)];
      const std::int32_t distance = sample.echoes[0].distance;
      const bool is_distance = distance >= plan_.model.distance_min;
      const std::int32_t before = best->echoes[0].distance;
      if (is_distance && (before < plan_.model.distance_min || distance < before)) best = &sample;
    }
    append_sample(measuring, *best);
  }
  append_block(text, data_);
  text += '\n';
}

Result<void> ScipDevice::fault(const DeviceFault& fault, bool starts, std::int64_t /*now_ns*/) {
  if (fault.kind == "badsum")
    bad_sums_ = starts ? fault.value("rate", 0.01) : 0.0;
  else if (fault.kind == "status")
    status_fault_ = starts ? static_cast<int>(fault.value("code", 21)) : 0;
  else if (fault.kind == "clockjump")
    clock_offset_ms_ += starts ? static_cast<std::int64_t>(fault.value("ms", -5000)) : 0;
  else
    return fail(Errc::usage, "--fault ", fault.kind,
                ": unknown; scip has badsum, status and clockjump beside those of every port");
  return success();
}

} // namespace scansion
