// Bytes to lines of text: for decoders of protocols whose frames end with a line feed.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/port/link_counters.hpp"

#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace scansion {

/// Holds at most `bound` bytes. A longer line is counted once as overlong and skipped to its line feed.
class TextLines {
public:
  TextLines(std::size_t bound, LinkCounters& counters) : bound_(bound), counters_(counters) { held_.reserve(bound); }

  /// The next line without its line feed (and carriage return); empty: `bytes` are used up. `used` grows by what was taken. The
  /// line is valid until the next call.
  [[nodiscard]] std::optional<std::string_view> next(std::span<const std::uint8_t> bytes, std::size_t& used) {
    if (is_given_) held_.clear();
    is_given_ = false;
    const auto rest = bytes.subspan(used);
    const void* at = rest.empty() ? nullptr : std::memchr(rest.data(), '\n', rest.size());
    const std::size_t part =
        at == nullptr ? rest.size() : static_cast<std::size_t>(static_cast<const std::uint8_t*>(at) - rest.data());
    hold(rest.first(part));
    used += part;
    if (at == nullptr) return std::nullopt;
    ++used;
    if (is_skipping_) {
      is_skipping_ = false;
      return next(bytes, used);
    }
    is_given_ = true;
    std::string_view line = held_;
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }
  /// What stands behind the last line feed, as if one followed; empty: nothing. The next call of next() begins anew.
  [[nodiscard]] std::string_view rest() noexcept {
    if (is_given_) held_.clear();
    is_given_ = true;
    is_skipping_ = false;
    return held_;
  }
  void reset() noexcept {
    held_.clear();
    is_given_ = is_skipping_ = false;
  }

private:
  void hold(std::span<const std::uint8_t> part) {
    if (is_skipping_) return;
    if (held_.size() + part.size() <= bound_) {
      held_.append(reinterpret_cast<const char*>(part.data()), part.size());
      return;
    }
    counters_.reject(Reject::overlong);
    held_.clear();
    is_skipping_ = true;
  }

  const std::size_t bound_;
  LinkCounters& counters_;
  std::string held_;
  bool is_given_ = false;    ///< held_ was handed out
  bool is_skipping_ = false; ///< the rest of an overlong line
};

} // namespace scansion
