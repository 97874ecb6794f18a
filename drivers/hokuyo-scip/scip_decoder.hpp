// The decoder of SCIP 2: messages cut out of the bytes, sums checked, scans made into lines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/hokuyo-scip/scan_geometry.hpp"
#include "drivers/hokuyo-scip/scip_frame.hpp"
#include "drivers/port/held_line.hpp"
#include "drivers/port/way.hpp"

namespace scansion {

/// Memory: one message of at most kMaxFrame bytes, one line.
class ScipDecoder final : public Decoder {
public:
  /// NE of 10,000 steps with three echoes each has about 206,300 bytes.
  static constexpr std::size_t kMaxFrame = std::size_t{256} << 10U;

  explicit ScipDecoder(LinkCounters& counters, LineSpacing spacing = {}) : counters_(counters), way_(spacing) {
    frame_.reserve(kMaxFrame);
  }

  Step decode(std::span<const std::uint8_t> bytes, const Moment& at, LineBuffer& line, Gap& gap) override;
  void reset() override;

  /// What is expected from now on. `head`: the request up to its count, if it has one; `tail`: ';' and the tag.
  struct Expected {
    std::string head, tail;
    scip::Sensor sensor;
    scip::ScanPlan plan;
    std::optional<double> gap_mm;
    bool kept_clock = false; ///< the sensor's clock went on since the run before
  };
  void expect(Expected expected);

  /// The reply that was decoded last; valid until the next call of decode().
  [[nodiscard]] const scip::Frame& reply() const noexcept { return reply_; }
  /// Whether it is the echo of the request in force, whatever its count.
  [[nodiscard]] bool is_expected(std::string_view echo) const noexcept;
  std::optional<std::uint64_t> lost_while_away() const noexcept override { return lost_while_away_; }

private:
  enum class Taken : std::uint8_t { nothing, line, reply };

  /// True when a whole message is in frame_.
  [[nodiscard]] bool collect(std::span<const std::uint8_t> bytes, std::size_t& used);
  [[nodiscard]] Taken take_frame(std::string_view text);
  [[nodiscard]] bool is_scan(const scip::Frame& frame) const noexcept;
  [[nodiscard]] Taken take_scan(const scip::Frame& frame);
  [[nodiscard]] Taken refuse(Reject cause) noexcept;
  /// Fills values_ from data_; empty: done.
  [[nodiscard]] std::optional<Reject> take_values();
  [[nodiscard]] std::optional<std::int32_t> take_step(std::string_view& data) const;
  [[nodiscard]] bool is_repeated(std::int64_t stamp_ms) const noexcept;
  [[nodiscard]] bool is_distance(std::int32_t distance) const noexcept;
  void fill_line();
  /// How many scans are missing before the newest one; empty: its clock was set anew.
  [[nodiscard]] std::optional<std::uint64_t> take_clock(std::int64_t stamp_ms, const Moment& at);
  void take_first_clock(std::int64_t stamp_ms, const std::optional<Moment>& before, const Moment& at);
  void place_line();

  LinkCounters& counters_;
  std::string frame_;        ///< bytes of the message that is coming in
  bool is_whole_ = false;    ///< frame_ was handed out
  bool is_skipping_ = false; ///< an overlong message, up to its empty line
  bool refused_ = false;     ///< messages were refused since the newest line
  std::optional<Expected> expected_;
  scip::ScanGeometry geometry_;
  scip::Frame reply_;
  std::string data_;                 ///< characters of one scan
  std::vector<std::int32_t> values_; ///< its distances, mm or codes
  std::int64_t stamp_ms_ = 0;        ///< its 24-bit time
  HeldLine held_;
  Way way_;
  std::uint64_t number_ = 0;      ///< of the newest line, lost ones counted
  bool has_line_ = false;         ///< in this run
  std::int64_t clock_ms_ = 0;     ///< the 24-bit clock of the newest line without its wraps
  std::optional<Moment> line_at_; ///< of the newest line
  std::optional<std::uint64_t> lost_while_away_;
};

} // namespace scansion
