// A digitizer that sends points as rows of text or records of fixed length, one scan line a message.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/stream/checksum.hpp"
#include "drivers/stream/field.hpp"
#include "sim/device/device_model.hpp"
#include "sim/player/line_source.hpp"

#include <optional>

namespace scansion {

struct StreamPlan {
  double rate = 50.0;      ///< lines per second
  bool at_maximum = false; ///< as fast as the host reads; the clock then counts lines at `rate`
  bool is_binary = false;
  std::vector<stream::Field> fields;
  int decimals = 3; ///< of a number in text
  stream::Checksum sum = stream::Checksum::none;
  std::size_t sum_from = 0;
  bool is_sum_big_endian = false;
  std::vector<std::uint8_t> sync;
  bool has_blank = true; ///< a blank row behind each line of text
  std::string mark;      ///< this row behind each line instead
  std::string head;      ///< text before everything else
  bool is_asked = false; ///< begins when the host has sent something
};

/// The part arrives with the first host, or at once on a serial line, which tells of none. From then on it moves at its rate.
class StreamDevice final : public DeviceModel {
public:
  StreamDevice(LineSource source, StreamPlan plan, bool knows_its_host)
      : source_(std::move(source)), plan_(std::move(plan)), knows_its_host_(knows_its_host) {}

  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  bool send(std::int64_t now_ns, std::vector<std::uint8_t>& out) override;
  std::int64_t next_at() const override;
  void connected(std::int64_t now_ns) override;
  void disconnected(std::int64_t /*now_ns*/) override { has_host_ = false; }
  void power_up(std::int64_t now_ns) override { next_ns_ = now_ns; }
  /// Knows no faults of its own.
  Result<void> fault(const DeviceFault& fault, bool starts, std::int64_t now_ns) override;

private:
  [[nodiscard]] std::int64_t period_ns() const noexcept;
  [[nodiscard]] bool is_running() const noexcept;
  /// What a field says of a point, in the field's own counts.
  [[nodiscard]] double value_of(const stream::Field& field, const PlayedPoint& point, bool is_bad) const;
  void append_row(const PlayedPoint& point, bool is_bad, std::vector<std::uint8_t>& out);
  void append_record(const PlayedPoint& point, bool is_bad, std::vector<std::uint8_t>& out);

  LineSource source_;
  const StreamPlan plan_;
  const bool knows_its_host_;
  PlayedLine line_;
  std::string row_;
  std::uint64_t number_ = 0; ///< of line_
  std::int64_t next_ns_ = 0;
  bool has_host_ = false;
  bool has_started_ = false;
  bool was_asked_ = false;
  bool is_done_ = false;
};

} // namespace scansion
