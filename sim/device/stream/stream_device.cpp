// A digitizer that sends points as rows of text or records of fixed length.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/stream/stream_device.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>

namespace scansion {

using stream::Role;

std::int64_t StreamDevice::period_ns() const noexcept {
  return std::max<std::int64_t>(1, std::llround(1e9 / plan_.rate));
}

bool StreamDevice::is_running() const noexcept {
  return has_started_ && !is_done_ && (has_host_ || !knows_its_host_ || !plan_.at_maximum);
}

void StreamDevice::connected(std::int64_t now_ns) {
  has_host_ = true;
  if (plan_.is_asked && !was_asked_) return;
  if (!std::exchange(has_started_, true)) next_ns_ = now_ns;
}

void StreamDevice::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (bytes.empty()) return;
  was_asked_ = true;
  connected(now_ns);
}

Result<void> StreamDevice::fault(const DeviceFault& fault, bool /*starts*/, std::int64_t /*now_ns*/) {
  return fail(Errc::usage, "--fault ", fault.kind, ": a stream knows no such fault; see scansim(1) for those of the port");
}

std::int64_t StreamDevice::next_at() const {
  if (!is_running()) return kNoTime;
  return plan_.at_maximum ? 0 : next_ns_;
}

double StreamDevice::value_of(const stream::Field& field, const PlayedPoint& point, bool is_bad) const {
  const auto scaled = [&](double value) { return value / field.scale.value(); };
  switch (field.role) {
    case Role::x: return scaled(point.x);
    case Role::y: return scaled(point.y);
    case Role::z: return scaled(point.z);
    case Role::time: return scaled(static_cast<double>(number_) * static_cast<double>(period_ns()) * 1e-9);
    case Role::line: return static_cast<double>(number_);
    case Role::encoder: return static_cast<double>(number_) * 10.0;
    case Role::bad: return is_bad ? 1.0 : 0.0;
    case Role::ignored:
    case Role::literal: break;
  }
  return 0.0;
}

void StreamDevice::append_row(const PlayedPoint& point, bool is_bad, std::vector<std::uint8_t>& out) {
  row_.clear();
  for (const stream::Field& field : plan_.fields) {
    if (!row_.empty()) row_ += ' ';
    if (field.role == Role::literal) {
      row_ += field.text;
      continue;
    }
    const bool counts = field.role == Role::line || field.role == Role::encoder || field.role == Role::bad;
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", counts ? 0 : plan_.decimals, value_of(field, point, is_bad));
    row_ += text;
  }
  if (plan_.sum != stream::Checksum::none) {
    const std::string_view summed = std::string_view(row_).substr(std::min(plan_.sum_from, row_.size()));
    char text[16];
    std::snprintf(text, sizeof text, "*%0*X", static_cast<int>(2 * bytes_of(plan_.sum)),
                  checksum(plan_.sum, {reinterpret_cast<const std::uint8_t*>(summed.data()), summed.size()}));
    row_ += text;
  }
  row_ += "\r\n";
  out.insert(out.end(), row_.begin(), row_.end());
}

void StreamDevice::append_record(const PlayedPoint& point, bool is_bad, std::vector<std::uint8_t>& out) {
  const std::size_t begin = out.size();
  const auto put = [&](std::uint64_t bits, std::size_t bytes, bool is_big_endian) {
    for (std::size_t i = 0; i < bytes; ++i) {
      out.push_back(static_cast<std::uint8_t>(bits >> (8U * (is_big_endian ? bytes - 1U - i : i))));
    }
  };
  out.insert(out.end(), plan_.sync.begin(), plan_.sync.end());
  for (const stream::Field& field : plan_.fields) {
    const double value = value_of(field, point, is_bad);
    std::uint64_t bits = static_cast<std::uint64_t>(std::llround(value));
    if (field.storage.is_float && field.storage.bytes == 4) bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
    if (field.storage.is_float && field.storage.bytes == 8) bits = std::bit_cast<std::uint64_t>(value);
    put(bits, field.storage.bytes, field.storage.is_big_endian);
  }
  const std::span<const std::uint8_t> record = std::span<const std::uint8_t>(out).subspan(begin);
  put(checksum(plan_.sum, record.subspan(plan_.sum_from)), bytes_of(plan_.sum), plan_.is_sum_big_endian);
}

bool StreamDevice::send(std::int64_t now_ns, std::vector<std::uint8_t>& out) {
  if (!knows_its_host_ && !has_started_) connected(now_ns); // a serial line tells of no host
  if (!is_running() || (!plan_.at_maximum && now_ns < next_ns_)) return false;
  auto more = source_.next(line_);
  if (!more || !more.assume_value()) {
    is_done_ = true;
    return false;
  }
  if (number_ == 0) out.insert(out.end(), plan_.head.begin(), plan_.head.end());
  const bool tells_bad = has(plan_.fields, Role::bad);
  const auto append = [&](const PlayedPoint& point, bool is_bad) {
    if (plan_.is_binary)
      append_record(point, is_bad, out);
    else
      append_row(point, is_bad, out);
  };
  for (std::size_t i = 0; i < line_.size(); ++i) {
    if (i > 0 && line_[i].starts_run && tells_bad) append(line_[i], true);
    append(line_[i], false);
  }
  const std::string end = plan_.is_binary ? "" : !plan_.mark.empty() ? plan_.mark + "\r\n" : plan_.has_blank ? "\r\n" : "";
  out.insert(out.end(), end.begin(), end.end());
  ++number_;
  next_ns_ += period_ns();
  return true;
}

} // namespace scansion
