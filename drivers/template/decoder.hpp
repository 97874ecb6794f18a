// The decoder of the example device; README.md draws its bytes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/port/decoder.hpp"
#include "drivers/port/text_lines.hpp"

namespace scansion {

/// Memory: one line of text of at most kMaxText bytes.
class TemplateDecoder final : public Decoder {
public:
  static constexpr std::size_t kMaxText = 64U * 1024U;

  explicit TemplateDecoder(LinkCounters& counters) : counters_(counters), text_(kMaxText, counters) {}

  Step decode(std::span<const std::uint8_t> bytes, const Moment& at, LineBuffer& line, Gap& gap) override;
  void reset() override {
    text_.reset();
    next_index_.reset();
    is_line_held_ = false;
  }

private:
  [[nodiscard]] bool take_profile(std::string_view text);

  LinkCounters& counters_;
  TextLines text_;
  LineBuffer held_;           ///< the newest profile
  bool is_line_held_ = false; ///< it waits until the gap before it was handed out
  std::uint64_t index_ = 0;   ///< of the newest profile
  std::optional<std::uint64_t> next_index_;
};

} // namespace scansion
