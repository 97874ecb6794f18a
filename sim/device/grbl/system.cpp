// Lines that begin with $: settings, listings, homing, unlocking.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/grbl/firmware.hpp"

#include <cmath>

namespace scansion::sim::grbl {
namespace {

constexpr int kBadStatement = 3, kNoHoming = 5, kNotIdle = 8, kBadNumber = 2;

} // namespace

void Firmware::system_line(std::string_view line) {
  if (line == "$") {
    say("[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]");
    return reply(0);
  }
  if (line.starts_with("$J")) {
    if (state_ != State::idle && state_ != State::jog) return reply(kNotIdle);
    if (!line.starts_with("$J=")) return reply(kBadStatement);
    return gcode_line(line.substr(3), true);
  }
  if (line == "$$") {
    if (state_ == State::cycle || state_ == State::hold) return reply(kNotIdle);
    out_ += settings_.listing();
    return reply(0);
  }
  if (line == "$G") {
    report_modes();
    return reply(0);
  }
  if (line == "$C") return toggle_check();
  if (line == "$X") return unlock();
  if (state_ != State::idle && state_ != State::alarm) return reply(kNotIdle);
  if (line == "$H") return home();
  if (line == "$#") {
    report_parameters();
    return reply(0);
  }
  if (line == "$I") {
    report_build();
    return reply(0);
  }
  if (line == "$N") {
    say("$N0=");
    say("$N1=");
    return reply(0);
  }
  if (line == "$SLP") {
    say("[MSG:Sleeping]");
    state_ = State::sleep;
    return reply(0);
  }
  if (line == "$RST=$" || line == "$RST=#" || line == "$RST=*") {
    if (line.back() != '#') settings_ = Settings();
    if (line.back() != '$') {
      systems_ = {};
      g28_ = g30_ = {};
    }
    say("[MSG:Restoring defaults]");
    reply(0);
    wants_reset_ = true;
    return;
  }
  set_or_list(line.substr(1));
}

void Firmware::set_or_list(std::string_view rest) {
  const auto number = take_number(rest);
  if (!number) return reply(kBadStatement);
  if (!rest.starts_with('=')) return reply(kBadStatement);
  rest.remove_prefix(1);
  const auto value = take_number(rest);
  if (!value) return reply(kBadNumber);
  if (!rest.empty()) return reply(kBadStatement);
  reply(settings_.set(*number, *value));
}

void Firmware::unlock() {
  if (state_ == State::alarm) {
    say("[MSG:Caution: Unlocked]");
    state_ = State::idle;
  }
  reply(0);
}

void Firmware::toggle_check() {
  if (state_ == State::check) {
    say("[MSG:Disabled]");
    reply(0);
    wants_reset_ = true;
    return;
  }
  if (state_ != State::idle) return reply(kNotIdle);
  state_ = State::check;
  say("[MSG:Enabled]");
  reply(0);
}

/// To the far end of each axis, which $23 chooses, and off the switch again; afterwards coordinates are true.
void Firmware::home() {
  if (!settings_.is_on(22)) return reply(kNoHoming);
  state_ = State::homing;
  const auto mask = static_cast<unsigned>(settings_.get(23));
  Steps target{};
  double farthest = 0.0;
  const Millimetres from = true_place(now_);
  for (std::size_t axis = 0; axis < target.size(); ++axis) {
    const bool is_low = ((mask >> axis) & 1U) != 0;
    const double travel = settings_.get(130 + static_cast<int>(axis));
    const double place = is_low ? settings_.get(27) - travel : -settings_.get(27);
    target[axis] = std::lround(place * settings_.get(100 + static_cast<int>(axis)));
    farthest = std::max(farthest, std::abs(from[axis] - place));
  }
  const double seconds = farthest / std::max(settings_.get(25) / 60.0, 1e-3) + 1.0;
  const Ns end = now_ + static_cast<Ns>(seconds * 1e9);
  wakes_at_ = end;
  when([this, end] { return now_ >= end; },
       [this, target] {
         at_ = planned_ = target;
         forgotten_ = {};
         state_ = State::idle;
         reply(0);
       });
}

} // namespace scansion::sim::grbl
