// What a Grbl controller says: bytes in, one answer a line out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/port/link_counters.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace scansion::grbl {

/// Ten-thousandths of the reporting unit, mm or inch: all that a controller prints is a whole number of them.
using Ticks = std::int64_t;
using Position = std::array<Ticks, 3>;

/// Largest magnitude of a coordinate that is believed: 100 m.
inline constexpr Ticks kFarthest = 1'000'000'000;

enum class MachineState : std::uint8_t { idle, run, hold, jog, alarm, door, check, home, sleep, other };
[[nodiscard]] std::string_view name(MachineState state) noexcept;

/// The inside of `<...>`. Fields that were not in the report are empty.
struct StatusReport {
  MachineState state = MachineState::other;
  int substate = -1; ///< of Hold and Door; Hold:0 has stopped, Hold:1 still slows down
  std::optional<Position> machine, work, offset;
  bool probe_closed = false; ///< Pn has P

  friend bool operator==(const StatusReport&, const StatusReport&) = default;
};

/// `[PRB:x,y,z:1]`, machine coordinates.
struct ProbeReport {
  Position at{};
  bool contact = false;

  friend bool operator==(const ProbeReport&, const ProbeReport&) = default;
};

enum class AnswerKind : std::uint8_t {
  ok,       ///< reply
  error,    ///< reply; `number`
  alarm,    ///< push; `number`
  status,   ///< push; `status`
  probe,    ///< push; `probe`
  banner,   ///< push: the controller has just started
  setting,  ///< `$number=text`
  version,  ///< `[VER:text]`
  options,  ///< `[OPT:text]`
  message,  ///< `[MSG:text]`
  feedback, ///< any other `[text]`
  start_up, ///< `>line:ok`: no reply to anything
  other     ///< a whole line that is none of these
};

struct Answer {
  AnswerKind kind = AnswerKind::other;
  int number = 0;
  StatusReport status;
  ProbeReport probe;
  std::string_view text; ///< valid until the next call of next()
};

/// Incremental and pure: any cut of the bytes into pieces gives the same answers. Allocates nothing; whatever comes, it keeps
/// kLongest bytes. Each line is counted once: accepted, overlong (no end of line within kLongest bytes), framing (bytes that no
/// controller sends: a wrong baud rate or a bad cable) or value (begins like an answer but is none).
class Answers {
public:
  static constexpr std::size_t kLongest = 512; ///< bytes of a line; grblHAL's longest seen has 120

  explicit Answers(LinkCounters& counters) noexcept : counters_(counters) {}

  /// Takes bytes off the front of `bytes` until an answer is complete. Empty: all were taken and there is none yet.
  [[nodiscard]] std::optional<Answer> next(std::span<const std::byte>& bytes);

private:
  [[nodiscard]] std::optional<Answer> finish_line();

  LinkCounters& counters_;
  std::array<char, kLongest> line_{};
  std::size_t length_ = 0;
  bool is_overlong_ = false;
  bool is_garbage_ = false;
};

/// A decimal with at most four decimals, in ticks. Empty: it is none, or out of range.
[[nodiscard]] std::optional<Ticks> parse_ticks(std::string_view text) noexcept;

} // namespace scansion::grbl
