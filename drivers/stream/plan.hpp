// How a stream is described: the keys of a stream device.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/option.hpp"
#include "drivers/port/spacing.hpp"
#include "drivers/stream/checksum.hpp"
#include "drivers/stream/field.hpp"

namespace scansion::stream {

enum class Break : std::uint8_t {
  field,    ///< the field `line` changes
  blank,    ///< a row without a text
  mark,     ///< a row that is the mark
  reversal, ///< the way along an axis turns round
  pause,    ///< nothing comes for a while
  points    ///< a number of records
};

struct Plan {
  bool is_binary = false;
  std::vector<Field> fields;
  Unit unit = Unit::mm;
  Rational resolution{1, 1000}; ///< units in a count
  std::optional<double> gap_mm;
  Break line_break = Break::blank;
  std::string mark;
  std::size_t axis = 0;      ///< of the reversal
  std::int64_t turn = 1;     ///< counts back that make a reversal
  std::int64_t pause_ns = 0; ///< 0: no pause ends a line
  std::uint32_t points = 0;  ///< records in a line
  Checksum sum = Checksum::none;
  std::size_t sum_from = 0; ///< bytes of a record before the first one in its sum
  bool is_sum_big_endian = false;
  std::vector<std::uint8_t> sync; ///< bytes in front of every binary record
  std::string null;               ///< text of a coordinate without a value
  std::string comment;            ///< rows that begin so are passed over
  std::string start, stop;        ///< sent to the device
  LineSpacing spacing;

  [[nodiscard]] std::size_t record_bytes() const noexcept { return sync.size() + bytes_of(fields) + bytes_of(sum); }
};

/// Bytes as pairs of hex digits; spaces may part them. The context of its error is the reason.
[[nodiscard]] Result<std::vector<std::uint8_t>> parse_sync(std::string_view text);
/// The keys without those of the port.
[[nodiscard]] std::span<const Option> rows() noexcept;
/// Fails with config; the context names key, reason and fix.
[[nodiscard]] Result<Plan> make_plan(const OptionValues& values);

} // namespace scansion::stream
