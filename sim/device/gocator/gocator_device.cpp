// A Gocator profiler that runs.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/gocator/gocator_device.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scansion {
namespace {

constexpr double kMostSteps = 32000.0; ///< from the middle of the field; the rest of 16 bits is margin
constexpr std::uint32_t kExposureNs = 100'000;
constexpr std::int32_t kProfileStep = 2; ///< the stream step of the sensor's own profiles

/// The smallest of 1, 2, 5, 10 ... um with which half of `span_mm` is at most kMostSteps.
std::uint32_t round_scale(double span_mm) {
  double nm = 1000.0;
  for (int turn = 0; span_mm / 2 * 1e6 > nm * kMostSteps && turn < 12; ++turn) nm *= turn % 3 == 1 ? 2.5 : 2.0;
  return static_cast<std::uint32_t>(nm);
}

/// The offset in um nearest to `mm` that a whole number of steps reaches, so that round coordinates stay round.
std::int32_t round_offset(double mm, std::uint32_t scale_nm) {
  const double step_um = std::max(1.0, scale_nm % 1000 == 0 ? scale_nm / 1000.0 : 1.0);
  return static_cast<std::int32_t>(std::llround(mm * 1000.0 / step_um) * std::llround(step_um));
}

std::int16_t sample(double mm, std::int32_t offset_um, std::uint32_t scale_nm) {
  const double steps = std::round((mm * 1e6 - offset_um * 1e3) / scale_nm);
  return std::abs(steps) < 32767.5 ? static_cast<std::int16_t>(steps) : gdp::kNull;
}

} // namespace

GocatorDevice::GocatorDevice(LineSource source, const GocatorPlan& plan) : source_(std::move(source)), plan_(plan) {
  choose_scales();
}

void GocatorDevice::choose_scales() {
  const PlayedBox& box = source_.box();
  const double span = box.max_along - box.min_along;
  scales_.type = plan_.is_uniform ? gdp::Type::uniform_profile : gdp::Type::point_cloud_profile;
  scales_.z_nm = plan_.z_nm.value_or(round_scale(box.max_z - box.min_z));
  scales_.z_um = round_offset((box.max_z + box.min_z) / 2, scales_.z_nm);
  if (!plan_.is_uniform) {
    scales_.x_nm = plan_.x_nm.value_or(round_scale(span));
    scales_.x_um = round_offset((box.max_along + box.min_along) / 2, scales_.x_nm);
    return;
  }
  const double steps = static_cast<double>(std::max<std::size_t>(box.most_points, 2) - 1);
  scales_.x_nm = plan_.x_nm.value_or(static_cast<std::uint32_t>(std::max(1.0, std::round(span * 1e6 / steps))));
  scales_.x_um = static_cast<std::int32_t>(std::llround(box.min_along * 1000.0));
  scales_.width = static_cast<std::uint32_t>(std::min(65536.0, std::floor(span * 1e6 / scales_.x_nm + 0.5) + 1.0));
}

std::int64_t GocatorDevice::period_ns() const noexcept {
  return std::max<std::int64_t>(1, std::llround(1e9 / plan_.rate));
}

void GocatorDevice::power_up(std::int64_t now_ns) {
  power_up_ns_ = next_ns_ = now_ns;
  frame_ = plan_.first_frame;
}

void GocatorDevice::connected(std::int64_t now_ns) {
  has_host_ = true;
  if (!std::exchange(has_started_, true)) next_ns_ = now_ns;
}

Result<void> GocatorDevice::fault(const DeviceFault& fault, bool starts, std::int64_t now_ns) {
  if (fault.kind != "restart") {
    return fail(Errc::usage, "--fault ", fault.kind, ": a Gocator knows no such fault; its own is restart");
  }
  if (starts) {
    power_up_ns_ = now_ns;
    frame_ = 0;
  }
  return success();
}

std::int64_t GocatorDevice::next_at() const {
  if (!is_running()) return kNoTime;
  return plan_.at_maximum ? 0 : next_ns_;
}

/// Samples at their own x. Between two runs stands one without a value.
void GocatorDevice::measure_points() {
  for (const PlayedPoint& point : line_) {
    if (point.starts_run && !samples_.empty()) samples_.insert(samples_.end(), 2, gdp::kNull);
    samples_.push_back(sample(source_.along(point), scales_.x_um, scales_.x_nm));
    samples_.push_back(sample(point.z, scales_.z_um, scales_.z_nm));
  }
}

/// Each column takes the point nearest to its middle, if there is one within half a step.
void GocatorDevice::measure_columns() {
  samples_.assign(scales_.width, gdp::kNull);
  nearest_.assign(scales_.width, std::numeric_limits<double>::infinity());
  for (const PlayedPoint& point : line_) {
    const double column = (source_.along(point) * 1e6 - scales_.x_um * 1e3) / scales_.x_nm;
    const double middle = std::round(column);
    if (!(middle >= 0.0) || !(middle < scales_.width)) continue;
    const auto at = static_cast<std::size_t>(middle);
    if (std::abs(column - middle) >= nearest_[at]) continue;
    nearest_[at] = std::abs(column - middle);
    samples_[at] = sample(point.z, scales_.z_um, scales_.z_nm);
  }
}

void GocatorDevice::append_stamp(std::vector<std::uint8_t>& out, std::int64_t now_ns) const {
  const std::int64_t since = plan_.at_maximum ? static_cast<std::int64_t>(frame_) * period_ns() : now_ns - power_up_ns_;
  gdp::put<std::uint32_t>(out, gdp::kStampHead + gdp::kStamp);
  gdp::put<std::uint16_t>(out, static_cast<std::uint16_t>(gdp::Type::stamp));
  gdp::put<std::uint32_t>(out, 1);
  gdp::put<std::uint16_t>(out, gdp::kStamp);
  gdp::put<std::uint16_t>(out, 0); // source and a reserved byte
  gdp::put<std::uint64_t>(out, frame_);
  gdp::put<std::uint64_t>(out, static_cast<std::uint64_t>(since / 1000));
  gdp::put<std::int64_t>(out, static_cast<std::int64_t>(line_number_) * plan_.encoder_step);
  gdp::put<std::int64_t>(out, 0);       // encoder at its index mark
  gdp::put<std::uint64_t>(out, 0);      // digital inputs
  gdp::put<std::uint32_t>(out, 10'000); // serial number
  gdp::put<std::uint32_t>(out, 0);
  gdp::put<std::uint64_t>(out, 0);
  gdp::put<std::uint64_t>(out, 0); // time by PTP
}

void GocatorDevice::append_profile(std::vector<std::uint8_t>& out, std::uint8_t source, bool is_last) const {
  const std::size_t axes = plan_.is_uniform ? 1 : 2;
  const std::size_t bytes = gdp::kAttributes + gdp::kCurrentAttributes + samples_.size() * sizeof(std::int16_t);
  gdp::put(out, static_cast<std::uint32_t>(bytes));
  gdp::put<std::uint16_t>(
      out, static_cast<std::uint16_t>(static_cast<std::uint16_t>(scales_.type) | (is_last ? gdp::kLastOfGroup : 0U)));
  gdp::put<std::uint16_t>(out, gdp::kCurrentAttributes);
  gdp::put<std::uint32_t>(out, 1);
  gdp::put(out, static_cast<std::uint32_t>(samples_.size() / axes));
  gdp::put(out, scales_.x_nm);
  gdp::put(out, scales_.z_nm);
  gdp::put(out, scales_.x_um);
  gdp::put(out, scales_.z_um);
  gdp::put(out, source);
  gdp::put(out, kExposureNs);
  gdp::put<std::uint16_t>(out, 0); // camera and a reserved byte
  gdp::put<std::uint8_t>(out, 0);
  gdp::put(out, kProfileStep);
  gdp::put<std::int32_t>(out, 0);  // identifier within the step
  gdp::put<std::int32_t>(out, -1); // not one of an array of outputs
  gdp::put<std::int32_t>(out, -1);
  for (const std::int16_t value : samples_) gdp::put(out, value);
}

bool GocatorDevice::send(std::int64_t now_ns, std::vector<std::uint8_t>& out) {
  if (!is_running() || (!plan_.at_maximum && now_ns < next_ns_)) return false;
  auto more = source_.next(line_);
  if (!more || !more.assume_value()) {
    is_done_ = true;
    return false;
  }
  samples_.clear();
  if (plan_.is_uniform)
    measure_columns();
  else
    measure_points();
  append_stamp(out, plan_.at_maximum ? now_ns : next_ns_);
  for (std::uint32_t i = 0; i < plan_.sources; ++i) append_profile(out, static_cast<std::uint8_t>(i), i + 1 == plan_.sources);
  ++frame_;
  ++line_number_;
  next_ns_ += period_ns();
  return true;
}

} // namespace scansion
