// G-code of the simulated controller: what a line asks for, checked and carried out.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/grbl/firmware.hpp"

#include <algorithm>
#include <cmath>

namespace scansion::sim::grbl {
namespace {

constexpr double kInch = 25.4;
constexpr int kUnsupported = 20, kTwoOfAGroup = 21, kNoFeed = 22, kAxisConflict = 24, kNoAxes = 26, kValueMissing = 28,
              kBadSystem = 29, kBadG53 = 30, kAxesWithoutMode = 31, kBadTarget = 33, kBadRadius = 34, kBadJog = 16,
              kJogBeyondTravel = 15;
constexpr int kNoMotion = 800;
constexpr std::string_view kAxisLetters = "XYZ";

bool is_probe(int motion) noexcept {
  return motion >= 382 && motion <= 385;
}

} // namespace

int Firmware::read_g(int code, Plan& plan) {
  Modal& modal = plan.modal;
  switch (code) {
    case 0:
    case 10:
    case 20:
    case 30:
    case 382:
    case 383:
    case 384:
    case 385:
    case kNoMotion:
      if (plan.has_motion) return kTwoOfAGroup;
      plan.has_motion = true;
      modal.motion = code;
      return 0;
    case 40:
    case 100:
    case 280:
    case 281:
    case 300:
    case 301:
    case 431:
    case 490:
    case 920:
    case 921:
      if (plan.other >= 0) return kTwoOfAGroup;
      plan.other = code;
      return 0;
    case 530: plan.is_machine = true; return 0;
    case 170:
    case 180:
    case 190: modal.plane = code; return 0;
    case 200:
    case 210: modal.units = code; return 0;
    case 900:
    case 910: modal.distance = code; return 0;
    case 930:
    case 940: modal.feed_mode = code; return 0;
    case 540:
    case 550:
    case 560:
    case 570:
    case 580:
    case 590: modal.system = code; return 0;
    case 400:
    case 610:
    case 911: return 0;
    default: return kUnsupported;
  }
}

int Firmware::read_m(int code, Plan& plan) {
  switch (code) {
    case 0:
    case 10:
    case 20:
    case 300: plan.flow = code; return 0;
    case 30:
    case 40:
    case 50: plan.modal.spindle = code; return 0;
    case 70:
    case 80:
    case 90: plan.modal.coolant = code; return 0;
    default: return kUnsupported;
  }
}

int Firmware::check(Plan& plan, bool is_jog) const {
  const Block& block = plan.block;
  for (const int code : block.g) {
    if (is_jog && code != 530 && code != 200 && code != 210 && code != 900 && code != 910) return kBadJog;
    if (const int error = read_g(code, plan); error != 0) return error;
  }
  for (const int code : block.m) {
    if (is_jog) return kBadJog;
    if (const int error = read_m(code, plan); error != 0) return error;
  }
  const double unit = plan.modal.units == 200 ? kInch : 1.0;
  if (const auto f = block.get('F')) plan.modal.feed = *f * unit;
  if (const auto s = block.get('S')) plan.modal.speed = *s;
  if (const auto t = block.get('T')) plan.modal.tool = *t;
  if (plan.other == 40 && !block.get('P')) return kValueMissing;
  if (plan.other == 100 && (!block.get('P') || !block.get('L'))) return kValueMissing;
  if (plan.other == 100 && *block.get('P') > 6.0) return kBadSystem;

  const Millimetres from = mm(planned_);
  Millimetres away{};
  {
    // Work offsets of the system that is in force after this line.
    away = systems_[static_cast<std::size_t>(plan.modal.system / 10 - 54)];
    for (std::size_t axis = 0; axis < away.size(); ++axis) away[axis] += g92_[axis];
    away[2] += tool_length_;
  }
  for (std::size_t axis = 0; axis < from.size(); ++axis) {
    const auto word = block.get(kAxisLetters[axis]);
    plan.axes[axis] = word.has_value();
    plan.has_axes |= word.has_value();
    plan.target[axis] = from[axis];
    if (!word) continue;
    const double value = *word * unit;
    plan.target[axis] = plan.is_machine ? value : plan.modal.distance == 910 ? from[axis] + value : value + away[axis];
  }
  if (is_jog) return !plan.has_axes || !block.get('F') ? kBadJog : 0;
  const bool takes_axes = plan.other >= 0 && plan.other != 40 && plan.other != 490 && plan.other != 921;
  if (takes_axes && plan.has_motion && plan.has_axes) return kAxisConflict;
  if (takes_axes) return 0;
  const int motion = plan.modal.motion;
  if (plan.is_machine && motion > 10) return kBadG53;
  if (motion == kNoMotion) return plan.has_axes ? kAxesWithoutMode : 0;
  if ((!plan.has_axes && !plan.has_motion) || motion == 0) return 0;
  if (plan.modal.feed <= 0.0) return kNoFeed;
  if (motion == 10) return 0;
  if (!plan.has_axes) return kNoAxes;
  if (is_probe(motion) && steps(plan.target) == planned_) return kBadTarget;
  return 0;
}

void Firmware::gcode_line(std::string_view line, bool is_jog) {
  Plan plan;
  plan.modal = modal_;
  plan.block = parse_block(line);
  const int error = plan.block.error != 0 ? plan.block.error : check(plan, is_jog);
  if (error != 0) return reply(error);
  if (is_jog) return jog(plan);
  if (plan.modal.system != modal_.system) reports_to_offset_ = 0;
  if (plan.modal.spindle != modal_.spindle || plan.modal.coolant != modal_.coolant) reports_to_overrides_ = 0;
  modal_ = plan.modal;
  carry_out(plan);
}

void Firmware::carry_out(const Plan& plan) {
  if (plan.other >= 0 && plan.other != 490 && plan.other != 921) return carry_out_other(plan);
  if (plan.other == 490) tool_length_ = 0.0;
  if (plan.other == 921) g92_ = {};
  if (plan.other >= 0) reports_to_offset_ = 0;
  const bool moves = plan.has_axes && modal_.motion != kNoMotion;
  const auto then = [this, plan] { end_program(plan); };
  if (state_ == State::check || !moves) return then();
  if (is_probe(modal_.motion)) return start_probe(plan);
  if (modal_.motion == 20 || modal_.motion == 30) return arc(plan);
  double feed = modal_.feed;
  if (modal_.feed_mode == 930 && modal_.motion == 10) {
    // G93: F is moves a minute.
    const Millimetres from = mm(planned_);
    feed *= std::hypot(plan.target[0] - from[0], plan.target[1] - from[1], plan.target[2] - from[2]);
  }
  move_to(plan.target, feed, modal_.motion == 0, then);
}

void Firmware::carry_out_other(const Plan& plan) {
  const Block& block = plan.block;
  const auto done = [this, plan] { end_program(plan); };
  if (plan.other == 40) {
    const double seconds = *block.get('P');
    if (state_ == State::check) return done();
    return when([this] { return has_stopped(); },
                [this, seconds, done] {
                  const Ns end = now_ + static_cast<Ns>(seconds * 1e9);
                  wakes_at_ = end;
                  when([this, end] { return now_ >= end; }, done);
                });
  }
  reports_to_offset_ = 0;
  if (plan.other == 100) {
    const auto number = static_cast<std::size_t>(*block.get('P'));
    Millimetres& system = systems_[number == 0 ? static_cast<std::size_t>(modal_.system / 10 - 54) : number - 1];
    const double unit = modal_.units == 200 ? kInch : 1.0;
    const Millimetres at = mm(planned_);
    for (std::size_t axis = 0; axis < at.size(); ++axis) {
      if (!plan.axes[axis]) continue;
      const double value = *block.get(kAxisLetters[axis]) * unit;
      const double here = at[axis] - g92_[axis] - (axis == 2 ? tool_length_ : 0.0) - value;
      system[axis] = *block.get('L') == 20.0 ? here : value;
    }
    return done();
  }
  if (plan.other == 920) {
    const Millimetres at = mm(planned_);
    for (std::size_t axis = 0; axis < at.size(); ++axis) {
      // The word was read as a target: what is left of it without the offset is the value.
      if (plan.axes[axis]) g92_[axis] += at[axis] - plan.target[axis];
    }
    return done();
  }
  if (plan.other == 431) {
    const double unit = modal_.units == 200 ? kInch : 1.0;
    if (plan.axes[2]) tool_length_ = *block.get('Z') * unit;
    return done();
  }
  if (plan.other == 281 || plan.other == 301) {
    (plan.other == 281 ? g28_ : g30_) = mm(planned_);
    return done();
  }
  const Millimetres home = plan.other == 280 ? g28_ : g30_;
  move_to(plan.target, 0.0, true, [this, home, done] { move_to(home, 0.0, true, done); });
}

void Firmware::end_program(const Plan& plan) {
  if (plan.flow == 20 || plan.flow == 300) {
    when([this] { return has_stopped() || state_ == State::check; },
         [this] {
           const Modal before = modal_;
           modal_ = {};
           modal_.units = before.units;
           modal_.feed = before.feed;
           say("[MSG:Pgm End]");
           reply(0);
         });
  } else if (plan.flow == 0 && state_ != State::check) {
    when([this] { return has_stopped(); },
         [this] {
           do_hold(false);
           when([this] { return state_ == State::idle; }, [this] { reply(0); });
         });
  } else {
    reply(0);
  }
}

Steps Firmware::steps(const Millimetres& mm) const {
  Steps out{};
  for (std::size_t axis = 0; axis < out.size(); ++axis)
    out[axis] = std::llround(mm[axis] * settings_.get(100 + static_cast<int>(axis)));
  return out;
}

Move Firmware::make_move(const Steps& from, const Steps& to, double feed, bool is_rapid) const {
  const Millimetres a = mm(from), b = mm(to);
  const Millimetres way{b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const double length = std::hypot(way[0], way[1], way[2]);
  double speed = is_rapid ? 1e9 : feed / 60.0;
  double acceleration = 1e9;
  for (std::size_t axis = 0; axis < way.size(); ++axis) {
    const double share = length > 0.0 ? std::abs(way[axis]) / length : 0.0;
    if (share <= 0.0) continue;
    speed = std::min(speed, settings_.get(110 + static_cast<int>(axis)) / 60.0 / share);
    acceleration = std::min(acceleration, settings_.get(120 + static_cast<int>(axis)) / share);
  }
  constexpr double kSlowest = 1e-3;
  return {from, to, length, std::max(speed, kSlowest), std::max(acceleration, kSlowest)};
}

bool Firmware::is_beyond_travel(const Steps& target) const {
  if (!settings_.is_on(20)) return false;
  const Millimetres at = mm(target);
  for (std::size_t axis = 0; axis < at.size(); ++axis) {
    if (at[axis] > 0.0 || at[axis] < -settings_.get(130 + static_cast<int>(axis))) return true;
  }
  return false;
}

/// Nothing more is heard but a reset, after which the line is answered.
void Firmware::refuse_target() {
  when([this] { return move_ == std::nullopt; },
       [this] {
         queue_.clear();
         planned_ = at_;
         alarm(2);
         when([] { return false; }, [] {});
       });
}

void Firmware::move_to(const Millimetres& target, double feed, bool is_rapid, std::function<void()> then) {
  const Steps to = steps(target);
  if (is_beyond_travel(to)) return refuse_target();
  const std::size_t room = options_.dialect == Dialect::grbl ? kPlanner : kPlannerHal;
  when([this, room] { return queue_.size() + (move_ ? 1U : 0U) < room; },
       [this, to, feed, is_rapid, then = std::move(then)] {
         if (to != planned_) {
           queue_.push_back(make_move(planned_, to, feed, is_rapid));
           planned_ = to;
           start_next();
         }
         then();
       });
}

/// Chords that leave the circle by less than 2 um.
void Firmware::arc(const Plan& plan) {
  constexpr std::array<std::array<std::size_t, 3>, 3> kPlanes{{{0, 1, 2}, {2, 0, 1}, {1, 2, 0}}};
  const auto [u, v, w] = kPlanes[static_cast<std::size_t>(modal_.plane / 10 - 17)];
  const double unit = modal_.units == 200 ? kInch : 1.0;
  const bool clockwise = modal_.motion == 20;
  const Millimetres from = mm(planned_);
  const double du = plan.target[u] - from[u], dv = plan.target[v] - from[v];
  double cu = 0.0, cv = 0.0; // centre, seen from the start
  if (const auto r = plan.block.get('R')) {
    const double chord = std::hypot(du, dv), radius = *r * unit;
    const double rest = 4.0 * radius * radius - chord * chord;
    if (chord <= 0.0 || rest < 0.0) return reply(kBadRadius);
    const double side = (clockwise ? -1.0 : 1.0) * (radius < 0.0 ? -1.0 : 1.0) * std::sqrt(rest) / chord / 2.0;
    cu = du / 2.0 - dv * side;
    cv = dv / 2.0 + du * side;
  } else {
    constexpr std::string_view kCentre = "IJK";
    if (!plan.block.get(kCentre[u]) && !plan.block.get(kCentre[v])) return reply(35);
    cu = plan.block.get(kCentre[u]).value_or(0.0) * unit;
    cv = plan.block.get(kCentre[v]).value_or(0.0) * unit;
  }
  const double radius = std::hypot(cu, cv);
  if (std::abs(std::hypot(du - cu, dv - cv) - radius) > 0.005 + radius * 0.001) return reply(kBadTarget);
  double turn = std::atan2(-cu * (dv - cv) + cv * (du - cu), -cu * (du - cu) - cv * (dv - cv));
  constexpr double kFull = 6.283185307179586;
  if (clockwise && turn >= -1e-7) turn -= kFull;
  if (!clockwise && turn <= 1e-7) turn += kFull;
  constexpr double kDeviation = 0.002, kMostChords = 1000.0;
  const double chord = 2.0 * std::sqrt(std::max(2.0 * radius * kDeviation, 1e-9));
  const auto count = static_cast<int>(std::clamp(std::ceil(std::abs(turn) * radius / chord), 1.0, kMostChords));
  for (int i = 1; i <= count; ++i) {
    const double part = static_cast<double>(i) / count, angle = turn * part;
    Millimetres at = plan.target;
    if (i < count) {
      at[u] = from[u] + cu - cu * std::cos(angle) + cv * std::sin(angle);
      at[v] = from[v] + cv - cu * std::sin(angle) - cv * std::cos(angle);
      at[w] = from[w] + (plan.target[w] - from[w]) * part;
    }
    const Steps to = steps(at);
    if (is_beyond_travel(to)) return refuse_target();
    if (to != planned_) queue_.push_back(make_move(planned_, to, modal_.feed, false));
    planned_ = to;
  }
  start_next();
  const std::size_t room = options_.dialect == Dialect::grbl ? kPlanner : kPlannerHal;
  when([this, room] { return queue_.size() < room; }, [this, plan] { end_program(plan); });
}

void Firmware::jog(const Plan& plan) {
  const Steps to = steps(plan.target);
  if (is_beyond_travel(to)) return reply(kJogBeyondTravel);
  const std::size_t room = options_.dialect == Dialect::grbl ? kPlanner : kPlannerHal;
  const double feed = plan.modal.feed;
  when([this, room] { return queue_.size() + (move_ ? 1U : 0U) < room; },
       [this, to, feed] {
         if (to != planned_) {
           queue_.push_back(make_move(planned_, to, feed, false));
           planned_ = to;
           if (state_ == State::idle) state_ = State::jog;
           start_next();
         }
         reply(0);
       });
}

void Firmware::start_probe(const Plan& plan) {
  probe_away_ = modal_.motion >= 384;
  probe_errs_ = modal_.motion == 382 || modal_.motion == 384;
  const Steps to = steps(plan.target);
  const double feed = modal_.feed;
  when([this] { return has_stopped(); },
       [this, to, feed] {
         probe_succeeded_ = false;
         if (is_pin_closed(place()) != probe_away_) {
           alarm(4);
           return when([] { return true; }, [this] { reply(0); });
         }
         if (is_beyond_travel(to)) return refuse_target();
         probing_ = Probing::armed;
         queue_.push_back(make_move(planned_, to, feed, false));
         planned_ = to;
         start_next();
         when([this] { return has_stopped(); }, [this] { end_probe(); });
       });
}

void Firmware::end_probe() {
  const bool met = probing_ == Probing::met;
  probing_ = Probing::off;
  planned_ = at_;
  probe_succeeded_ = met;
  // After an alarm Grbl shows the contact before this one, grblHAL the end of this cycle.
  if (!met && (!probe_errs_ || options_.dialect == Dialect::grblhal)) probe_at_ = at_;
  if (!met && probe_errs_) alarm(5);
  when([] { return true; },
       [this] {
         report_probe();
         reply(0);
       });
}

} // namespace scansion::sim::grbl
