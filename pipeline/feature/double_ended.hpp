// Values side by side in memory that grow at both ends.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace scansion {

/// For values that cost little to make and to copy: those that were taken away stay behind as room. What grows at one end only
/// holds no room at the other. A reference is good until the next value is added, and none may be given to be added.
template <typename T> class DoubleEnded {
public:
  DoubleEnded() = default;
  DoubleEnded(const DoubleEnded&) = delete;
  DoubleEnded& operator=(const DoubleEnded&) = delete;
  DoubleEnded(DoubleEnded&& other) noexcept
      : room_(std::move(other.room_)), first_(std::exchange(other.first_, 0)), count_(std::exchange(other.count_, 0)),
        grows_in_front_(other.grows_in_front_) {}
  DoubleEnded& operator=(DoubleEnded&& other) noexcept {
    std::swap(room_, other.room_);
    first_ = std::exchange(other.first_, 0);
    count_ = std::exchange(other.count_, 0);
    grows_in_front_ = other.grows_in_front_;
    return *this;
  }
  ~DoubleEnded() = default;

  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
  [[nodiscard]] T* begin() noexcept { return room_.data() + first_; }
  [[nodiscard]] T* end() noexcept { return begin() + count_; }
  [[nodiscard]] const T* begin() const noexcept { return room_.data() + first_; }
  [[nodiscard]] const T* end() const noexcept { return begin() + count_; }
  [[nodiscard]] T& operator[](std::size_t i) noexcept { return begin()[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return begin()[i]; }
  [[nodiscard]] T& front() noexcept { return *begin(); }
  [[nodiscard]] const T& front() const noexcept { return *begin(); }
  [[nodiscard]] T& back() noexcept { return begin()[count_ - 1]; }
  [[nodiscard]] const T& back() const noexcept { return begin()[count_ - 1]; }

  void push_back(const T& value) {
    if (first_ + count_ == room_.size()) move_to(grows_in_front_ ? Spare::around : Spare::behind);
    room_[first_ + count_++] = value;
  }
  void push_front(const T& value) {
    grows_in_front_ = true;
    if (first_ == 0) move_to(Spare::around);
    room_[--first_] = value;
    ++count_;
  }
  void pop_back() noexcept { --count_; }
  void pop_front(std::size_t count) noexcept {
    first_ += count;
    count_ -= count;
  }
  void clear() noexcept {
    first_ = count_ = 0;
    grows_in_front_ = false;
  }

private:
  enum class Spare : std::uint8_t { behind, around };

  // To the middle of the room or to its beginning; it is made larger when half of it is full.
  void move_to(Spare spare) {
    constexpr std::size_t kLeast = 8;
    const std::size_t wanted = std::max(kLeast, 2 * count_);
    if (wanted > room_.size()) {
      std::vector<T> room(wanted);
      const std::size_t first = first_in(room, spare);
      std::copy(begin(), end(), room.data() + first);
      room_ = std::move(room);
      first_ = first;
      return;
    }
    const std::size_t first = first_in(room_, spare);
    if (first < first_)
      std::copy(begin(), end(), room_.data() + first);
    else
      std::copy_backward(begin(), end(), room_.data() + first + count_);
    first_ = first;
  }
  [[nodiscard]] std::size_t first_in(const std::vector<T>& room, Spare spare) const noexcept {
    return spare == Spare::behind ? 0 : (room.size() - count_) / 2;
  }

  std::vector<T> room_;
  std::size_t first_ = 0, count_ = 0; ///< of room_
  bool grows_in_front_ = false;
};

} // namespace scansion
