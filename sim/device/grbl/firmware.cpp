// A Grbl controller: its bytes, its real-time commands and what happens by itself.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/grbl/firmware.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace scansion::sim::grbl {
namespace {

constexpr std::uint8_t kReset = 0x18, kDoor = 0x84, kJogCancel = 0x85, kFirstHigh = 0x80;

/// Feed, rapid and spindle overrides: real-time bytes that change a percentage.
bool take_override(std::uint8_t byte, int& feed, int& rapid, int& speed) noexcept {
  constexpr int kFull = 100;
  constexpr std::array<int, 5> kSteps{0, 10, -10, 1, -1};
  const auto change = [](int& value, int by) { value = by == 0 ? kFull : std::clamp(value + by, 10, 200); };
  if (byte >= 0x90 && byte <= 0x94)
    change(feed, kSteps[byte - 0x90U]);
  else if (byte >= 0x95 && byte <= 0x97)
    rapid = byte == 0x95 ? kFull : byte == 0x96 ? kFull / 2 : kFull / 4;
  else if (byte >= 0x99 && byte <= 0x9D)
    change(speed, kSteps[byte - 0x99U]);
  else
    return false;
  return true;
}

} // namespace

Firmware::Firmware(FirmwareOptions options, Settings settings) : options_(std::move(options)), settings_(std::move(settings)) {}

void Firmware::power_on(Ns now) {
  now_ = std::max(now_, now);
  if (is_powered_) {
    const Steps at = place();
    for (std::size_t axis = 0; axis < at.size(); ++axis) forgotten_[axis] += at[axis];
  }
  is_powered_ = true;
  at_ = {};
  g92_ = {};
  state_ = settings_.is_on(22) ? State::alarm : State::idle;
  input_.clear();
  start(true);
}

void Firmware::receive(std::span<const std::uint8_t> bytes, Ns now) {
  run_until(now);
  for (const std::uint8_t byte : bytes) {
    switch (byte) {
      case '?': wants_status_ = true; break;
      case '!': wants_hold_ = true; break;
      case '~': wants_resume_ = true; break;
      case kReset: wants_reset_ = true; break;
      case kDoor: wants_door_ = true; break;
      case kJogCancel: wants_jog_cancel_ = true; break;
      default: {
        if (byte >= kFirstHigh) {
          if (take_override(byte, feed_override_, rapid_override_, speed_override_)) reports_to_overrides_ = 0;
          break;
        }
        const std::size_t room = options_.dialect == Dialect::grbl ? kReceive : kReceiveHal - 1;
        if (input_.size() < room)
          input_.push_back(static_cast<char>(byte));
        else
          ++lost_bytes_;
      }
    }
  }
  // No work here: while the controller reads one byte, the next ones are already in its buffer.
  run_until(now);
}

void Firmware::run_until(Ns now) {
  for (;;) {
    while (step()) {
    }
    const Ns next = next_thing();
    if (next > now) break;
    now_ = std::max(now_, next);
  }
  now_ = std::max(now_, now);
}

Ns Firmware::next_event() const {
  return next_thing();
}

Ns Firmware::next_thing() const {
  if (now_ < paused_until_) return paused_until_;
  Ns next = wakes_at_;
  if (is_moving()) next = std::min({next, move_->stands_at(), contact_time()});
  return next;
}

/// True: something happened at now_, look again.
bool Firmware::step() {
  if (now_ < paused_until_) return false;
  if (std::exchange(owes_critical_message_, false)) say("[MSG:Reset to continue]");
  const bool is_addressed = wants_status_ || wants_hold_ || wants_resume_ || wants_door_ || wants_jog_cancel_;
  // While it homes only a reset is heard; the rest waits for its end.
  if (wants_reset_ || (is_addressed && state_ != State::homing)) {
    take_realtime();
    if (is_critical_) return false;
    return true;
  }
  if (is_critical_) return false;
  if (is_moving() && now_ >= contact_time()) {
    on_contact();
    return true;
  }
  if (is_moving() && now_ >= move_->stands_at()) {
    on_move_end();
    return true;
  }
  if (wakes_at_ <= now_) wakes_at_ = kNever;
  if (ready_) {
    if (!ready_()) return false;
    ready_ = nullptr;
    const auto then = std::exchange(then_, nullptr);
    then();
    return true;
  }
  if (input_.empty()) return false;
  take_input();
  return true;
}

void Firmware::when(std::function<bool()> ready, std::function<void()> then) {
  ready_ = std::move(ready);
  then_ = std::move(then);
}

void Firmware::take_realtime() {
  if (is_critical_) {
    // Only a reset is heard; everything else is forgotten.
    wants_status_ = wants_hold_ = wants_resume_ = wants_door_ = wants_jog_cancel_ = false;
    if (!wants_reset_) return;
    is_critical_ = false;
  }
  if (std::exchange(wants_reset_, false)) return do_reset();
  if (std::exchange(wants_status_, false)) report_status();
  if (std::exchange(wants_door_, false)) do_hold(true);
  if (std::exchange(wants_hold_, false)) do_hold(false);
  if (std::exchange(wants_jog_cancel_, false) && state_ == State::jog) {
    queue_.clear();
    brake();
  }
  if (std::exchange(wants_resume_, false)) do_resume();
}

void Firmware::do_reset() {
  const bool was_moving =
      state_ == State::cycle || state_ == State::jog || has_hold_flag_ || (state_ == State::hold && !is_hold_complete_);
  const bool was_homing = state_ == State::homing;
  at_ = place();
  move_.reset();
  queue_.clear();
  if (was_homing || was_moving) {
    say("ALARM:" + std::to_string(was_homing ? 6 : 3));
    state_ = State::alarm;
    paused_until_ = now_ + options_.alarm_pause;
  }
  // The line that was being carried out ends like any other; grblHAL forgets it.
  const bool is_answered = ready_ != nullptr && options_.dialect == Dialect::grbl;
  then_ = [this, is_answered] {
    if (is_answered) reply(0);
    start(false);
  };
  ready_ = [] { return true; };
  input_.clear();
}

void Firmware::start(bool after_power) {
  line_.clear();
  line_too_long_ = in_comment_ = after_semicolon_ = false;
  wants_status_ = wants_hold_ = wants_resume_ = wants_reset_ = wants_door_ = wants_jog_cancel_ = false;
  is_hold_complete_ = has_hold_flag_ = is_critical_ = owes_critical_message_ = false;
  wakes_at_ = kNever;
  ready_ = nullptr;
  then_ = nullptr;
  move_.reset();
  queue_.clear();
  planned_ = at_;
  probing_ = Probing::off;
  contact_step_ = -1;
  probe_at_ = {};
  probe_succeeded_ = false;
  modal_ = {};
  tool_length_ = 0.0;
  reports_to_offset_ = reports_to_overrides_ = 0;
  feed_override_ = rapid_override_ = speed_override_ = 100;
  if (after_power) paused_until_ = now_;
  banner();
  if (state_ == State::alarm || state_ == State::sleep) {
    say("[MSG:'$H'|'$X' to unlock]");
    state_ = State::alarm;
  } else {
    state_ = State::idle;
  }
}

void Firmware::do_hold(bool by_door) {
  if (by_door) say("[MSG:Check Door]");
  if (state_ == State::alarm || state_ == State::check || state_ == State::sleep) return;
  if (state_ == State::jog) {
    queue_.clear();
    brake();
    if (!by_door) return;
  }
  if (state_ == State::cycle || state_ == State::jog) {
    is_hold_complete_ = false;
    brake();
  } else if (state_ == State::idle) {
    is_hold_complete_ = true;
  }
  if (by_door)
    state_ = State::door;
  else if (state_ != State::door)
    state_ = State::hold;
}

void Firmware::brake() {
  if (move_) move_->brake(now_, options_.reaction);
}

void Firmware::do_resume() {
  if (state_ == State::idle) return start_next();
  if ((state_ != State::hold && state_ != State::door) || !is_hold_complete_) return;
  is_hold_complete_ = false;
  state_ = State::idle;
  if (!move_) return start_next();
  state_ = State::cycle;
  if (probing_ == Probing::met) return finish_move();
  find_contact(move_->steps_done(now_)); // a pin that closed meanwhile is met here
  move_->run(now_);
}

Ns Firmware::contact_time() const {
  if (!is_moving() || probing_ != Probing::armed || contact_step_ < 0) return kNever;
  return std::max(now_, move_->time_of(contact_step_));
}

/// Looks ahead from step `first` of the move, as the step interrupt would meet it.
void Firmware::find_contact(std::int64_t first) {
  contact_step_ = -1;
  if (!move_ || probing_ != Probing::armed) return;
  for (std::int64_t step = first; step <= move_->steps() && contact_step_ < 0; ++step) {
    if (is_pin_closed(move_->at_step(step)) != probe_away_) contact_step_ = step;
  }
}

void Firmware::set_contact_missing(bool missing) {
  is_contact_missing_ = missing;
  if (move_) find_contact(move_->steps_done(now_));
}

void Firmware::set_pin_stuck(bool stuck) {
  is_pin_stuck_ = stuck;
  if (move_) find_contact(move_->steps_done(now_));
}

void Firmware::on_contact() {
  probing_ = Probing::met;
  probe_at_ = move_->at_step(contact_step_);
  if (state_ != State::cycle) return; // it brakes already
  move_->brake(now_, options_.reaction);
  has_hold_flag_ = true;
}

void Firmware::on_move_end() {
  const bool is_held = state_ == State::hold || state_ == State::door;
  if (is_held) is_hold_complete_ = true;
  // Held in the middle of a move or of a probe cycle: the rest waits for a resume.
  if (!is_held || (move_->reaches_target() && probing_ != Probing::met)) finish_move();
}

void Firmware::finish_move() {
  at_ = place();
  move_.reset();
  if (queue_.empty()) planned_ = at_;
  start_next();
}

void Firmware::start_next() {
  if (move_ || queue_.empty()) {
    if (!move_ && (state_ == State::cycle || state_ == State::jog)) state_ = State::idle;
    return;
  }
  if (state_ == State::hold || state_ == State::door) return;
  has_hold_flag_ = false;
  if (state_ == State::idle) state_ = State::cycle;
  move_ = queue_.front();
  queue_.pop_front();
  find_contact(1);
  move_->run(now_);
}

/// As the controller reads it: $6 turns a normally closed probe round.
bool Firmware::is_pin_closed(const Steps& at) const {
  return touches(at) != settings_.is_on(6);
}

bool Firmware::touches(const Steps& at) const {
  if (is_pin_stuck_) return true;
  if (is_contact_missing_ || !options_.surface) return false;
  Steps true_steps = at;
  for (std::size_t axis = 0; axis < at.size(); ++axis) true_steps[axis] += forgotten_[axis];
  const Millimetres place = mm(true_steps);
  return place[2] <= options_.surface(place[0], place[1]);
}

void Firmware::take_input() {
  const char c = input_.front();
  input_.pop_front();
  if (c == '\n' || c == '\r') return end_line();
  if (in_comment_ || after_semicolon_ || line_too_long_) {
    if (c == ')') in_comment_ = false;
    return;
  }
  if (c <= ' ' || c == '/') return;
  if (c == '(')
    in_comment_ = true;
  else if (c == ';')
    after_semicolon_ = true;
  else if (line_.size() >= kLongestLine)
    line_too_long_ = true;
  else
    line_ += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}

void Firmware::end_line() {
  constexpr int kTooLong = 11, kLocked = 9;
  const std::string line = std::exchange(line_, {});
  const bool too_long = std::exchange(line_too_long_, false);
  in_comment_ = after_semicolon_ = false;
  if (too_long)
    reply(kTooLong);
  else if (line.empty())
    reply(0);
  else if (line.front() == '$')
    system_line(line);
  else if (state_ == State::alarm || state_ == State::jog || state_ == State::sleep)
    reply(kLocked);
  else
    gcode_line(line, false);
}

void Firmware::reply(int error) {
  if (replies_to_drop_ > 0) {
    --replies_to_drop_;
    return;
  }
  say(error == 0 ? std::string("ok") : "error:" + std::to_string(error));
}

void Firmware::say(std::string_view line) {
  out_ += line;
  out_ += "\r\n";
}

void Firmware::alarm(int number) {
  say("ALARM:" + std::to_string(number));
  state_ = State::alarm;
  paused_until_ = now_ + options_.alarm_pause;
  if (number != 1 && number != 2) return;
  is_critical_ = owes_critical_message_ = true;
}

void Firmware::raise_alarm(int number) {
  at_ = place();
  move_.reset();
  queue_.clear();
  probing_ = Probing::off;
  planned_ = at_;
  alarm(number);
}

Millimetres Firmware::true_place(Ns now) const {
  Steps at = move_ ? move_->at(now) : at_;
  for (std::size_t axis = 0; axis < at.size(); ++axis) at[axis] += forgotten_[axis];
  return mm(at);
}

} // namespace scansion::sim::grbl
