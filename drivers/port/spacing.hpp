// Where a profile stands along the way of the sensor: a fixed step, a speed, or an encoder.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/option.hpp"
#include "pipeline/model/scan_line.hpp"

namespace scansion {

/// Rows for the keys spacing, speed and encoder.
[[nodiscard]] std::span<const Option> spacing_rows() noexcept;

/// Made from the keys; reentrant. The way is in mm from the first line of the run.
class LineSpacing {
public:
  /// Fails with config when more than one key is given.
  [[nodiscard]] static Result<LineSpacing> create(const OptionValues& values);

  /// `number` counts lines from the first of the run, lost ones too; `time_ns` and `encoder` are since that line.
  [[nodiscard]] double way_mm(std::uint64_t number, std::int64_t time_ns, std::int64_t encoder) const noexcept {
    switch (by_) {
      case By::step: return factor_ * static_cast<double>(number);
      case By::speed: return factor_ * static_cast<double>(time_ns) * 1e-9;
      case By::encoder: return factor_ * static_cast<double>(encoder);
    }
    return 0.0;
  }

private:
  enum class By : std::uint8_t { step, speed, encoder };
  By by_ = By::step;
  double factor_ = 1.0; ///< mm a line, mm a second, mm a count
};

} // namespace scansion
