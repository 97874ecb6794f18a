// Runs another program to its end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace scansion::bench {

struct Ended {
  int status = 127; ///< exit code; 127: could not be started; 128 + signal
  std::string out;  ///< standard output
  double wall_s = 0.0;
  double cpu_s = 0.0; ///< of all its threads
};

/// Searches PATH when command[0] has no slash. Standard error is passed through unless `quiet`.
[[nodiscard]] Ended run_program(const std::vector<std::string>& command, bool quiet = false);

} // namespace scansion::bench
