// What the simulated controller prints about itself.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/grbl/firmware.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace scansion::sim::grbl {
namespace {

constexpr double kInch = 25.4;

std::string fixed(double value, int decimals) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string_view state_name(State state) noexcept {
  switch (state) {
    case State::idle: return "Idle";
    case State::cycle: return "Run";
    case State::hold: return "Hold";
    case State::jog: return "Jog";
    case State::alarm: return "Alarm";
    case State::door: return "Door";
    case State::check: return "Check";
    case State::homing: return "Home";
    case State::sleep: return "Sleep";
  }
  return "Idle";
}

/// "G38.2" from 382, "G0" from 0.
std::string code(char letter, int tenths) {
  std::string out = letter + std::to_string(tenths / 10);
  if (tenths % 10 != 0) out += "." + std::to_string(tenths % 10);
  return out;
}

} // namespace

std::string Firmware::position_text(const Millimetres& mm) const {
  const bool inches = settings_.is_on(13);
  std::string out;
  for (std::size_t axis = 0; axis < mm.size(); ++axis) {
    if (axis > 0) out += ',';
    out += inches ? fixed(mm[axis] / kInch, 4) : fixed(mm[axis], 3);
  }
  return out;
}

Millimetres Firmware::mm(const Steps& steps) const {
  Millimetres out{};
  for (std::size_t axis = 0; axis < out.size(); ++axis) {
    out[axis] = static_cast<double>(steps[axis]) / settings_.get(100 + static_cast<int>(axis));
  }
  return out;
}

Millimetres Firmware::offset() const {
  Millimetres out = systems_[static_cast<std::size_t>(modal_.system / 10 - 54)];
  for (std::size_t axis = 0; axis < out.size(); ++axis) out[axis] += g92_[axis];
  out[2] += tool_length_;
  return out;
}

std::string Firmware::pins() const {
  return is_pin_closed(place()) ? "P" : "";
}

void Firmware::report_status() {
  constexpr std::uint32_t kIdle = 10, kBusy = 30;
  constexpr std::uint32_t kOverridesIdle = 10, kOverridesBusy = 20;
  const bool busy = state_ == State::cycle || state_ == State::hold || state_ == State::jog || state_ == State::door;
  const auto mask = static_cast<unsigned>(settings_.get(10));
  std::string out = "<" + std::string(state_name(state_));
  if (state_ == State::hold || state_ == State::door) {
    const bool stands = is_hold_complete_;
    out += stands ? ":0" : state_ == State::door ? ":2" : ":1";
  }
  Millimetres at = mm(place());
  const bool is_machine = (mask & 1U) != 0;
  if (!is_machine) {
    const Millimetres away = offset();
    for (std::size_t axis = 0; axis < at.size(); ++axis) at[axis] -= away[axis];
  }
  out += (is_machine ? "|MPos:" : "|WPos:") + position_text(at);
  if ((mask & 2U) != 0) {
    const bool hal = options_.dialect == Dialect::grblhal;
    out += "|Bf:" + std::to_string((hal ? kPlannerHal : kPlanner) - std::min(queue_.size() + (move_ ? 1U : 0U), kPlanner)) +
           "," + std::to_string((hal ? kReceiveHal - 1 : kReceive) - input_.size());
  }
  const double speed = move_ ? move_->speed(now_) * 60.0 : 0.0;
  out += "|FS:" + fixed(settings_.is_on(13) ? speed / kInch : speed, 0) + "," +
         fixed(modal_.spindle == 50 ? 0.0 : modal_.speed, 0);
  if (const std::string active = pins(); !active.empty()) out += "|Pn:" + active;
  if (reports_to_offset_ > 0) {
    --reports_to_offset_;
  } else {
    reports_to_offset_ = (busy ? kBusy : kIdle) - 1;
    if (reports_to_overrides_ == 0) reports_to_overrides_ = 1; // with the next report
    out += "|WCO:" + position_text(offset());
  }
  if (reports_to_overrides_ > 0) {
    --reports_to_overrides_;
  } else {
    reports_to_overrides_ = (busy ? kOverridesBusy : kOverridesIdle) - 1;
    out +=
        "|Ov:" + std::to_string(feed_override_) + "," + std::to_string(rapid_override_) + "," + std::to_string(speed_override_);
    if (modal_.spindle != 50 || modal_.coolant != 90) {
      out += "|A:";
      if (modal_.spindle != 50) out += modal_.spindle == 30 ? "S" : "C";
      if (modal_.coolant != 90) out += modal_.coolant == 80 ? "F" : "M";
    }
  }
  say(out + ">");
}

void Firmware::report_probe() {
  say("[PRB:" + position_text(mm(probe_at_)) + (probe_succeeded_ ? ":1]" : ":0]"));
}

void Firmware::report_modes() {
  const bool inches = modal_.units == 200;
  std::string out = "[GC:" + code('G', modal_.motion) + " " + code('G', modal_.system) + " " + code('G', modal_.plane) + " " +
                    code('G', modal_.units) + " " + code('G', modal_.distance) + " " + code('G', modal_.feed_mode) + " " +
                    code('M', modal_.spindle) + " " + code('M', modal_.coolant);
  out += " T" + fixed(modal_.tool, 0) + " F" + fixed(inches ? modal_.feed / kInch : modal_.feed, 0) + " S" +
         fixed(modal_.speed, 0);
  say(out + "]");
}

void Firmware::report_parameters() {
  for (std::size_t i = 0; i < systems_.size(); ++i) say("[G" + std::to_string(54 + i) + ":" + position_text(systems_[i]) + "]");
  say("[G28:" + position_text(g28_) + "]");
  say("[G30:" + position_text(g30_) + "]");
  say("[G92:" + position_text(g92_) + "]");
  say("[TLO:" + (settings_.is_on(13) ? fixed(tool_length_ / kInch, 4) : fixed(tool_length_, 3)) + "]");
  report_probe();
}

void Firmware::report_build() {
  if (options_.dialect == Dialect::grbl) {
    say("[VER:1.1h.20190830:]");
    say("[OPT:V,15,128]");
    return;
  }
  say("[VER:1.1f.20240101:]");
  say("[OPT:VNML+,100,1024,3,0]");
  say("[NEWOPT:ENUMS,RT+,REBOOT,TC]");
  say("[FIRMWARE:grblHAL]");
  say("[DRIVER:Simulator]");
}

void Firmware::banner() {
  say("");
  say(options_.dialect == Dialect::grbl ? "Grbl 1.1h ['$' for help]" : "GrblHAL 1.1f ['$' or '$HELP' for help]");
}

} // namespace scansion::sim::grbl
