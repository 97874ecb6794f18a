// The samples of a row that waits, in half the room of doubles: as they stand to columns. Many rows wait, and what is small
// stays near the processor.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace scansion {

/// Places along the line, mm: an even row that begins with the first sample, and how far each sample is off it.
class RowPlaces {
public:
  /// Takes the shifts, in pitches, and leaves other room in their place.
  void take(std::vector<float>& shift, double first, double pitch) {
    shift_.swap(shift);
    first_ = first;
    pitch_ = pitch;
  }
  [[nodiscard]] std::size_t size() const noexcept { return shift_.size(); }
  [[nodiscard]] double operator[](std::size_t k) const noexcept {
    return first_ + (static_cast<double>(k) + static_cast<double>(shift_[k])) * pitch_;
  }
  [[nodiscard]] double front() const noexcept { return (*this)[0]; }
  [[nodiscard]] double back() const noexcept { return (*this)[size() - 1]; }
  /// The first sample of [begin, end) at `place` or beyond it, and the first one beyond it; `end`: there is none.
  [[nodiscard]] std::uint32_t at_or_beyond(std::uint32_t begin, std::uint32_t end, double place) const noexcept {
    return first_where(begin, end, [&](std::uint32_t k) { return (*this)[k] >= place; });
  }
  [[nodiscard]] std::uint32_t beyond(std::uint32_t begin, std::uint32_t end, double place) const noexcept {
    return first_where(begin, end, [&](std::uint32_t k) { return (*this)[k] > place; });
  }

private:
  template <typename Is>
  static std::uint32_t first_where(std::uint32_t begin, std::uint32_t end, const Is& is) noexcept {
    while (begin < end) {
      const std::uint32_t middle = begin + (end - begin) / 2;
      if (is(middle))
        end = middle;
      else
        begin = middle + 1;
    }
    return begin;
  }

  std::vector<float> shift_; // pitches
  double first_ = 0.0, pitch_ = 1.0;
};

/// Heights, mm.
class RowHeights {
public:
  /// Takes the heights above `base`, and leaves other room in their place.
  void take(std::vector<float>& above, double base) {
    above_.swap(above);
    base_ = base;
  }
  [[nodiscard]] double operator[](std::size_t k) const noexcept { return base_ + static_cast<double>(above_[k]); }
  /// Above the base.
  [[nodiscard]] const float* above() const noexcept { return above_.data(); }

private:
  std::vector<float> above_;
  double base_ = 0.0;
};

} // namespace scansion
