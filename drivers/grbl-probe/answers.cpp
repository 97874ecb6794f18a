// What a Grbl controller says.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/grbl-probe/answers.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

namespace scansion::grbl {
namespace {

constexpr int kDecimals = 4;

struct StateName {
  std::string_view text;
  MachineState state;
};
constexpr std::array<StateName, 9> kStates{{{"Idle", MachineState::idle},
                                            {"Run", MachineState::run},
                                            {"Hold", MachineState::hold},
                                            {"Jog", MachineState::jog},
                                            {"Alarm", MachineState::alarm},
                                            {"Door", MachineState::door},
                                            {"Check", MachineState::check},
                                            {"Home", MachineState::home},
                                            {"Sleep", MachineState::sleep}}};

/// The text before the next `separator`; `text` goes on behind it.
std::string_view take_until(std::string_view& text, char separator) noexcept {
  const std::size_t end = std::min(text.find(separator), text.size());
  const std::string_view head = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return head;
}

std::optional<int> parse_number(std::string_view text) noexcept {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Three coordinates or more; further axes are read for their form and left alone.
std::optional<Position> parse_position(std::string_view text) noexcept {
  Position out{};
  std::size_t axis = 0;
  for (bool more = true; more; ++axis) {
    more = text.find(',') != std::string_view::npos;
    const auto value = parse_ticks(take_until(text, ','));
    if (!value) return std::nullopt;
    if (axis < out.size()) out[axis] = *value;
  }
  return axis < out.size() ? std::nullopt : std::optional(out);
}

bool parse_status(std::string_view text, StatusReport& out) noexcept {
  std::string_view state = take_until(text, '|');
  const std::string_view word = take_until(state, ':');
  const auto* known = std::find_if(kStates.begin(), kStates.end(), [&](const StateName& one) { return one.text == word; });
  if (word.empty()) return false;
  out.state = known == kStates.end() ? MachineState::other : known->state;
  out.substate = parse_number(state).value_or(-1);
  while (!text.empty()) {
    std::string_view value = take_until(text, '|');
    const std::string_view key = take_until(value, ':');
    std::optional<Position>* place = key == "MPos"   ? &out.machine
                                     : key == "WPos" ? &out.work
                                     : key == "WCO"  ? &out.offset
                                                     : nullptr;
    if (place != nullptr) {
      *place = parse_position(value);
      if (!*place) return false;
    } else if (key == "Pn") {
      out.probe_closed = value.find('P') != std::string_view::npos;
    }
  }
  return true;
}

bool parse_probe(std::string_view text, ProbeReport& out) noexcept {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return false;
  const std::string_view flag = text.substr(colon + 1);
  const auto at = parse_position(text.substr(0, colon));
  if (!at || (flag != "0" && flag != "1")) return false;
  out = {*at, flag == "1"};
  return true;
}

bool parse_setting(std::string_view text, Answer& out) noexcept {
  const auto number = parse_number(take_until(text, '='));
  if (!number) return false;
  out.number = *number;
  // Some builds explain each value in brackets behind it.
  out.text = text.substr(0, text.find_first_of(" ("));
  return true;
}

bool parse_bracket(std::string_view inside, Answer& out) noexcept {
  out.text = inside;
  std::string_view rest = inside;
  const std::string_view key = take_until(rest, ':');
  constexpr std::array<std::pair<std::string_view, AnswerKind>, 3> kinds{
      {{"VER", AnswerKind::version}, {"OPT", AnswerKind::options}, {"MSG", AnswerKind::message}}};
  out.kind = key == "PRB" ? AnswerKind::probe : AnswerKind::feedback;
  for (const auto& [word, kind] : kinds) {
    if (key != word) continue;
    out.kind = kind;
    out.text = rest;
  }
  return out.kind != AnswerKind::probe || parse_probe(rest, out.probe);
}

bool is_banner(std::string_view line) noexcept {
  // "Grbl 1.1h ['$' for help]", "GrblHAL 1.1f ['$' or '$HELP' for help]", "Grbl 3.7 [FluidNC v3.7.0 (wifi) '$' for help]".
  return line.starts_with("Grbl") && line.find("'$'") != std::string_view::npos;
}

bool parse_number_after(std::string_view line, std::string_view word, AnswerKind kind, Answer& out) noexcept {
  const auto number = parse_number(line.substr(word.size()));
  out.kind = kind;
  out.number = number.value_or(0);
  return number.has_value();
}

/// False: it begins like an answer but is none.
bool parse_line(std::string_view line, Answer& out) noexcept {
  out.text = line;
  if (line == "ok") {
    out.kind = AnswerKind::ok;
    return true;
  }
  if (line.starts_with("error:")) return parse_number_after(line, "error:", AnswerKind::error, out);
  if (line.starts_with("ALARM:")) return parse_number_after(line, "ALARM:", AnswerKind::alarm, out);
  if (line.front() == '<') {
    out.kind = AnswerKind::status;
    return line.back() == '>' && line.size() > 2 && parse_status(line.substr(1, line.size() - 2), out.status);
  }
  if (line.front() == '[') return line.back() == ']' && parse_bracket(line.substr(1, line.size() - 2), out);
  if (line.front() == '$') {
    out.kind = AnswerKind::setting;
    // `$N0=...` lists start-up lines; named settings exist in other firmware.
    if (!parse_setting(line.substr(1), out)) out.kind = AnswerKind::other;
    return true;
  }
  out.kind = line.front() == '>' ? AnswerKind::start_up : is_banner(line) ? AnswerKind::banner : AnswerKind::other;
  return true;
}

} // namespace

std::string_view name(MachineState state) noexcept {
  for (const StateName& one : kStates) {
    if (one.state == state) return one.text;
  }
  return "an unknown state";
}

std::optional<Ticks> parse_ticks(std::string_view text) noexcept {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  Ticks value = 0;
  int decimals = -1; // -1: no point yet
  bool any = false;
  for (const char c : text) {
    if (c == '.' && decimals < 0) {
      decimals = 0;
      continue;
    }
    if (c < '0' || c > '9') return std::nullopt;
    any = true;
    if (decimals >= kDecimals) {
      if (c != '0') return std::nullopt;
      continue;
    }
    value = value * 10 + (c - '0');
    if (decimals >= 0) ++decimals;
    if (value > kFarthest) return std::nullopt;
  }
  for (int i = std::max(decimals, 0); i < kDecimals; ++i) value *= 10;
  if (!any || value > kFarthest) return std::nullopt;
  return negative ? -value : value;
}

std::optional<Answer> Answers::finish_line() {
  const std::size_t length = std::exchange(length_, 0);
  if (std::exchange(is_overlong_, false)) {
    is_garbage_ = false;
    counters_.reject(Reject::overlong);
    return std::nullopt;
  }
  if (std::exchange(is_garbage_, false)) {
    counters_.reject(Reject::framing);
    return std::nullopt;
  }
  if (length == 0) return std::nullopt; // between CR and LF, or the empty line before a banner
  Answer answer;
  if (parse_line({line_.data(), length}, answer)) {
    counters_.accept();
    return answer;
  }
  counters_.reject(Reject::value);
  return std::nullopt;
}

std::optional<Answer> Answers::next(std::span<const std::byte>& bytes) {
  while (!bytes.empty()) {
    const char c = static_cast<char>(bytes.front());
    bytes = bytes.subspan(1);
    if (c == '\n' || c == '\r') {
      if (auto answer = finish_line()) return answer;
      continue;
    }
    is_garbage_ |= c < ' ' || c > '~'; // char is signed here: this takes in all above 0x7F
    if (length_ < kLongest)
      line_[length_++] = c;
    else
      is_overlong_ = true;
  }
  return std::nullopt;
}

} // namespace scansion::grbl
