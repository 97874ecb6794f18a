// The decoder of described streams: records to scan lines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/port/decoder.hpp"
#include "drivers/port/text_lines.hpp"
#include "drivers/port/way.hpp"
#include "drivers/stream/record.hpp"

namespace scansion::stream {

/// Memory: one row or record, and two lines of at most kMostPoints points. A longer line goes on in the next one.
///
/// With pause_ms the moments of arrival part lines, too: then, and only then, the lines depend on `at`.
class StreamDecoder final : public Decoder {
public:
  static constexpr std::size_t kMaxRow = 4096;            ///< bytes
  static constexpr std::uint32_t kMostPoints = 1U << 20U; ///< in a line

  StreamDecoder(LinkCounters& counters, Plan plan, RecordReader reader);

  Step decode(std::span<const std::uint8_t> bytes, const Moment& at, LineBuffer& line, Gap& gap) override;
  void reset() override;
  void finish(const Moment& now, bool is_lost) override;

  /// Ends the line when `now` is a pause after its last byte. When to ask again; the largest number: not before bytes come.
  std::int64_t look_for_pause(const Moment& now);
  std::optional<std::uint64_t> lost_while_away() const noexcept override { return lost_while_away_; }
  /// Largest rounding error met, in counts.
  [[nodiscard]] double rounding() const noexcept { return reader_.rounding(); }

private:
  /// The next step towards a record; false: `bytes` are used up.
  [[nodiscard]] bool take_row(std::span<const std::uint8_t> bytes, std::size_t& used);
  [[nodiscard]] bool take_binary(std::span<const std::uint8_t> bytes, std::size_t& used);
  void read_row(std::string_view row);
  void lose(Reject cause);
  void lose_step(Reject cause);
  void take_record();
  void begin_line_at(std::int64_t number);
  void begin_run();
  void append();
  void follow_axis();
  void split_line(std::uint32_t keep);
  /// The line in work is over, as was known at `over`; that is its stamp. Nothing, if there is none.
  void close_line(const Moment& over);
  void close_after_pause();
  [[nodiscard]] std::int32_t way_counts();

  LinkCounters& counters_;
  const Plan plan_;
  RecordReader reader_;
  TextLines rows_;
  std::vector<std::uint8_t> held_; ///< of a binary record
  bool is_out_of_step_ = false;    ///< a binary record was no record; counted already
  std::uint64_t overlong_ = 0;     ///< rows seen as such
  Moment at_;                      ///< of the bytes in work
  Record record_;

  LineBuffer open_; ///< the line in work
  LineBuffer done_; ///< a line that is over
  LineBuffer spare_;
  bool is_done_ = false;
  bool is_over_ = false;      ///< no byte follows: open_ is over, too
  std::uint32_t invalid_ = 0; ///< samples since the last point of open_
  std::uint32_t records_ = 0; ///< of open_
  bool is_in_run_ = false;
  std::optional<Moment> last_at_; ///< of the newest record of open_
  std::optional<Gap> gap_;
  std::optional<std::int64_t> number_;        ///< what the field `line` says of open_
  bool is_away_ = false;                      ///< no record since reset()
  std::optional<std::int64_t> number_before_; ///< the newest number before reset()
  std::optional<std::uint64_t> lost_while_away_;

  int direction_ = 0;            ///< of the way along the axis
  std::int64_t turning_ = 0;     ///< farthest along the direction, counts
  std::uint32_t turning_at_ = 0; ///< its point

  std::uint64_t line_ = 0; ///< lines before open_, lost ones too, as far as they are known
  Way way_;
  std::optional<std::int64_t> time_; ///< of the newest record
  Moment record_at_;                 ///< when that came
  std::int32_t y_ = 0;               ///< of open_, when there is no field y
};

} // namespace scansion::stream
