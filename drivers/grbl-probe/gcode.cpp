// The G-code lines this driver sends.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/grbl-probe/gcode.hpp"

#include <cmath>

namespace scansion::grbl {
namespace {

/// mm with three decimals, exactly.
std::string mm(Um value) {
  constexpr Um kThousand = 1000;
  const Um size = value < 0 ? -value : value;
  std::string fraction = std::to_string(kThousand + size % kThousand);
  fraction.front() = '.';
  return (value < 0 ? "-" : "") + std::to_string(size / kThousand) + fraction;
}

} // namespace

std::string lift_line(Um z) {
  return "G53G0Z" + mm(z);
}

std::string traverse_line(Um x, Um y) {
  return "G53G0X" + mm(x) + "Y" + mm(y);
}

std::string probe_line(Um z, double feed) {
  constexpr double kUm = 1000.0;
  return "G38.3Z" + mm(z) + "F" + mm(std::llround(feed * kUm));
}

} // namespace scansion::grbl
