// Back to a known state: after a probe cycle that could not begin, and after replies that do not fit.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/grbl-probe/gcode.hpp"
#include "drivers/grbl-probe/session.hpp"

#include <utility>

namespace scansion::grbl {
namespace {

constexpr Ns kMs = 1'000'000;
constexpr Ns kQuiet = 300 * kMs;  ///< without a line that is no status report: whatever was under way has been said
constexpr Ns kSettle = 200 * kMs; ///< in which a surplus reply to the empty line would come
constexpr Ns kStandstill = 30'000 * kMs;
constexpr std::uint32_t kMostTries = 3;

} // namespace

void Session::run_recovery(Ns now) {
  switch (step_) {
    case Step::unlock: send(Step::unlocked_lift, lift_line(raster_.top()), now); break;
    case Step::unlocked_lift: send(Step::unlocked_fence, kFence, now); break;
    case Step::unlocked_fence:
      z_ = raster_.top();
      go(Step::unlocked_look, now);
      break;
    default: break;
  }
}

void Session::look_at_pin(Ns now) {
  if (!is_status_fresh_) return;
  if (status_.probe_closed) {
    fail_with(Errc::attention,
              "the probe stays closed (Pn:P) though the tip was lifted, at " + place() + ": is it stuck, or its wire broken?");
  } else if (std::exchange(misses_alarm_, false)) {
    take_miss(now);
  } else if (row_ == raster_.rows()) {
    end_raster(now);
  } else if (++point_tries_ > kMostTries) {
    fail_with(Errc::attention, "the probe is closed whenever probing begins at " + place() +
                                   ", and open at the top: is something in "
                                   "the way of the tip?");
  } else {
    ++counts_.repeats;
    begin_point(true, now);
  }
}

void Session::resync(std::string_view why, Ns now) {
  ++counts_.resyncs;
  is_waiting_ = false;
  reply_.reset();
  if (++point_tries_ > kMostTries) {
    fail_with(Errc::unavailable, std::string(why) + ", again and again, at " + place());
    return;
  }
  go(Step::quiet, now);
}

void Session::wait_for_quiet(Ns now) {
  if (is_machine_held()) return;
  if (is_status_fresh_ && status_.state == MachineState::idle && now - std::max(last_talk_, begun_) >= kQuiet) {
    strays_before_ = counts_.strays;
    send(Step::quiet_flush, "", now);
  } else if (now - std::max(last_change_, begun_) > kStandstill) {
    fail_with(Errc::unavailable, "the controller does not come to rest after a reply that does not fit");
  }
}

void Session::settle_after_flush(Ns now) {
  if (now - begun_ < kSettle) return;
  if (counts_.strays != strays_before_) {
    if (++settles_ > kMostTries) {
      fail_with(Errc::unavailable, "answers come that nobody here asked for: does a second program use the controller?");
      return;
    }
    go(Step::quiet, now);
    return;
  }
  settles_ = 0;
  ++counts_.repeats;
  z_ = raster_.bottom();
  if (row_ == raster_.rows())
    end_raster(now);
  else
    begin_point(true, now);
}

} // namespace scansion::grbl
