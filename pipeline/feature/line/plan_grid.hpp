// Places of lines in plan, found by squares.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace scansion {

/// Filled, closed, then asked. What is asked for lies within the side of a square.
class PlanGrid {
public:
  struct Item {
    std::uint32_t line = 0, place = 0;
  };

  explicit PlanGrid(double side) : side_(side) {}
  void add(double x, double y, Item item) { items_.push_back({cell(x), cell(y), item}); }
  void close() {
    std::stable_sort(items_.begin(), items_.end(), [](const Entry& a, const Entry& b) { return a.key() < b.key(); });
  }
  /// Calls `look` with each item in the nine squares around a place, and always in the same order.
  template <typename Look>
  void visit(double x, double y, const Look& look) const {
    const std::int64_t column = cell(x), row = cell(y);
    for (std::int64_t i = column - 1; i <= column + 1; ++i) {
      const auto least = std::pair(i, row - 1), most = std::pair(i, row + 1);
      auto at =
          std::lower_bound(items_.begin(), items_.end(), least, [](const Entry& e, const auto& key) { return e.key() < key; });
      for (; at != items_.end() && at->key() <= most; ++at) look(at->item);
    }
  }

private:
  struct Entry {
    std::int64_t x = 0, y = 0;
    Item item;
    [[nodiscard]] std::pair<std::int64_t, std::int64_t> key() const noexcept { return {x, y}; }
  };
  // Positions are whole counts below 2^50: their squares have numbers.
  [[nodiscard]] std::int64_t cell(double value) const noexcept {
    constexpr double kFarthest = 4e18;
    return static_cast<std::int64_t>(std::clamp(std::floor(value / side_), -kFarthest, kFarthest));
  }

  double side_;
  std::vector<Entry> items_;
};

} // namespace scansion
