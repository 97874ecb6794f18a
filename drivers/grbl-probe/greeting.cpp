// From the opened port to a machine that may be moved: who it is, where it stands, whether the raster fits.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/grbl-probe/codes.hpp"
#include "drivers/grbl-probe/session.hpp"

#include <charconv>
#include <cmath>

namespace scansion::grbl {
namespace {

constexpr Ns kMs = 1'000'000;
constexpr Ns kBannerTime = 2500 * kMs; ///< a boot loader eats what comes in its first two seconds
constexpr Ns kReplyTime = 2500 * kMs;
constexpr Ns kSettleTime = 10'000 * kMs; ///< without any change of state or position
constexpr Ns kOffsetTime = 10'000 * kMs; ///< WCO comes with every 10th report of a machine that stands, every 30th of another
constexpr std::uint32_t kMostTries = 3;

constexpr std::array<char, 3> kAxes{'X', 'Y', 'Z'};

/// `text` as "GC:G0 G54 M5": has this word.
bool has_word(std::string_view text, std::string_view word) noexcept {
  const std::size_t at = text.find(" " + std::string(word));
  if (at == std::string_view::npos) return false;
  const std::string_view behind = text.substr(at + 1 + word.size());
  return behind.empty() || behind.front() == ' ';
}

std::string mm(double value) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, 3);
  return error == std::errc() ? std::string(text.data(), end) : std::string("?");
}

} // namespace

void Session::run_greeting(Ns now) {
  switch (step_) {
    case Step::listen: listen(now); break;
    case Step::settle: settle(now); break;
    case Step::flush:
      if (take_reply() || now - begun_ > kReplyTime) send(Step::identify, "$I", now);
      break;
    case Step::identify: await_listing(Step::settings, "$$", now); break;
    case Step::settings: await_listing(Step::parameters, "$#", now); break;
    case Step::parameters: await_listing(Step::parser, "$G", now); break;
    case Step::parser: await_listing(Step::find_offset, {}, now); break;
    case Step::find_offset:
      if (offset_ && position_ && is_status_fresh_)
        end_greeting(now);
      else if (now - begun_ > kOffsetTime)
        fail_with(Errc::unavailable, "the status reports never have MPos and WCO");
      break;
    case Step::modes: await_modes(now); break;
    default: break; // no other step is of this phase
  }
}

void Session::await_modes(Ns now) {
  const auto reply = take_reply();
  if (reply && *reply == 0) {
    feed_ = limited_feed();
    begin_raster(now);
  } else if (reply) {
    fail_with(Errc::attention, "G21G90G94 is answered by " + describe_error(*reply));
  } else if (now - begun_ > kReplyTime) {
    fail_with(Errc::unavailable, "G21G90G94 is not answered");
  }
}

void Session::listen(Ns now) {
  if (is_status_fresh_ || take_reply()) {
    is_waiting_ = false;
    go(Step::settle, now);
    return;
  }
  const Ns passed = now - begun_;
  if (passed > kBannerTime && !is_waiting_) {
    const Ns begun = begun_;
    send(Step::listen, "", now);
    begun_ = begun;
  } else if (passed > kBannerTime + kReplyTime) {
    const bool is_garbage = link_.rejected(Reject::framing) > garbage_before_;
    fail_with(Errc::unavailable, is_garbage ? "answers with bytes that no Grbl controller sends; is the baud rate right?"
                                            : "does not answer; is it a Grbl controller, and is the baud rate right?");
  }
}

void Session::settle(Ns now) {
  const auto refuse = [this](std::string_view why) { fail_with(Errc::attention, std::string(why)); };
  if (!is_status_fresh_) {
    if (now - begun_ > kReplyTime + kBannerTime) fail_with(Errc::unavailable, "does not answer status queries");
    return;
  }
  switch (status_.state) {
    case MachineState::idle: send(Step::flush, "", now); return;
    case MachineState::alarm:
      is_locked_ = true;
      return refuse("the machine is locked (state Alarm): home it; it is not unlocked from here");
    case MachineState::hold: return refuse("the machine is in feed hold; find out why, then release or reset it by hand");
    case MachineState::door:
      return refuse("the machine's safety door is open, or was; close it and release the machine by hand");
    case MachineState::check: return refuse("the machine is in check mode and would not move; leave it with $C");
    case MachineState::sleep: return refuse("the machine sleeps; reset and home it");
    case MachineState::run:
    case MachineState::jog:
    case MachineState::home:
    case MachineState::other: break;
  }
  // A predecessor's last lines are still being carried out.
  if (now - last_change_ > kSettleTime) {
    fail_with(Errc::unavailable, "the machine stays in state " + std::string(name(status_.state)) + " but does not move");
  }
}

void Session::await_listing(Step step, std::string_view line, Ns now) {
  const auto reply = take_reply();
  if (reply && *reply == 0 && listed_ == 0) {
    is_waiting_ = true; // the reply to somebody else's line
    ++counts_.strays;
  } else if (reply) {
    if (*reply != 0 && step_ == Step::settings) {
      fail_with(Errc::unavailable, "the settings ($$) are refused with " + describe_error(*reply));
    } else if (line.empty()) {
      go(step, now);
    } else {
      send(step, line, now);
    }
  } else if (now - begun_ > kReplyTime) {
    if (++tries_ >= kMostTries) {
      fail_with(Errc::unavailable, "does not answer $I, $$, $# and $G as a Grbl controller does");
      return;
    }
    const std::uint32_t tries = tries_;
    send(step_, step_ == Step::identify ? "$I" : step_ == Step::settings ? "$$" : step_ == Step::parameters ? "$#" : "$G", now);
    tries_ = tries;
  }
}

void Session::on_greeting_answer(const Answer& answer) {
  if (!is_waiting_) return;
  const bool is_bracket = answer.kind == AnswerKind::version || answer.kind == AnswerKind::options ||
                          answer.kind == AnswerKind::probe || answer.kind == AnswerKind::feedback;
  switch (step_) {
    case Step::identify:
      if (answer.kind == AnswerKind::version) machine_.version = answer.text;
      if (answer.kind == AnswerKind::options) take_options(answer.text.substr(0, answer.text.find(',')));
      break;
    case Step::settings:
      if (answer.kind != AnswerKind::setting) return;
      if (const auto value = parse_ticks(answer.text)) take_setting(answer.number, static_cast<double>(*value) / 1e4);
      ++listed_;
      return;
    case Step::parameters:
      if (answer.kind == AnswerKind::probe) last_probe_ = answer.probe;
      break;
    case Step::parser:
      if (answer.text.starts_with("GC:")) machine_.spindle_on = has_word(answer.text, "M3") || has_word(answer.text, "M4");
      break;
    default: return;
  }
  if (is_bracket) ++listed_;
}

/// The letters of [OPT:...], each for a choice made when the controller's program was built.
void Session::take_options(std::string_view letters) noexcept {
  machine_.origin_at_corner = letters.find('Z') != std::string_view::npos;
  machine_.starts_unlocked = letters.find('L') != std::string_view::npos;
}

void Session::take_setting(int number, double value) {
  const bool is_on = value != 0.0;
  switch (number) {
    case 13: machine_.reports_inches = is_on; break;
    case 20: machine_.soft_limits = is_on; break;
    case 22: machine_.homes = is_on; break;
    case 23: machine_.homing_low = static_cast<unsigned>(value); break;
    case 122: machine_.acceleration_z = value; break;
    default: break;
  }
  const auto put = [&](int first, std::array<double, 3>& to) {
    if (number >= first && number < first + 3) to[static_cast<std::size_t>(number - first)] = value;
  };
  put(100, machine_.steps);
  put(130, machine_.travel);
}

void Session::end_greeting(Ns now) {
  if (status_.state != MachineState::idle) {
    go(Step::settle, now);
    return;
  }
  if (std::string why = why_area_does_not_fit(); !why.empty()) {
    fail_with(Errc::config, std::move(why));
  } else if (status_.probe_closed && !has_begun()) {
    fail_with(Errc::attention,
              "the probe is closed (Pn:P) before anything was touched: lift the tip, look at its wire and at $6");
  } else if (machine_.spindle_on) {
    fail_with(Errc::attention, "the spindle is on (M3 or M4 in $G): switch it off with M5 before a probe is in it");
  } else if (const std::string doubt = doubt_about_position(); !doubt.empty()) {
    is_locked_ = true;
    fail_with(Errc::attention, doubt + "; put resume = false to begin anew, or trust_position = true if the coordinates are "
                                       "right all the same");
  } else {
    send(Step::modes, "G21G90G94", now);
  }
}

/// Coordinates must be those of before. A tip that was left on the part by the first probe cycle may only be lifted when they
/// are.
bool Session::has_begun() const noexcept {
  return progress_.has_begun || (progress_.has_probed && status_.probe_closed);
}

/// Any start of the controller, by hand, power or the opened port, clears the position of the last probe cycle that $# shows.
/// A controller with homing is locked then until somebody homes it, if it was not built otherwise.
std::string Session::doubt_about_position() const {
  if (!has_begun() || options_.trust_position || (machine_.homes && !machine_.starts_unlocked)) return {};
  if (!last_probe_ || (last_probe_->at == Position{} && !last_probe_->contact)) {
    return "the controller has started anew since the raster was interrupted and is not locked until it was homed ($22), so "
           "its "
           "position is lost";
  }
  // Otherwise it is of the row that was in work, or of the end of the row before.
  const std::uint32_t last = std::min(row_ + (progress_.is_recorded ? 1U : 0U), raster_.rows() - 1);
  for (std::uint32_t row = row_ - std::min(row_, 1U); row <= last; ++row) {
    for (std::uint32_t column = 0; column < raster_.columns(); ++column) {
      if (is_at(last_probe_->at, row, column)) return {};
    }
  }
  return "the controller's last probe cycle was not where the raster was interrupted, so its position is in doubt";
}

std::string Session::why_area_does_not_fit() const {
  const RasterArea& area = options_.area;
  const std::array<double, 3> low{area.x_from, area.y_from, area.bottom};
  const std::array<double, 3> high{area.x_to, area.y_to, area.top};
  for (std::size_t axis = 0; axis < low.size(); ++axis) {
    const double travel = machine_.travel[axis];
    if (travel <= 0.0) continue;
    const bool rises = machine_.origin_at_corner && ((machine_.homing_low >> axis) & 1U) != 0;
    const double lowest = rises ? 0.0 : -travel;
    const bool is_too_large = high[axis] - low[axis] > travel;
    if (!is_too_large && (!machine_.soft_limits || (low[axis] >= lowest && high[axis] <= lowest + travel))) continue;
    std::string why =
        is_too_large ? "the area is larger than the machine's travel in " : "the area leaves the machine's travel in ";
    why += kAxes[axis];
    why += ", " + mm(lowest) + " to " + mm(lowest + travel) + " mm in machine coordinates (";
    why += "$" + std::to_string(130 + axis) + "=" + mm(travel) + ")";
    return why;
  }
  return {};
}

/// While it brakes from v the tip goes v*v / 2a, and v * 50 ms before that until the controller has noticed.
double Session::limited_feed() const noexcept {
  constexpr double kReaction = 0.05; // s
  const double a = machine_.acceleration_z;
  if (a <= 0.0) return options_.feed;
  const double v = a * (std::sqrt(kReaction * kReaction + 2.0 * options_.overtravel / a) - kReaction);
  return std::min(options_.feed, std::max(1.0, std::floor(v * 60.0)));
}

} // namespace scansion::grbl
