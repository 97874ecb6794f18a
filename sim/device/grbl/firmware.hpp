// A Grbl 1.1h controller with a touch probe over a surface: bytes and time in, bytes out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/device/grbl/block.hpp"
#include "sim/device/grbl/motion.hpp"
#include "sim/device/grbl/settings.hpp"

#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>

namespace scansion::sim::grbl {

enum class Dialect : std::uint8_t { grbl, grblhal };

/// Height of the part at a place in true machine coordinates, mm; -infinity where there is none.
using Surface = std::function<double(double x, double y)>;

struct FirmwareOptions {
  Dialect dialect = Dialect::grbl;
  Surface surface;
  Ns alarm_pause = 500'000'000; ///< deaf after an alarm message
  Ns reaction = 50'000'000;     ///< until a hold or a contact begins to brake
};

enum class State : std::uint8_t { idle, cycle, hold, jog, alarm, door, check, homing, sleep };

/// Coordinates live in whole steps, as in the controller. Time is the caller's: nothing happens between calls. Thread-bound.
///
/// The machine's true place differs from the controller's when a power cut made it forget; homing brings both together.
class Firmware {
public:
  Firmware(FirmwareOptions options, Settings settings);

  /// Banner and all: the controller gets power at `now`. Coordinates begin at 0 where the machine stands.
  void power_on(Ns now);
  void receive(std::span<const std::uint8_t> bytes, Ns now);
  /// Lets everything happen that is due by `now`.
  void run_until(Ns now);
  /// The next moment at which something happens by itself; kNever: only when bytes come.
  [[nodiscard]] Ns next_event() const;
  /// What it has said; the caller clears it.
  [[nodiscard]] std::string& output() noexcept { return out_; }

  // Faults
  void raise_alarm(int number);
  void set_contact_missing(bool missing);
  void set_pin_stuck(bool stuck);
  /// The next `count` replies are never sent.
  void drop_replies(std::uint32_t count) noexcept { replies_to_drop_ += count; }

  [[nodiscard]] State state() const noexcept { return state_; }
  [[nodiscard]] Settings& settings() noexcept { return settings_; }
  /// Where the tip really is, mm.
  [[nodiscard]] Millimetres true_place(Ns now) const;
  [[nodiscard]] std::uint64_t lost_bytes() const noexcept { return lost_bytes_; }

private:
  static constexpr std::size_t kReceive = 128, kReceiveHal = 1024, kPlanner = 15, kPlannerHal = 100, kLongestLine = 79;

  enum class Probing : std::uint8_t { off, armed, met };
  struct Modal {
    int motion = 0; ///< G, tenths; 800: none
    int plane = 170, units = 210, distance = 900, feed_mode = 940, spindle = 50, coolant = 90, system = 540;
    double feed = 0.0, speed = 0.0, tool = 0.0; ///< mm/min
  };

  // firmware.cpp: bytes, real-time commands, what happens by itself
  void take_realtime();
  void do_reset();
  void start(bool after_power);
  void do_hold(bool by_door);
  void do_resume();
  void brake();
  void take_input();
  void end_line();
  void on_move_end();
  void on_contact();
  void find_contact(std::int64_t first);
  [[nodiscard]] bool is_moving() const noexcept { return move_.has_value() && !is_hold_complete_; }
  void finish_move();
  void start_next();
  [[nodiscard]] bool step();
  [[nodiscard]] Ns contact_time() const;
  [[nodiscard]] Ns next_thing() const;
  [[nodiscard]] bool is_pin_closed(const Steps& at) const;
  [[nodiscard]] bool touches(const Steps& at) const;
  [[nodiscard]] Steps place() const { return move_ ? move_->at(now_) : at_; }
  void when(std::function<bool()> ready, std::function<void()> then);
  void reply(int error);
  void say(std::string_view line);
  void alarm(int number);

  // reports.cpp
  void report_status();
  void report_probe();
  [[nodiscard]] std::string position_text(const Millimetres& mm) const;
  [[nodiscard]] Millimetres mm(const Steps& steps) const;
  [[nodiscard]] Millimetres offset() const;
  [[nodiscard]] std::string pins() const;
  void report_modes();
  void report_parameters();
  void report_build();
  void banner();

  // system.cpp: lines that begin with $
  void system_line(std::string_view line);
  void home();
  void toggle_check();
  void unlock();
  void set_or_list(std::string_view rest);

  // gcode.cpp
  struct Plan {
    Modal modal;
    std::array<bool, 3> axes{};
    bool has_axes = false, has_motion = false, is_machine = false; ///< G53
    int other = -1;                                                ///< G4, G10, G28 ... in tenths
    int flow = -1;                                                 ///< M0, M1, M2, M30 in tenths
    Millimetres target{};
    Block block;
  };
  void gcode_line(std::string_view line, bool is_jog);
  [[nodiscard]] static int read_g(int code, Plan& plan);
  [[nodiscard]] static int read_m(int code, Plan& plan);
  [[nodiscard]] int check(Plan& plan, bool is_jog) const;
  void carry_out(const Plan& plan);
  void carry_out_other(const Plan& plan);
  void move_to(const Millimetres& target, double feed, bool is_rapid, std::function<void()> then);
  void arc(const Plan& plan);
  void jog(const Plan& plan);
  void start_probe(const Plan& plan);
  void end_probe();
  void end_program(const Plan& plan);
  void refuse_target();
  [[nodiscard]] bool is_beyond_travel(const Steps& target) const;
  [[nodiscard]] bool has_stopped() const noexcept { return !move_ && queue_.empty() && state_ == State::idle; }
  [[nodiscard]] Steps steps(const Millimetres& mm) const;
  [[nodiscard]] Move make_move(const Steps& from, const Steps& to, double feed, bool is_rapid) const;

  FirmwareOptions options_;
  Settings settings_;
  std::string out_;
  Ns now_ = 0;

  // Input
  std::deque<char> input_; ///< received, not read yet
  std::uint64_t lost_bytes_ = 0;
  std::string line_;
  bool line_too_long_ = false, in_comment_ = false, after_semicolon_ = false;

  // Real-time flags
  bool wants_status_ = false, wants_hold_ = false, wants_resume_ = false, wants_reset_ = false, wants_door_ = false,
       wants_jog_cancel_ = false;

  State state_ = State::idle;
  bool is_hold_complete_ = false;
  bool has_hold_flag_ = false; ///< left behind by a cancelled motion until the next one
  bool is_critical_ = false;   ///< ALARM 1 and 2: deaf until a reset
  bool owes_critical_message_ = false;
  Ns paused_until_ = 0;
  Ns wakes_at_ = kNever; ///< end of a dwell or of homing

  // What the line that is being carried out waits for; at most one.
  std::function<bool()> ready_;
  std::function<void()> then_;

  // Motion
  Steps at_{};      ///< when nothing moves
  Steps planned_{}; ///< where the last planned move ends
  std::optional<Move> move_;
  std::deque<Move> queue_;
  Steps forgotten_{}; ///< true place minus the controller's
  bool is_powered_ = false;

  Probing probing_ = Probing::off;
  bool probe_away_ = false, probe_errs_ = false;
  std::int64_t contact_step_ = -1; ///< of the current move; -1: none
  Steps probe_at_{};
  bool probe_succeeded_ = false;

  bool is_pin_stuck_ = false, is_contact_missing_ = false;
  std::uint32_t replies_to_drop_ = 0;

  Modal modal_;
  std::array<Millimetres, 6> systems_{};
  Millimetres g92_{}, g28_{}, g30_{};
  double tool_length_ = 0.0;
  std::uint32_t reports_to_offset_ = 0, reports_to_overrides_ = 0;
  int feed_override_ = 100, rapid_override_ = 100, speed_override_ = 100;
};

} // namespace scansion::sim::grbl
