// What lies where in plan: values in the order in which they came, found by rectangles.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace scansion {

/// A rectangle in plan, mm.
struct Box {
  double low_s = 1e300, high_s = -1e300, low_c = 1e300, high_c = -1e300;
  void add(double s, double c) noexcept {
    low_s = std::min(low_s, s);
    high_s = std::max(high_s, s);
    low_c = std::min(low_c, c);
    high_c = std::max(high_c, c);
  }
  void add(const Box& other) noexcept {
    add(other.low_s, other.low_c);
    add(other.high_s, other.high_c);
  }
  [[nodiscard]] bool is_near(const Box& other, double reach) const noexcept {
    return other.low_c <= high_c + reach && other.high_c >= low_c - reach && other.low_s <= high_s + reach &&
           other.high_s >= low_s - reach;
  }
};

/// Values that come one after the other mostly lie beside each other: blocks of them share a rectangle, and most blocks are far
/// from what is looked at. `T` has a member `box`. Thread-bound.
template <typename T>
class Nearby {
public:
  void add(const T& value) {
    if (blocks_.empty() || blocks_.back().values.size() == kBlock) blocks_.emplace_back().values.reserve(kBlock);
    blocks_.back().box.add(value.box);
    blocks_.back().values.push_back(value);
    ++size_;
  }
  /// Calls `look` with each value near the box, in the order in which they came.
  template <typename Look>
  void visit(const Box& box, double reach, const Look& look) const {
    for (const Block& block : blocks_) {
      if (!box.is_near(block.box, reach)) continue;
      for (const T& value : block.values)
        if (box.is_near(value.box, reach)) look(value);
    }
  }
  /// Takes out those near the box of which `is_over` says so.
  template <typename IsOver>
  void erase_near(const Box& box, double reach, const IsOver& is_over) {
    for (Block& block : blocks_)
      if (box.is_near(block.box, reach))
        size_ -= std::erase_if(block.values, [&](const T& value) { return box.is_near(value.box, reach) && is_over(value); });
  }
  /// What lies before `horizon` goes, and the oldest of what is more than `most`, blocks at a time.
  void forget(double horizon, std::size_t most) {
    std::size_t before = 0;
    for (; before < blocks_.size() && size_ > most; ++before) size_ -= blocks_[before].values.size();
    blocks_.erase(blocks_.begin(), blocks_.begin() + static_cast<std::ptrdiff_t>(before));
    std::erase_if(blocks_, [&](const Block& block) {
      const bool over = block.box.high_c < horizon || block.values.empty();
      if (over) size_ -= block.values.size();
      return over;
    });
  }
  void clear() noexcept {
    blocks_.clear();
    size_ = 0;
  }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

private:
  static constexpr std::size_t kBlock = 16;
  struct Block {
    Box box;
    std::vector<T> values;
  };
  std::vector<Block> blocks_; // none is empty but by erase_near()
  std::size_t size_ = 0;
};

} // namespace scansion
