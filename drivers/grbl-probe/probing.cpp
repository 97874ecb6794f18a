// The raster itself: lift, traverse, probe, judge, point after point.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/grbl-probe/codes.hpp"
#include "drivers/grbl-probe/gcode.hpp"
#include "drivers/grbl-probe/session.hpp"

#include <cmath>

namespace scansion::grbl {
namespace {

constexpr Ns kMs = 1'000'000;
constexpr Ns kStandstill = 5000 * kMs; ///< a reply that is due, and no report changes: it was lost

} // namespace

void Session::begin_raster(Ns now) {
  phase_ = Phase::probing;
  z_ = to_um((*position_)[2]);
  ceiling_ = std::max(z_, raster_.top());
  current_.index = row_;
  if (status_.probe_closed) {
    // It was left in the middle of a probe cycle, with the tip on the part.
    z_ = raster_.bottom();
    send(Step::unlocked_lift, lift_line(raster_.top()), now);
  } else if (row_ == raster_.rows()) {
    end_raster(now);
  } else {
    begin_point(true, now);
  }
}

void Session::run_probing(Ns now) {
  if (is_waiting_ && !reply_ && !is_machine_held() && now - last_change_ > kStandstill) {
    resync("a reply did not come", now);
    return;
  }
  if (step_ == Step::quiet) return wait_for_quiet(now);
  if (step_ == Step::quiet_settle) return settle_after_flush(now);
  if (step_ == Step::unlocked_look) return look_at_pin(now);
  const auto reply = take_reply();
  if (!reply) return;
  const int error = *reply;
  if (step_ == Step::quiet_flush) return go(Step::quiet_settle, now); // an error ends a broken line as well as an ok
  if (error != 0) return refuse_reply(error, now);
  switch (step_) {
    case Step::lift: send(Step::traverse, traverse_line(raster_.x(column_), raster_.y(row_)), now); break;
    case Step::traverse: probe_here(now); break;
    case Step::probe: judge_probe(now); break;
    case Step::end_lift: send(Step::end_fence, kFence, now); break;
    case Step::end_fence: phase_ = Phase::finished; break;
    default: run_recovery(now); break;
  }
}

void Session::begin_point(bool from_top, Ns now) {
  column_ = raster_.column(row_, step_in_row_);
  const Um safe = from_top ? raster_.top() : heights_.safe_height(row_, last_column_, column_);
  if (z_ < safe) {
    z_ = safe;
    send(Step::lift, lift_line(safe), now);
  } else {
    send(Step::traverse, traverse_line(raster_.x(column_), raster_.y(row_)), now);
  }
}

void Session::probe_here(Ns now) {
  has_probed_ = true;
  send(Step::probe, probe_line(raster_.bottom() - to_um((*offset_)[2]), feed_), now);
}

/// The reply says only that the cycle is over. A contact is one report of it between sending and reply, in the place the tip
/// was sent to, with no alarm and no hold in between.
void Session::judge_probe(Ns now) {
  if (alarm_ != 0) {
    z_ = raster_.bottom();
    misses_alarm_ = alarm_ == 5;
    send(Step::unlock, "$X", now);
  } else if (is_disturbed_) {
    ++counts_.disturbed;
    ++counts_.repeats;
    z_ = raster_.bottom();
    begin_point(true, now);
  } else if (probes_seen_ == 0) {
    resync("a probe cycle was answered without saying where it ended", now);
  } else if (probes_seen_ > 1) {
    resync("a probe cycle was answered by more than one position", now);
  } else if (!probe_.contact) {
    take_miss(now);
  } else if (const std::string why = why_not_here(); !why.empty()) {
    resync(why, now);
  } else {
    take_contact(now);
  }
}

Um Session::tolerance(std::size_t axis) const noexcept {
  constexpr double kUmPerMm = 1000.0;
  constexpr Um kUntold = 50;
  const double steps = machine_.steps[axis];
  return steps > 0.0 ? std::llround(1.5 * kUmPerMm / steps) + 3 : kUntold;
}

bool Session::is_at(const Position& at, std::uint32_t row, std::uint32_t column) const noexcept {
  return std::abs(to_um(at[0]) - raster_.x(column)) <= tolerance(0) && std::abs(to_um(at[1]) - raster_.y(row)) <= tolerance(1);
}

std::string Session::why_not_here() const {
  if (!is_at(probe_.at, row_, column_)) return "a contact was reported at another place";
  const Um z = to_um(probe_.at[2]);
  if (z > ceiling_ + tolerance(2) || z < raster_.bottom() - tolerance(2))
    return "a contact was reported at an impossible height";
  return {};
}

void Session::take_contact(Ns now) {
  z_ = to_um(probe_.at[2]);
  if (z_ >= raster_.top()) {
    fail_with(Errc::attention, "the tip met something at or above top, at " + place() +
                                   ": no height is safe; lift it by hand, and look at top and at what lies in the area");
    return;
  }
  current_.points[column_] = probe_.at;
  heights_.put(row_, column_, z_);
  misses_together_ = 0;
  has_touched_ = true;
  next_point(false, now);
}

void Session::take_miss(Ns now) {
  ++counts_.misses;
  z_ = std::min(z_, raster_.bottom());
  current_.points[column_].reset();
  if (++misses_together_ > options_.max_misses) {
    fail_with(Errc::attention, std::to_string(misses_together_) + " points together met nothing, the last at " + place() +
                                   ": is the probe connected, and the part in the area? (max_misses)");
    return;
  }
  next_point(true, now);
}

void Session::next_point(bool from_top, Ns now) {
  point_tries_ = 0;
  last_column_ = column_;
  if (++step_in_row_ == raster_.columns()) {
    rows_.push_back(current_);
    step_in_row_ = 0;
    current_.index = ++row_;
    for (auto& point : current_.points) point.reset();
  }
  if (row_ == raster_.rows())
    end_raster(now);
  else
    begin_point(from_top, now);
}

void Session::end_raster(Ns now) {
  if (z_ < raster_.top())
    send(Step::end_lift, lift_line(raster_.top()), now);
  else
    send(Step::end_fence, kFence, now);
}

void Session::refuse_reply(int error, Ns now) {
  constexpr int kLocked = 9;
  const std::string what = "a command was answered by " + describe_error(error);
  if (error == kLocked || step_ == Step::unlock) {
    is_locked_ = true;
    fail_with(Errc::attention, what + " at " + place() + "; the machine is not unlocked from here");
  } else {
    resync(what, now);
  }
}

std::string Session::place() const {
  return "row " + std::to_string(row_) + ", column " + std::to_string(column_);
}

} // namespace scansion::grbl
