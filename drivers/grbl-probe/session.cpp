// One conversation with a controller: what all its phases share, and how it is stopped.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/grbl-probe/session.hpp"

#include "drivers/grbl-probe/codes.hpp"

#include <cmath>
#include <utility>

namespace scansion::grbl {
namespace {

constexpr Ns kMs = 1'000'000;
constexpr Ns kSilence = 5000 * kMs;  ///< polls without any answer; homing and alarms are silent for a second or so
constexpr Ns kHoldTime = 3000 * kMs; ///< in which a feed hold must show itself before a reset is taken
constexpr Ns kLeaveTime = 900 * kMs; ///< the same when the daemon ends
constexpr Ns kIdleHold = 500 * kMs;  ///< reports of before the hold do not count
constexpr char kReset = 0x18;

} // namespace

Session::Session(const SessionOptions& options, const Raster& raster, HeightMap& heights, const Progress& progress,
                 LinkCounters& counters, Ns now)
    : options_(options), raster_(raster), heights_(heights), progress_(progress), link_(counters),
      garbage_before_(counters.rejected(Reject::framing)), answers_(counters), begun_(now), last_heard_(now), last_change_(now),
      last_talk_(now), next_poll_(now), has_touched_(progress.has_begun),
      has_probed_(progress.has_begun || progress.has_probed), row_(progress.rows) {
  out_.reserve(256);
  current_.points.resize(raster.columns());
}

Ns Session::poll_interval() const noexcept {
  constexpr Ns kFast = 100 * kMs, kSlow = 200 * kMs; // the controller answers up to ten a second beside its work
  if (halt_ != Halt::none && !at_rest_) return kFast;
  switch (phase_) {
    case Phase::greeting: return kFast;
    case Phase::probing: return kSlow;
    case Phase::finished:
    case Phase::failed: break;
  }
  return 1000 * kMs;
}

Ns Session::deadline() const noexcept {
  return next_poll_;
}

void Session::tick(Ns now) {
  if (now >= next_poll_) {
    next_poll_ = now + poll_interval();
    if (phase_ != Phase::failed || (halt_ != Halt::none && !at_rest_)) out_ += '?';
  }
  run(now);
}

void Session::received(std::span<const std::byte> bytes, Ns now) {
  if (!bytes.empty()) last_heard_ = now;
  while (const auto answer = answers_.next(bytes)) on_answer(*answer, now);
  // Only now: what came together with a reply cannot be the reply to the next line.
  run(now);
}

void Session::run(Ns now) {
  if (halt_ != Halt::none) run_halt(now);
  if (halt_ != Halt::none || phase_ == Phase::failed) return;
  if (phase_ != Phase::greeting && now - last_heard_ > kSilence) {
    fail_with(Errc::unavailable, "the controller has not answered for 5 s");
    return;
  }
  if (phase_ == Phase::greeting) run_greeting(now);
  if (phase_ == Phase::probing) run_probing(now);
}

void Session::on_answer(const Answer& answer, Ns now) {
  if (answer.kind != AnswerKind::status) last_talk_ = now;
  switch (answer.kind) {
    case AnswerKind::ok: on_reply(0); break;
    case AnswerKind::error: on_reply(answer.number); break;
    case AnswerKind::alarm: on_alarm(answer.number); break;
    case AnswerKind::status: on_status(answer.status, now); break;
    case AnswerKind::banner: on_banner(now); break;
    case AnswerKind::probe:
      // The listing of $# repeats the last one at any time a second host asks for it.
      if (step_ == Step::probe && is_waiting_) {
        ++probes_seen_;
        probe_ = answer.probe;
      }
      break;
    case AnswerKind::message: is_disturbed_ |= answer.text.find("Door") != std::string_view::npos; break;
    case AnswerKind::setting:
    case AnswerKind::version:
    case AnswerKind::options:
    case AnswerKind::feedback:
    case AnswerKind::start_up:
    case AnswerKind::other: break;
  }
  if (phase_ == Phase::greeting) on_greeting_answer(answer);
}

void Session::on_reply(int error) {
  if (!is_waiting_ || reply_) {
    ++counts_.strays;
    return;
  }
  reply_ = error;
}

void Session::on_alarm(int number) {
  if (is_of_probing(number) && step_ == Step::probe && is_waiting_) {
    alarm_ = number;
    return;
  }
  is_locked_ = true;
  const std::string_view advice = is_of_probing(number) || number == 2
                                      ? "; see what it stands against, then reset and unlock it by hand"
                                      : "; home the machine, it is not unlocked from here";
  fail_with(Errc::attention, describe_alarm(number) + std::string(advice));
}

void Session::on_banner(Ns now) {
  if (was_reset_ || phase_ == Phase::failed || phase_ == Phase::finished) return;
  if (phase_ == Phase::greeting) {
    // The port was opened: many boards start anew then. Whether coordinates still hold is seen at the end of the greeting.
    is_waiting_ = false;
    reply_.reset();
    go(Step::settle, now);
    return;
  }
  is_locked_ = true;
  fail_with(Errc::attention, "the controller has started anew in the middle of the raster (reset button, power?): its position "
                             "is lost; home the machine");
}

void Session::on_status(const StatusReport& status, Ns now) {
  if (status.offset) offset_ = status.offset;
  std::optional<Position> at = status.machine;
  if (!at && status.work && offset_) {
    at = *status.work;
    for (std::size_t axis = 0; axis < at->size(); ++axis) (*at)[axis] += (*offset_)[axis];
  }
  if (status.state != status_.state || status.substate != status_.substate || at != position_) last_change_ = now;
  if (at) position_ = at;
  status_ = status;
  is_status_fresh_ = true;
  if (is_machine_held()) is_disturbed_ = true;
  if (phase_ != Phase::probing || was_reset_) return;
  const bool is_strange =
      status.state == MachineState::check || status.state == MachineState::sleep || status.state == MachineState::home;
  // A report of before $X may come after it was sent.
  const bool is_alarm = status.state == MachineState::alarm && alarm_ == 0 && step_ != Step::unlock;
  if (!is_strange && !is_alarm) return;
  is_locked_ = true;
  fail_with(Errc::attention, "the machine is in state " + std::string(name(status.state)) +
                                 " in the middle of the raster; it is not unlocked from here");
}

void Session::send(Step step, std::string_view line, Ns now) {
  go(step, now);
  is_waiting_ = true;
  reply_.reset();
  listed_ = 0;
  probes_seen_ = 0;
  alarm_ = 0;
  is_disturbed_ = is_machine_held();
  last_change_ = now;
  out_ += line;
  out_ += '\n';
}

void Session::go(Step step, Ns now) {
  if (step != step_) tries_ = 0;
  step_ = step;
  begun_ = now;
  is_status_fresh_ = false;
}

std::optional<int> Session::take_reply() noexcept {
  if (!reply_) return std::nullopt;
  is_waiting_ = false;
  return std::exchange(reply_, std::nullopt);
}

void Session::fail_with(Errc code, std::string context) {
  if (failure_) return;
  phase_ = Phase::failed;
  failure_ = Error{code, std::move(context)};
}

std::optional<Row> Session::take_row() {
  if (rows_.empty()) return std::nullopt;
  Row row = std::move(rows_.front());
  rows_.pop_front();
  return row;
}

Um Session::to_um(Ticks ticks) const noexcept {
  constexpr double kMm = 0.1, kInch = 2.54; // um in a tick
  return std::llround(static_cast<double>(ticks) * (machine_.reports_inches ? kInch : kMm));
}

std::string Session::condition() const {
  if (failure_) return failure_->context;
  if (halt_ == Halt::hold) return at_rest_ ? "held by command" : "comes to a stop by command";
  if (phase_ == Phase::probing && status_.state == MachineState::hold) return "the machine is in feed hold; press cycle start";
  if (phase_ == Phase::probing && status_.state == MachineState::door)
    return "the safety door is open, or was; close it, press cycle start";
  return {};
}

bool Session::can_move() const noexcept {
  if (is_locked_ || was_reset_) return false;
  switch (phase_) {
    case Phase::greeting: return status_.state == MachineState::run || status_.state == MachineState::jog;
    case Phase::probing: return true;
    case Phase::finished: return false;
    case Phase::failed: break;
  }
  return position_.has_value() && feed_ > 0.0; // it has been moved from here
}

void Session::hold(Ns now) {
  if (halt_ == Halt::none) halt(Halt::hold, now);
  goes_on_ = false;
}

void Session::leave(Ns now) {
  if (halt_ != Halt::leave) halt(Halt::leave, now);
}

void Session::go_on() {
  goes_on_ = true;
}

void Session::halt(Halt how, Ns now) {
  halt_ = how;
  halted_ = now;
  is_status_fresh_ = false;
  at_rest_ = !can_move();
  if (at_rest_) return;
  out_ += "!?";
  next_poll_ = now + poll_interval();
}

void Session::reset_controller() {
  out_ += kReset;
  was_reset_ = true;
  at_rest_ = true;
}

void Session::run_halt(Ns now) {
  if (!at_rest_) {
    const MachineState state = status_.state;
    const Ns passed = now - halted_;
    const bool stands = is_status_fresh_ && ((state == MachineState::hold && status_.substate == 0) ||
                                             (state == MachineState::door && status_.substate >= 0 && status_.substate <= 1));
    const bool is_dead =
        is_status_fresh_ && (state == MachineState::alarm || state == MachineState::sleep || state == MachineState::check ||
                             (state == MachineState::idle && passed > kIdleHold));
    const bool brakes = is_status_fresh_ && is_machine_held();
    if (is_dead || (stands && halt_ == Halt::hold)) {
      at_rest_ = true;
    } else if (stands) {
      reset_controller();
    } else if (halt_ == Halt::leave && passed > kLeaveTime) {
      // Braking goes on without us; nothing moves it again before somebody says so.
      if (!brakes) reset_controller();
    } else if (halt_ == Halt::hold && passed > kHoldTime && !brakes) {
      reset_controller();
      fail_with(Errc::attention,
                "feed hold did not stop the machine, so it was reset: its position is in doubt; home the machine");
    }
  }
  if (!at_rest_ || !goes_on_ || halt_ != Halt::hold) return;
  goes_on_ = false;
  halt_ = Halt::none;
  last_change_ = now;
  last_heard_ = now;
  if (is_machine_held()) {
    out_ += '~';
    is_disturbed_ = true;
  }
}

} // namespace scansion::grbl
