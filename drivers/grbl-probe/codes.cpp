// What Grbl's numbered errors and alarms mean.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/grbl-probe/codes.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace scansion::grbl {
namespace {

struct Code {
  int number;
  std::string_view meaning;
};

constexpr std::array<Code, 17> kErrors{{{1, "a G-code word without its letter"},
                                        {2, "a number that cannot be read"},
                                        {3, "an unknown $ command"},
                                        {5, "homing is switched off, $22=0"},
                                        {6, "the step pulse $0 is shorter than 3 us"},
                                        {7, "settings were damaged and set back to their defaults"},
                                        {8, "a $ command while the machine moves"},
                                        {9, "locked after an alarm or a reset"},
                                        {10, "soft limits need homing"},
                                        {11, "the line is too long"},
                                        {13, "the safety door is open"},
                                        {15, "a jog beyond the travel"},
                                        {16, "a jog that cannot be read"},
                                        {20, "unknown G-code"},
                                        {22, "no feed rate"},
                                        {26, "no axis word"},
                                        {33, "a target that cannot be reached from here"}}};

constexpr std::array<Code, 10> kAlarms{{{1, "hard limit: a limit switch was hit, the position is lost"},
                                        {2, "soft limit: a target lies beyond the travel"},
                                        {3, "reset while moving: the position is in doubt"},
                                        {4, "the probe was not open when probing began"},
                                        {5, "the probe met nothing"},
                                        {6, "reset during homing: the position is lost"},
                                        {7, "safety door opened during homing: the position is lost"},
                                        {8, "homing could not leave the switch: the position is lost"},
                                        {9, "homing found no switch: the position is lost"},
                                        {10, "homing of a twin axis failed: the position is lost"}}};

template <std::size_t N>
std::string describe(std::string_view word, int number, const std::array<Code, N>& codes) {
  std::string out = std::string(word) + std::to_string(number);
  const auto known = std::find_if(codes.begin(), codes.end(), [&](const Code& code) { return code.number == number; });
  if (known != codes.end()) out += " (" + std::string(known->meaning) + ")";
  return out;
}

} // namespace

std::string describe_error(int number) {
  return describe("error:", number, kErrors);
}

std::string describe_alarm(int number) {
  return describe("ALARM:", number, kAlarms);
}

} // namespace scansion::grbl
