// What Grbl's numbered errors and alarms mean, for messages.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace scansion::grbl {

/// "error:9 (locked after an alarm or a reset)"; numbers that are not known stand alone.
[[nodiscard]] std::string describe_error(int number);
[[nodiscard]] std::string describe_alarm(int number);

/// A probe cycle that ended without contact or could not begin. The machine knows where it is and may be unlocked; after every
/// other alarm it may be elsewhere than it says, and only a person may unlock it.
[[nodiscard]] constexpr bool is_of_probing(int alarm) noexcept {
  return alarm == 4 || alarm == 5;
}

} // namespace scansion::grbl
