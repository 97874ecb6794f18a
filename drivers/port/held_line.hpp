// A line that waits while the gap before it is handed out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/port/decoder.hpp"

#include <utility>

namespace scansion {

/// For decoders that learn of missing lines from the line behind them.
class HeldLine {
public:
  [[nodiscard]] LineBuffer& buffer() noexcept { return line_; }
  [[nodiscard]] bool is_ready() const noexcept { return is_ready_; }
  /// The buffer is filled; the next step is this line, unless a gap is told first.
  void ready() noexcept { is_ready_ = true; }
  void drop() noexcept { is_ready_ = false; }

  /// Hands the line out.
  [[nodiscard]] Decoder::Step give(Decoder::Step step, LineBuffer& line) noexcept {
    is_ready_ = false;
    std::swap(line, line_);
    step.what = Decoded::line;
    return step;
  }
  /// Tells of `missing` lines (empty: unknown) before it.
  [[nodiscard]] static Decoder::Step tell(Decoder::Step step, Gap& gap, std::optional<std::uint64_t> missing,
                                          std::string_view reason) {
    gap.count = missing;
    gap.reason = reason;
    step.what = Decoded::gap;
    return step;
  }

private:
  LineBuffer line_;
  bool is_ready_ = false;
};

} // namespace scansion
