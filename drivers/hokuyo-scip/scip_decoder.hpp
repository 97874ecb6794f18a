// The decoder of SCIP 2: messages cut out of the bytes, sums checked, scans made into lines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/hokuyo-scip/scan_geometry.hpp"
#include "drivers/hokuyo-scip/scip_frame.hpp"
#include "drivers/port/decoder.hpp"

namespace scansion {

/// Memory: one message of at most kMaxFrame bytes, one line.
class ScipDecoder final : public Decoder {
public:
  /// ME of 10,000 steps has 60,940 bytes.
  static constexpr std::size_t kMaxFrame = std::size_t{64} << 10U;

  explicit ScipDecoder(LinkCounters& counters) : counters_(counters) { frame_.reserve(kMaxFrame); }

  Step decode(std::span<const std::uint8_t> bytes, const Moment& at, LineBuffer& line, Gap& gap) override;
  void reset() override;

  /// What is expected from now on. `head`: the request up to its count; `tail`: ';' and the tag.
  struct Expected {
    std::string head, tail;
    scip::Sensor sensor;
    scip::ScanPlan plan;
    LineSpacing spacing;
    std::optional<double> gap_mm;
  };
  void expect(Expected expected);

  /// The reply that was decoded last; valid until the next call of decode().
  [[nodiscard]] const scip::Frame& reply() const noexcept { return reply_; }
  /// Whether it is the echo of the request in force, whatever its count.
  [[nodiscard]] bool is_expected(std::string_view echo) const noexcept;
  /// The 24-bit clock of the newest line without its wraps, ms.
  [[nodiscard]] std::int64_t clock_ms() const noexcept { return clock_ms_; }

private:
  enum class Taken : std::uint8_t { nothing, line, reply };

  /// True when a whole message is in frame_.
  [[nodiscard]] bool collect(std::span<const std::uint8_t> bytes, std::size_t& used);
  [[nodiscard]] Taken take_frame(std::string_view text);
  [[nodiscard]] Taken take_scan(const scip::Frame& frame);
  [[nodiscard]] Taken refuse(Reject cause) noexcept;
  [[nodiscard]] bool take_values(std::string_view body);
  void fill_line();
  /// How many scans are missing before the newest one; empty: its clock was set anew.
  [[nodiscard]] std::optional<std::uint64_t> take_clock(std::int64_t stamp_ms, const Moment& at);

  LinkCounters& counters_;
  std::string frame_;         ///< bytes of the message that is coming in
  bool is_whole_ = false;     ///< frame_ was handed out
  bool is_skipping_ = false;  ///< an overlong message, up to its empty line
  bool is_line_held_ = false; ///< held_ waits until the gap before it was handed out
  bool refused_ = false;      ///< messages were refused since the newest line
  std::optional<Expected> expected_;
  scip::ScanGeometry geometry_;
  scip::Frame reply_;
  std::string data_;                 ///< characters of one scan
  std::vector<std::int32_t> values_; ///< its distances, mm or codes
  std::int64_t stamp_ms_ = 0;        ///< its 24-bit time
  LineBuffer held_;
  std::uint64_t number_ = 0; ///< of the newest line in this run, lost ones counted
  bool has_line_ = false;
  std::int64_t clock_ms_ = 0, first_clock_ms_ = 0;
  Moment line_at_;
};

} // namespace scansion
