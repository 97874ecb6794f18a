// A SCIP 2 line scanner: commands in, replies and scan messages out. The rules are those of Hokuyo's specification of SCIP 2.0.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/device/device_model.hpp"
#include "sim/device/scip/scip_scan.hpp"
#include "sim/scene/random.hpp"

#include <deque>

namespace scansion {

struct ScipPlan {
  ScipModel model;
  double standoff_mm = 300.0;       ///< from the highest point of the part to the sensor
  std::optional<double> rate;       ///< scans per second instead of the model's
  bool at_maximum = false;          ///< as fast as the host reads; the device's clock then counts scans
  std::int64_t clock_ms = 0;        ///< its time at power-up
  double drift_ppm = 0.0;           ///< its clock is this much too fast
  double jitter_ms = 0.0;           ///< by which scans come late at most
  double warm_up_s = 0.0;           ///< the laser cannot be lit for this long
  bool starts_in_scip1 = false;     ///< until SCIP2.0 is sent
  bool starts_streaming = false;    ///< as a sensor whose host died
  bool stops_on_disconnect = false; ///< TCP
  bool is_single_only = false;      ///< knows no continuous measuring
  std::int32_t baud = 19200;        ///< bit/s at power-up, for SS; the bytes themselves come at any rate
  std::uint64_t seed = 1;
};

class ScipDevice final : public DeviceModel {
public:
  ScipDevice(LineSource source, ScipPlan plan);

  void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  bool send(std::int64_t now_ns, std::vector<std::uint8_t>& out) override;
  std::int64_t next_at() const override;
  bool drops_link() override { return replies_.empty() && std::exchange(drops_link_, false); }
  void disconnected(std::int64_t now_ns) override;
  void power_up(std::int64_t now_ns) override;
  /// Kinds: badsum (rate: share of messages), status (code: that status instead of data), clockjump (ms).
  Result<void> fault(const DeviceFault& fault, bool starts, std::int64_t now_ns) override;

private:
  /// A measuring in progress.
  struct Measuring {
    std::string head; ///< echo up to the remaining count
    std::string tail; ///< and behind it: the tag
    char kind = 'D';  ///< D, S or E
    bool has_echoes = false;
    std::int32_t start = 0, end = 0, cluster = 1, skip = 0;
    std::int32_t remaining = 0; ///< 0 and is_endless: for ever
    bool is_endless = false;
    std::int64_t next_ns = 0; ///< when the next message is complete
    std::int64_t late_ns = 0; ///< of that, jitter
  };

  void take_request(const std::string& request, std::int64_t now_ns);
  [[nodiscard]] bool take_plain(std::string_view symbol, const std::string& request, std::int64_t now_ns);
  void take_measuring(const std::string& request, std::string_view body, std::string_view tag, std::int64_t now_ns);
  void take_clock(const std::string& request, std::string_view body, std::int64_t now_ns);
  void take_setting(const std::string& request, std::string_view symbol, std::string_view body);
  void take_light(const std::string& request, std::int64_t now_ns);
  void take_reboot(const std::string& request, std::int64_t now_ns);
  /// Two characters, empty: as it should be.
  [[nodiscard]] std::string_view parse_measuring(std::string_view body, Measuring& out) const;

  void reply(const std::string& request, std::string_view status, std::string_view body = {});
  void reply_keys(const std::string& request, const std::vector<std::pair<std::string, std::string>>& rows);
  void append_sample(const Measuring& measuring, const ScipSample& sample);
  void append_scan(std::string& text, const Measuring& measuring, std::int64_t scan_ns);
  void append_block(std::string& text, std::string_view data) const;
  [[nodiscard]] bool scan_message(std::int64_t now_ns, std::string& text);
  void put_out_light();

  [[nodiscard]] std::int64_t period_ns() const noexcept;
  /// Its 24-bit clock at `now_ns`.
  [[nodiscard]] std::uint32_t clock_at(std::int64_t now_ns) const noexcept;
  [[nodiscard]] std::string state_code() const;
  /// The next line of the part, false when there is none left.
  [[nodiscard]] bool look(std::int64_t now_ns);
  /// The newest scan for who asks for one; false: there is none.
  [[nodiscard]] bool look_once(std::int64_t now_ns);

  LineSource source_;
  ScipPlan plan_;
  ScipPlace place_;
  Random random_;
  std::string input_;
  std::deque<std::string> replies_;
  std::string message_;
  std::string data_;
  PlayedLine line_;
  std::vector<ScipSample> samples_;
  std::optional<Measuring> measuring_;
  std::int64_t power_up_ns_ = 0;
  std::int64_t clock_offset_ms_ = 0;
  std::int64_t scans_ = 0;         ///< since power-up, for the clock at maximum rate
  std::int64_t last_look_ns_ = -1; ///< for single scans
  std::int64_t reboot_asked_ns_ = -1;
  bool is_lit_ = false;
  bool is_in_clock_mode_ = false;
  bool is_in_scip1_ = false;
  bool was_return_ = false; ///< the newest byte from the host: a line feed behind it ends nothing more
  std::int32_t baud_ = 0;
  bool sleeps_ = false;
  bool drops_link_ = false;
  bool is_streaming_from_before_ = false;
  double bad_sums_ = 0.0; ///< share of messages
  int status_fault_ = 0;  ///< sent instead of data; 0: none
};

} // namespace scansion
