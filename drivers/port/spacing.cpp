// Where a profile stands along the way of the sensor.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/port/spacing.hpp"

namespace scansion {

std::span<const Option> spacing_rows() noexcept {
  static const Option rows[] = {
      {.key = "spacing",
       .type = OptionType::number,
       .meaning = "mm from line to line; without any other word about it 1",
       .min = -1e6,
       .max = 1e6,
       .example = "0.5"},
      {.key = "speed",
       .type = OptionType::number,
       .meaning = "mm/s at which sensor or part moves; lines stand where the device's clock puts them",
       .min = -1e6,
       .max = 1e6,
       .example = "25.0",
       .alternative = true},
      {.key = "encoder",
       .type = OptionType::number,
       .meaning = "mm for each count of the device's encoder",
       .min = -1e6,
       .max = 1e6,
       .example = "0.01",
       .alternative = true},
  };
  return rows;
}

Result<LineSpacing> LineSpacing::create(const OptionValues& values) {
  LineSpacing out;
  int given = 0;
  const auto take = [&](std::string_view key, By by) {
    const auto value = values.get<double>(key);
    if (!value) return;
    ++given;
    out.by_ = by;
    out.factor_ = *value;
  };
  take("spacing", By::step);
  take("speed", By::speed);
  take("encoder", By::encoder);
  if (given > 1) return fail(Errc::config, "more than one of spacing, speed and encoder is given; keep one");
  return out;
}

} // namespace scansion
