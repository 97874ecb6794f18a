// Transport + decoder + handshake = driver.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/port/port_driver.hpp"

#include <algorithm>

namespace scansion {
namespace {

constexpr std::int64_t kSendNs = 1'000'000'000;

} // namespace

Result<void> PortDriver::open() {
  decoder().reset();
  begin_ = end_ = 0;
  at_end_ = is_held_ = is_finished_ = false;
  lost_.reset();
  SCANSION_TRY(transport_->open());
  is_open_ = true;
  return success();
}

Result<DeviceFacts> PortDriver::start() {
  SCANSION_TRY(facts, handshake());
  facts.live = transport_->is_live();
  return facts;
}

void PortDriver::close() noexcept {
  if (std::exchange(is_open_, false)) {
    closing();
    farewell();
  }
  transport_->close();
  if (std::exchange(line_at_, std::nullopt)) was_away_ = true;
}

Result<void> PortDriver::fill(std::int64_t deadline_ns) {
  SCANSION_TRY(arrival, transport_->read(read_, deadline_ns));
  begin_ = 0;
  end_ = arrival.count;
  at_end_ = arrival.end;
  if (arrival.count == 0) return success();
  arrived_ = arrival.at;
  counters_->bytes_in.fetch_add(arrival.count, std::memory_order_relaxed);
  return success();
}

Decoder::Step PortDriver::decode(LineBuffer& line, Gap& gap) {
  const Decoder::Step step = decoder().decode(std::span(read_).subspan(begin_, end_ - begin_), arrived_, line, gap);
  begin_ += step.used;
  return step;
}

Result<void> PortDriver::send(std::string_view text) {
  SCANSION_TRY(transport_->write(text, now().monotonic_ns + kSendNs));
  counters_->bytes_out.fetch_add(text.size(), std::memory_order_relaxed);
  return success();
}

Result<bool> PortDriver::await_reply(std::int64_t deadline_ns) {
  for (;;) {
    const Decoder::Step step = decode(passed_line_, passed_gap_);
    if (step.what == Decoded::reply) return true;
    if (step.what != Decoded::more) {
      passed_line_.clear();
      continue;
    }
    if (at_end_) return fail(Errc::unavailable, port_name(), ": ended before the device had started");
    if (now().monotonic_ns >= deadline_ns) return false;
    SCANSION_TRY(fill(deadline_ns));
  }
}

Delivery PortDriver::deliver(LineBuffer& line, Gap& gap) {
  if (!line.stamps.host_monotonic_ns) line.stamps.host_monotonic_ns = arrived_.monotonic_ns;
  if (!line.stamps.host_realtime_ns) line.stamps.host_realtime_ns = arrived_.realtime_ns;
  const bool is_first = !line_at_;
  line_at_ = arrived_;
  if (!is_first || !std::exchange(was_away_, false)) return Delivery::line;
  const auto lost = decoder().lost_while_away();
  if (lost == std::optional<std::uint64_t>(0)) return Delivery::line;
  gap.count = lost;
  gap.reason = "the device was away";
  std::swap(held_, line);
  is_held_ = true;
  return Delivery::gap;
}

Result<Delivery> PortDriver::next(LineBuffer& line, Gap& gap) {
  if (std::exchange(is_held_, false)) {
    std::swap(held_, line);
    held_.clear();
    return Delivery::line;
  }
  const std::int64_t patience = now().monotonic_ns + kPatienceNs;
  for (;;) {
    const Decoder::Step step = decode(line, gap);
    switch (step.what) {
      case Decoded::line: return deliver(line, gap);
      case Decoded::gap: return Delivery::gap;
      case Decoded::end: return Delivery::end;
      case Decoded::reply: {
        SCANSION_TRY(on_reply(arrived_));
        continue;
      }
      case Decoded::more: break;
    }
    if ((at_end_ || lost_) && !std::exchange(is_finished_, true)) {
      decoder().finish(now(), lost_.has_value());
      continue;
    }
    if (lost_) return *lost_;
    if (at_end_) return Delivery::end;
    const Moment moment = now();
    SCANSION_TRY(wake_at, attend(moment));
    if (moment.monotonic_ns >= patience) return Delivery::nothing;
    if (auto filled = fill(std::min(patience, wake_at)); !filled) lost_ = filled.assume_error();
  }
}

} // namespace scansion
