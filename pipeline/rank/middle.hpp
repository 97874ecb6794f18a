// Which point of an interval is closest to its middle: the rule that decides ties (see Ranker).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

namespace scansion {

class MiddleRule {
public:
  /// `position`: index of each point in its whole run, ascending; empty: 0, 1, 2, ...
  explicit MiddleRule(std::span<const std::uint32_t> position) noexcept : position_(position) {}

  /// How far index k is from the middle of the interval (a, b), doubled.
  [[nodiscard]] std::int64_t off_middle(std::size_t k, std::size_t a, std::size_t b) const noexcept {
    const std::int64_t twice = 2 * at(k) - (at(a) + at(b));
    return twice < 0 ? -twice : twice;
  }
  /// The inner point closest to the middle, the smaller index of two; a + 1 < b.
  [[nodiscard]] std::size_t middle(std::size_t a, std::size_t b) const noexcept {
    if (position_.empty()) return (a + b) / 2;
    const auto inner = position_.subspan(a + 1, b - a - 1);
    const auto upper = std::ranges::lower_bound(inner, (position_[a] + position_[b]) / 2);
    std::size_t k = a + 1 + static_cast<std::size_t>(upper - inner.begin());
    if (k == b) return b - 1;
    if (k > a + 1 && off_middle(k - 1, a, b) <= off_middle(k, a, b)) --k;
    return k;
  }

private:
  [[nodiscard]] std::int64_t at(std::size_t k) const noexcept {
    return position_.empty() ? static_cast<std::int64_t>(k) : static_cast<std::int64_t>(position_[k]);
  }
  std::span<const std::uint32_t> position_;
};

} // namespace scansion
