// A Gocator profiler that runs: a stamp and a profile for each frame on its data channel. drivers/lmi-gocator/README.md has the
// bytes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/lmi-gocator/gdp.hpp"
#include "sim/device/device_model.hpp"
#include "sim/player/line_source.hpp"

#include <optional>

namespace scansion {

struct GocatorPlan {
  double rate = 500.0;               ///< frames per second
  bool at_maximum = false;           ///< as fast as the host reads; the clock then counts frames at `rate`
  bool is_uniform = false;           ///< profiles at even x
  std::optional<std::uint32_t> x_nm; ///< scales; empty: the finest round ones that hold the scan
  std::optional<std::uint32_t> z_nm;
  std::int64_t encoder_step = 10; ///< counts a frame
  std::uint32_t sources = 1;      ///< profiles in each group
  std::uint64_t first_frame = 0;
};

/// The part arrives with the first host. From then on it moves at its rate, whether a host is there or not.
class GocatorDevice final : public DeviceModel {
public:
  GocatorDevice(LineSource source, const GocatorPlan& plan);

  void receive(std::span<const std::uint8_t> /*bytes*/, std::int64_t /*now_ns*/) override {} // the data channel is one way
  bool send(std::int64_t now_ns, std::vector<std::uint8_t>& out) override;
  std::int64_t next_at() const override;
  void connected(std::int64_t now_ns) override;
  void disconnected(std::int64_t /*now_ns*/) override { has_host_ = false; }
  void power_up(std::int64_t now_ns) override;
  /// Kinds: restart, the sensor is stopped and started: frames count from 0 again.
  Result<void> fault(const DeviceFault& fault, bool starts, std::int64_t now_ns) override;

private:
  void choose_scales();
  [[nodiscard]] std::int64_t period_ns() const noexcept;
  [[nodiscard]] bool is_running() const noexcept { return has_started_ && !is_done_ && (has_host_ || !plan_.at_maximum); }
  void append_stamp(std::vector<std::uint8_t>& out, std::int64_t now_ns) const;
  void append_profile(std::vector<std::uint8_t>& out, std::uint8_t source, bool is_last) const;
  void measure_points();
  void measure_columns();

  LineSource source_;
  const GocatorPlan plan_;
  gdp::Profile scales_;
  PlayedLine line_;
  std::vector<std::int16_t> samples_; ///< x and z, or z alone
  std::vector<double> nearest_;       ///< mm from its column's middle, of each sample of a uniform profile
  std::uint64_t frame_ = 0;
  std::uint64_t line_number_ = 0; ///< of the part
  std::int64_t power_up_ns_ = 0;
  std::int64_t next_ns_ = 0;
  bool has_host_ = false;
  bool has_started_ = false;
  bool is_done_ = false;
};

} // namespace scansion
