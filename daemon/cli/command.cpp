// What every verb shares.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/cli/command.hpp"
#include "daemon/cli/streams.hpp"

#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <unistd.h>

namespace scansion::cli {
namespace {

// Only calls that are allowed in a signal handler.
extern "C" void on_stop_signal(int) {
  unlink_pending_files();
  ::_exit(kInterrupted);
}

} // namespace

void say(const std::string& message) {
  const std::string line = "scansion: " + with_names_of_the_user(message) + "\n";
  // Nothing can be told if standard error is gone.
  static_cast<void>(std::fwrite(line.data(), 1, line.size(), stderr));
}

const CLI::Validator& positive_number() {
  static const CLI::Validator validator(
      [](std::string& text) {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        const bool good = end != text.c_str() && *end == '\0' && value > 0.0 && std::isfinite(value);
        return good ? std::string() : "'" + text + "' is no number above 0";
      },
      "above 0");
  return validator;
}

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction ignore {};
  ignore.sa_handler = SIG_IGN; // a closed pipe is a write error with a message, a file size limit too
  sigaction(SIGPIPE, &ignore, nullptr);
  sigaction(SIGXFSZ, &ignore, nullptr);
}

ProgressLine::ProgressLine(std::string what)
    : what_(std::move(what)), terminal_(::isatty(STDERR_FILENO) == 1), next_(std::chrono::steady_clock::now()) {}

ProgressLine::~ProgressLine() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

void ProgressLine::show(std::uint64_t done, std::uint64_t total) {
  if (!terminal_ || total == 0) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::milliseconds(200);
  std::fprintf(stderr, "\r\033[K%s %3u %%", what_.c_str(),
               static_cast<unsigned>(static_cast<double>(done) * 100.0 / static_cast<double>(total)));
  std::fflush(stderr);
  drawn_ = true;
}

std::string number(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string ranges(const std::vector<std::pair<std::uint64_t, std::uint64_t>>& lines) {
  std::string text;
  for (const auto& [first, last] : lines) {
    if (!text.empty()) text += ", ";
    text += std::to_string(first);
    if (last != first) text += "-" + std::to_string(last);
  }
  return text;
}

} // namespace scansion::cli
