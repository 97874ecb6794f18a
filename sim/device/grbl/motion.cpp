// Straight moves with finite speed and acceleration.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/grbl/motion.hpp"

#include <algorithm>
#include <cmath>

namespace scansion::sim::grbl {
namespace {

constexpr double kNsPerSecond = 1e9;

double seconds(Ns from, Ns to) noexcept {
  return static_cast<double>(to - from) / kNsPerSecond;
}

Ns after(Ns begin, double s) noexcept {
  return begin + static_cast<Ns>(std::ceil(s * kNsPerSecond));
}

} // namespace

Move::Move(const Steps& from, const Steps& to, double length, double speed, double acceleration)
    : from_(from), to_(to), length_(length), top_speed_(speed), acceleration_(acceleration) {
  for (std::size_t axis = 0; axis < from.size(); ++axis) steps_ = std::max(steps_, std::abs(to[axis] - from[axis]));
}

void Move::add(double& from, double speed, double acceleration, double duration) {
  const Ns begin = end_;
  stretches_[count_++] = {begin, from, speed, acceleration, duration};
  from += speed * duration + acceleration * duration * duration / 2.0;
  end_ = after(begin, duration);
}

void Move::run(Ns now) {
  double from = count_ == 0 ? 0.0 : distance(now);
  const double rest = std::max(0.0, length_ - from);
  const double peak = std::min(top_speed_, std::sqrt(acceleration_ * rest));
  const double ramp = peak / acceleration_;
  const double cruise = peak > 0.0 ? std::max(0.0, rest / peak - ramp) : 0.0;
  count_ = 0;
  end_ = now;
  is_braking_ = false;
  add(from, 0.0, acceleration_, ramp);
  add(from, peak, 0.0, cruise);
  add(from, peak, -acceleration_, ramp);
}

void Move::brake(Ns now, Ns reaction) {
  if (now + reaction >= end_) return; // it stands by then anyway
  const Ns begin = now + reaction;
  const double to_brake = seconds(now, begin);
  double from = distance(now);
  const double v = speed(now);
  const double v_brake = speed(begin);
  const double from_brake = distance(begin);
  count_ = 0;
  end_ = now;
  // The stretch up to the braking is kept by its end values; how it got there within 50 ms does not matter.
  const double mean = to_brake > 0.0 ? (from_brake - from) / to_brake : v;
  add(from, mean, 0.0, to_brake);
  from = from_brake;
  add(from, v_brake, -acceleration_, v_brake / acceleration_);
  is_braking_ = from < length_ - 1e-9;
}

const Move::Stretch& Move::stretch(Ns now) const noexcept {
  std::size_t i = 0;
  while (i + 1 < count_ && now >= stretches_[i + 1].begin) ++i;
  return stretches_[i];
}

double Move::distance(Ns now) const noexcept {
  if (now >= end_ && !is_braking_) return length_;
  const Stretch& part = stretch(now);
  const double t = std::clamp(seconds(part.begin, now), 0.0, part.seconds);
  return std::min(length_, part.from + part.speed * t + part.acceleration * t * t / 2.0);
}

double Move::speed(Ns now) const noexcept {
  if (now >= end_ || count_ == 0) return 0.0;
  const Stretch& part = stretch(now);
  const double t = std::clamp(seconds(part.begin, now), 0.0, part.seconds);
  return std::max(0.0, part.speed + part.acceleration * t);
}

std::int64_t Move::steps_done(Ns now) const noexcept {
  if (steps_ == 0 || length_ <= 0.0) return steps_;
  constexpr double kRounding = 1e-6; // of a step
  return std::min(steps_, static_cast<std::int64_t>(distance(now) / length_ * static_cast<double>(steps_) + kRounding));
}

Steps Move::at_step(std::int64_t step) const noexcept {
  if (steps_ == 0) return to_;
  Steps out{};
  for (std::size_t axis = 0; axis < out.size(); ++axis) {
    const double part = static_cast<double>(to_[axis] - from_[axis]) * static_cast<double>(step) / static_cast<double>(steps_);
    out[axis] = from_[axis] + std::llround(part);
  }
  return out;
}

Steps Move::at(Ns now) const noexcept {
  return count_ == 0 ? from_ : at_step(steps_done(now));
}

Ns Move::time_of(std::int64_t step) const noexcept {
  const double wanted = length_ * static_cast<double>(step) / static_cast<double>(std::max<std::int64_t>(steps_, 1));
  for (std::size_t i = 0; i < count_; ++i) {
    const Stretch& part = stretches_[i];
    const double t = part.seconds;
    const double end = part.from + part.speed * t + part.acceleration * t * t / 2.0;
    if (wanted > end + 1e-9) continue;
    const double away = std::max(0.0, wanted - part.from);
    // away = v t + a t t / 2, the earlier solution
    const double root = std::sqrt(std::max(0.0, part.speed * part.speed + 2.0 * part.acceleration * away));
    const double denominator = part.speed + root;
    return after(part.begin, denominator > 0.0 ? std::min(t, 2.0 * away / denominator) : 0.0);
  }
  return kNever;
}

} // namespace scansion::sim::grbl
