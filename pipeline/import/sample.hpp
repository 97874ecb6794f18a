// The stream of samples that every input format is read into.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/number.hpp"
#include "pipeline/model/result.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace scansion {

enum class SampleKind : std::uint8_t {
  point,
  invalid, ///< NaN and the like: splits a run
  missing, ///< an empty cell of a range grid: does not
  line_end ///< of a scan line; without a sample since the last one it means nothing
};

struct Sample {
  std::array<Number, 3> xyz;
  std::uint64_t place = 0; ///< row or vertex, for SampleReader::where
  SampleKind kind = SampleKind::point;
};

/// Reads one member of the input. Thread-bound.
class SampleReader {
public:
  SampleReader() = default;
  SampleReader(const SampleReader&) = delete;
  SampleReader& operator=(const SampleReader&) = delete;
  virtual ~SampleReader() = default;

  /// The next samples; how many, 0 only at the end of the member (its last line needs no line_end).
  [[nodiscard]] virtual Result<std::size_t> read(std::span<Sample> out) = 0;
  /// "file:row" of a sample.
  [[nodiscard]] virtual std::string where(std::uint64_t place) const = 0;
  /// Bytes of the member read so far.
  [[nodiscard]] virtual std::uint64_t position() const noexcept = 0;
  /// The input states no y: whoever takes the samples puts line number * spacing there.
  [[nodiscard]] virtual bool without_y() const noexcept { return false; }
  /// Text of three columns without a heading: the third may be a label (see ColumnGuess).
  [[nodiscard]] virtual bool third_may_be_label() const noexcept { return false; }
};

} // namespace scansion
