// One conversation with a controller: bytes and time in, commands and rows out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/grbl-probe/answers.hpp"
#include "drivers/grbl-probe/raster.hpp"
#include "pipeline/model/result.hpp"

#include <deque>
#include <optional>
#include <string>

namespace scansion::grbl {

/// Nanoseconds of a clock that never goes back.
using Ns = std::int64_t;

struct SessionOptions {
  RasterArea area;
  double feed = 60.0;      ///< mm/min while probing
  double overtravel = 1.0; ///< mm that the probe may be pressed in while the machine brakes
  std::uint32_t max_misses = 20;
  bool trust_position = false;
};

/// What the controller said about itself before the first move. Lengths in mm, whatever it reports in.
struct Machine {
  std::string version;            ///< inside of [VER:...], empty when it has none
  bool reports_inches = false;    ///< $13
  bool soft_limits = false;       ///< $20
  bool homes = false;             ///< $22: locked after each start until somebody homes it
  bool starts_unlocked = false;   ///< the build does not insist on homing after a start
  bool origin_at_corner = false;  ///< the build sets coordinates to 0 where it homed, not to the negative travel
  unsigned homing_low = 0;        ///< $23: bit 0 for x: it homes to the low end
  bool spindle_on = false;        ///< M3 or M4 in $G
  std::array<double, 3> steps{};  ///< $100..$102, a mm; 0: not told
  double acceleration_z = 0.0;    ///< $122, mm/s2; 0: not told
  std::array<double, 3> travel{}; ///< $130..$132; 0: not told
};

/// One row as far as it was probed, in the order of its columns (x rises).
struct Row {
  std::uint32_t index = 0;
  std::vector<std::optional<Position>> points; ///< machine coordinates; empty: nothing was met there

  friend bool operator==(const Row&, const Row&) = default;
};

/// How far a raster has come, in this process or in a recording.
struct Progress {
  std::uint32_t rows = 0;   ///< complete ones
  bool has_begun = false;   ///< the machine has touched the part: coordinates must still be those of then
  bool has_probed = false;  ///< a probe cycle was sent: the tip may stand on the part
  bool is_recorded = false; ///< rows are those on disk: one more may have been done and lost with the open group
};

struct SessionCounts {
  std::uint64_t strays = 0;    ///< replies to nothing that was asked here
  std::uint64_t repeats = 0;   ///< points probed once more
  std::uint64_t disturbed = 0; ///< of these: because of a feed hold or the safety door
  std::uint64_t resyncs = 0;
  std::uint64_t misses = 0;
};

/// Pure: no input or output, clock, thread or log; the same bytes at the same times give the same commands. One line is
/// outstanding at a time, so no receive buffer can overflow. It sends `$X` only after ALARM 4 and 5 of its own probing, never
/// `$H`, and a reset only when a feed hold does not stop the machine, or after it did and the port is to be closed.
class Session {
public:
  /// A fresh connection; nothing is known about the controller. The references outlive the session.
  Session(const SessionOptions& options, const Raster& raster, HeightMap& heights, const Progress& progress,
          LinkCounters& counters, Ns now);

  void received(std::span<const std::byte> bytes, Ns now);
  /// Time has come to `now`; call it at deadline() at the latest.
  void tick(Ns now);
  [[nodiscard]] Ns deadline() const noexcept;

  /// Bytes to send, in order. The caller clears it.
  [[nodiscard]] std::string& output() noexcept { return out_; }

  /// The greeting is over and the machine may be moved.
  [[nodiscard]] bool is_ready() const noexcept { return phase_ != Phase::greeting && phase_ != Phase::failed; }
  [[nodiscard]] bool is_finished() const noexcept { return phase_ == Phase::finished; }
  /// The oldest finished row that was not taken yet.
  [[nodiscard]] std::optional<Row> take_row();
  /// Why the conversation is over. Nothing more is sent then, but leave() and hold().
  [[nodiscard]] const std::optional<Error>& failure() const noexcept { return failure_; }
  /// Some points of a row were probed, but the row never became whole.
  [[nodiscard]] bool has_broken_row() const noexcept { return step_in_row_ > 0 && phase_ != Phase::finished; }

  /// Feed hold at once; no new line is sent before go_on().
  void hold(Ns now);
  /// The end of hold(), as soon as the machine stands. A probe cycle that was held is done again.
  void go_on();
  [[nodiscard]] bool is_held() const noexcept { return halt_ == Halt::hold; }
  /// As hold(); then a reset, so that nothing queued in the controller moves it any more.
  void leave(Ns now);
  /// Nothing moves, or nothing can be done about it from here.
  [[nodiscard]] bool is_at_rest() const noexcept { return at_rest_; }
  /// leave() had to be: the machine was in use.
  [[nodiscard]] bool was_reset() const noexcept { return was_reset_; }

  [[nodiscard]] const Machine& machine() const noexcept { return machine_; }
  [[nodiscard]] const SessionCounts& counts() const noexcept { return counts_; }
  /// The tip has met the part, now or before.
  [[nodiscard]] bool has_touched() const noexcept { return has_touched_; }
  /// A probe cycle was sent, now or before.
  [[nodiscard]] bool has_probed() const noexcept { return has_probed_; }
  /// What keeps it from going on, for a person; empty: nothing.
  [[nodiscard]] std::string condition() const;
  /// When the controller last said anything.
  [[nodiscard]] Ns last_heard() const noexcept { return last_heard_; }
  /// Feed while probing after the limit that the overtravel sets, mm/min.
  [[nodiscard]] double feed() const noexcept { return feed_; }

private:
  enum class Phase : std::uint8_t { greeting, probing, finished, failed };
  enum class Step : std::uint8_t {
    // greeting
    listen,      ///< for a banner or a status report
    settle,      ///< until the machine stands
    flush,       ///< an empty line ends what a predecessor left half written
    identify,    ///< $I
    settings,    ///< $$
    parameters,  ///< $#
    parser,      ///< $G
    find_offset, ///< a status report with WCO
    modes,       ///< G21G90G94
    // one point
    lift,
    traverse,
    probe,
    // after ALARM 4 or 5
    unlock,
    unlocked_lift,
    unlocked_fence,
    unlocked_look, ///< is the pin open now?
    // after replies that do not fit
    quiet,
    quiet_flush,
    quiet_settle,
    // after the last row
    end_lift,
    end_fence
  };
  enum class Halt : std::uint8_t { none, hold, leave };

  // session.cpp: what is common
  void on_answer(const Answer& answer, Ns now);
  void on_status(const StatusReport& status, Ns now);
  void on_reply(int error);
  void on_alarm(int number);
  void on_banner(Ns now);
  /// Goes to `step` with this line outstanding.
  void send(Step step, std::string_view line, Ns now);
  void go(Step step, Ns now);
  /// The reply to the outstanding line, once: 0 for ok, or the number of the error.
  [[nodiscard]] std::optional<int> take_reply() noexcept;
  void fail_with(Errc code, std::string context);
  void run(Ns now);
  void halt(Halt how, Ns now);
  void run_halt(Ns now);
  void reset_controller();
  [[nodiscard]] bool can_move() const noexcept;
  [[nodiscard]] Ns poll_interval() const noexcept;
  [[nodiscard]] bool is_machine_held() const noexcept {
    return status_.state == MachineState::hold || status_.state == MachineState::door;
  }
  [[nodiscard]] Um to_um(Ticks ticks) const noexcept;

  // greeting.cpp
  void run_greeting(Ns now);
  void listen(Ns now);
  void settle(Ns now);
  void await_listing(Step step, std::string_view line, Ns now);
  void end_greeting(Ns now);
  void await_modes(Ns now);
  void on_greeting_answer(const Answer& answer);
  void take_setting(int number, double value);
  void take_options(std::string_view letters) noexcept;
  [[nodiscard]] std::string why_area_does_not_fit() const;
  [[nodiscard]] bool has_begun() const noexcept;
  [[nodiscard]] std::string doubt_about_position() const;
  [[nodiscard]] double limited_feed() const noexcept;

  // probing.cpp
  void begin_raster(Ns now);
  void run_probing(Ns now);
  void begin_point(bool from_top, Ns now);
  void probe_here(Ns now);
  void judge_probe(Ns now);
  void take_contact(Ns now);
  void take_miss(Ns now);
  void next_point(bool from_top, Ns now);
  void end_raster(Ns now);
  void refuse_reply(int error, Ns now);
  [[nodiscard]] std::string place() const;
  [[nodiscard]] std::string why_not_here() const;
  /// Within what rounding to steps allows.
  [[nodiscard]] Um tolerance(std::size_t axis) const noexcept;
  [[nodiscard]] bool is_at(const Position& at, std::uint32_t row, std::uint32_t column) const noexcept;

  // recovery.cpp
  void resync(std::string_view why, Ns now);
  void run_recovery(Ns now);
  void look_at_pin(Ns now);
  void wait_for_quiet(Ns now);
  void settle_after_flush(Ns now);

  const SessionOptions options_;
  const Raster& raster_;
  HeightMap& heights_;
  const Progress progress_;
  LinkCounters& link_;
  const std::uint64_t garbage_before_;
  Answers answers_;
  std::string out_;

  Phase phase_ = Phase::greeting;
  Step step_ = Step::listen;
  Halt halt_ = Halt::none;
  bool goes_on_ = false; ///< go_on() was called
  bool at_rest_ = false, was_reset_ = false;
  bool is_locked_ = false; ///< an alarm or a start of the controller: nothing moves
  std::optional<Error> failure_;
  Machine machine_;
  SessionCounts counts_;

  // The line that is outstanding, and what came since it was sent.
  bool is_waiting_ = false;
  std::optional<int> reply_;
  std::uint32_t listed_ = 0;      ///< lines of a listing
  std::uint32_t probes_seen_ = 0; ///< PRB lines
  ProbeReport probe_;
  int alarm_ = 0;             ///< 4 or 5
  bool misses_alarm_ = false; ///< the alarm that is being cleared was a 5
  bool is_disturbed_ = false; ///< a feed hold or the door came in between

  StatusReport status_;
  std::optional<Position> position_, offset_; ///< machine coordinates; WCO
  bool is_status_fresh_ = false;              ///< came since go() or halt()
  std::optional<ProbeReport> last_probe_;     ///< from $#

  Ns begun_; ///< the step
  Ns halted_ = 0;
  Ns last_heard_;
  Ns last_change_; ///< of state or position, or the last sending
  Ns last_talk_;   ///< the last line that was no status report
  Ns next_poll_;
  std::uint32_t tries_ = 0;       ///< of the step
  std::uint32_t settles_ = 0;     ///< of an empty line after a reply that did not fit
  std::uint32_t point_tries_ = 0; ///< of the point

  bool has_touched_, has_probed_;
  double feed_ = 0.0;
  std::uint32_t row_ = 0, step_in_row_ = 0;
  std::uint32_t column_ = 0, last_column_ = 0;
  Um z_ = 0;       ///< where the tip is when all that was sent is done, or higher
  Um ceiling_ = 0; ///< no contact can be higher
  std::uint32_t misses_together_ = 0;
  std::uint64_t strays_before_ = 0;
  Row current_;
  std::deque<Row> rows_;
};

} // namespace scansion::grbl
