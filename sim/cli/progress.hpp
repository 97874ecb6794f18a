// Progress on a terminal, and a request to stop by SIGINT or SIGTERM.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace scansion {

/// A percentage on standard error, at most ten times a second; nothing when that is no terminal. Cleared at the end.
class Progress {
public:
  Progress(std::string what, std::uint64_t total);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress();

  void at(std::uint64_t done);

private:
  std::string what_;
  std::uint64_t total_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point next_;
};

/// From now on SIGINT and SIGTERM ask to stop, so that temporary files are removed; a second signal ends the process.
void catch_stop_signals() noexcept;
[[nodiscard]] bool stop_requested() noexcept;

} // namespace scansion
