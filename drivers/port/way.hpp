// The place of lines along the way of the sensor, kept over losses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/port/spacing.hpp"

#include <optional>

namespace scansion {

/// What a device says of a line, each counted from where it likes.
struct WayReading {
  std::uint64_t lines = 0; ///< lost ones too
  std::int64_t time_ns = 0;
  std::int64_t encoder = 0;
};

/// The first line stands at 0. A device that goes on counting after a loss keeps its place by itself; for one that counts anew
/// go_on() says how far the way went meanwhile. Thread-bound.
class Way {
public:
  explicit Way(LineSpacing spacing = {}) noexcept : spacing_(spacing) {}

  /// mm of the line with this reading.
  [[nodiscard]] double at(const WayReading& reading) noexcept {
    if (!origin_) origin_ = reading;
    // Differences without a sign are right over a wrap, too.
    const auto since = [](std::int64_t now, std::int64_t then) {
      return static_cast<std::int64_t>(static_cast<std::uint64_t>(now) - static_cast<std::uint64_t>(then));
    };
    newest_mm_ = base_mm_ + spacing_.way_mm(reading.lines - origin_->lines, since(reading.time_ns, origin_->time_ns),
                                            since(reading.encoder, origin_->encoder));
    return newest_mm_;
  }
  /// The next reading is of a line that is `lines` lines and `time_ns` behind the newest one, whatever it reads. How far an
  /// encoder went meanwhile cannot be known then: it goes on where it was.
  void go_on(std::uint64_t lines, std::int64_t time_ns) noexcept {
    if (!origin_) return;
    base_mm_ = newest_mm_ + spacing_.way_mm(lines, time_ns, 0);
    origin_.reset();
  }
  /// The next line stands at 0.
  void begin_anew() noexcept { *this = Way(spacing_); }

private:
  LineSpacing spacing_;
  std::optional<WayReading> origin_; ///< reads 0 at base_mm_
  double base_mm_ = 0.0, newest_mm_ = 0.0;
};

} // namespace scansion
