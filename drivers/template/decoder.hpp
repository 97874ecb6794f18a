// The decoder of the example device; README.md draws its bytes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/port/held_line.hpp"
#include "drivers/port/text_lines.hpp"

namespace scansion {

/// Memory: one line of text of at most kMaxText bytes.
class TemplateDecoder final : public Decoder {
public:
  static constexpr std::size_t kMaxText = std::size_t{64} << 10U;

  explicit TemplateDecoder(LinkCounters& counters) : counters_(counters), text_(kMaxText, counters) {}

  Step decode(std::span<const std::uint8_t> bytes, const Moment& at, LineBuffer& line, Gap& gap) override;
  void reset() override {
    text_.reset();
    next_index_.reset();
    held_.drop();
  }

private:
  [[nodiscard]] bool take_profile(std::string_view text);

  LinkCounters& counters_;
  TextLines text_;
  HeldLine held_;           ///< the newest profile
  std::uint64_t index_ = 0; ///< of the newest profile
  std::optional<std::uint64_t> next_index_;
};

} // namespace scansion
