// Straight moves with finite speed and acceleration, that can be held, gone on with, and cut short.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace scansion::sim::grbl {

/// Nanoseconds of the simulated controller.
using Ns = std::int64_t;
inline constexpr Ns kNever = INT64_MAX;

using Steps = std::array<std::int64_t, 3>;
using Millimetres = std::array<double, 3>;

/// One move from rest to rest along a straight line. Distances in mm, speeds in mm/s. Values only.
class Move {
public:
  Move() = default;
  Move(const Steps& from, const Steps& to, double length, double speed, double acceleration);

  /// Starts, or goes on after a hold, at `now`.
  void run(Ns now);
  /// Brakes from `now + reaction` on.
  void brake(Ns now, Ns reaction);

  [[nodiscard]] Steps at(Ns now) const noexcept;
  [[nodiscard]] double speed(Ns now) const noexcept;
  /// When it stands: at its target, or where it was braked.
  [[nodiscard]] Ns stands_at() const noexcept { return end_; }
  [[nodiscard]] bool reaches_target() const noexcept { return !is_braking_; }
  /// When `steps` steps of the axis with the most are done; kNever: not by what is planned now.
  [[nodiscard]] Ns time_of(std::int64_t steps) const noexcept;
  [[nodiscard]] std::int64_t steps() const noexcept { return steps_; }
  [[nodiscard]] std::int64_t steps_done(Ns now) const noexcept;
  [[nodiscard]] Steps at_step(std::int64_t step) const noexcept;
  [[nodiscard]] const Steps& target() const noexcept { return to_; }

private:
  /// Constant acceleration from `begin` on.
  struct Stretch {
    Ns begin = 0;
    double from = 0.0, speed = 0.0, acceleration = 0.0; ///< mm, mm/s, mm/s2
    double seconds = 0.0;
  };
  [[nodiscard]] double distance(Ns now) const noexcept;
  [[nodiscard]] const Stretch& stretch(Ns now) const noexcept;
  void add(double& from, double speed, double acceleration, double seconds);

  Steps from_{}, to_{};
  std::int64_t steps_ = 0;
  double length_ = 0.0, top_speed_ = 0.0, acceleration_ = 1.0;
  std::array<Stretch, 4> stretches_{};
  std::size_t count_ = 0;
  Ns end_ = kNever;
  bool is_braking_ = false;
};

} // namespace scansion::sim::grbl
