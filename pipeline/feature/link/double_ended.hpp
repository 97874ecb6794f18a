// Values side by side in memory that grow at both ends.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <type_traits>
#include <utility>

namespace scansion {

/// What grows at its end only holds no room in front. References are good until the next value is added, and none may be given
/// to be added.
template <typename T>
class DoubleEnded {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

public:
  DoubleEnded() = default;
  DoubleEnded(const DoubleEnded&) = delete;
  DoubleEnded& operator=(const DoubleEnded&) = delete;
  DoubleEnded(DoubleEnded&& other) noexcept { swap(other); }
  DoubleEnded& operator=(DoubleEnded&& other) noexcept {
    swap(other);
    other.clear();
    return *this;
  }
  ~DoubleEnded() = default;

  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] bool empty() const noexcept { return count_ == 0; }
  [[nodiscard]] T* begin() noexcept { return room_.get() + first_; }
  [[nodiscard]] T* end() noexcept { return begin() + count_; }
  [[nodiscard]] const T* begin() const noexcept { return room_.get() + first_; }
  [[nodiscard]] const T* end() const noexcept { return begin() + count_; }
  [[nodiscard]] T& operator[](std::size_t i) noexcept { return begin()[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return begin()[i]; }
  [[nodiscard]] T& front() noexcept { return *begin(); }
  [[nodiscard]] const T& front() const noexcept { return *begin(); }
  [[nodiscard]] T& back() noexcept { return begin()[count_ - 1]; }
  [[nodiscard]] const T& back() const noexcept { return begin()[count_ - 1]; }

  void push_back(const T& value) {
    make_room(0, 1);
    std::construct_at(end(), value);
    ++count_;
  }
  void push_front(const T& value) {
    make_room(1, 0);
    std::construct_at(begin() - 1, value);
    --first_;
    ++count_;
  }
  void insert(const T* at, const T& value) {
    const auto before = static_cast<std::size_t>(at - begin());
    make_room(0, 1);
    T* const to = begin() + before;
    std::memmove(to + 1, to, (count_ - before) * sizeof(T));
    std::construct_at(to, value);
    ++count_;
  }
  /// Takes the values of another one, which is empty then. Moves the fewer of both.
  void append(DoubleEnded& other) {
    if (count_ < other.count_) {
      other.make_room(count_, 0);
      std::uninitialized_copy(begin(), end(), other.begin() - count_);
      other.first_ -= count_;
      other.count_ += count_;
      swap(other);
    } else {
      make_room(0, other.count_);
      std::uninitialized_copy(other.begin(), other.end(), end());
      count_ += other.count_;
    }
    other.clear();
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
  struct Free {
    std::size_t size = 0;
    void operator()(T* room) const noexcept { std::allocator<T>().deallocate(room, size); }
  };
  using Room = std::unique_ptr<T, Free>;

  void swap(DoubleEnded& other) noexcept {
    std::swap(room_, other.room_);
    std::swap(first_, other.first_);
    std::swap(count_, other.count_);
    std::swap(grows_in_front_, other.grows_in_front_);
  }
  [[nodiscard]] std::size_t capacity() const noexcept { return room_.get_deleter().size; }

  // For so many more values in front and behind.
  void make_room(std::size_t front, std::size_t behind) {
    if (front > 0) grows_in_front_ = true;
    if (front <= first_ && first_ + count_ + behind <= capacity()) return;
    constexpr std::size_t kLeast = 8;
    const std::size_t wanted = std::max(kLeast, 2 * (front + count_ + behind));
    const std::size_t least = front + count_ + behind, size = std::max(wanted, capacity());
    const std::size_t first = grows_in_front_ ? front + (size - least) / 2 : 0;
    if (wanted > capacity()) {
      Room room(std::allocator<T>().allocate(wanted), Free{wanted});
      std::uninitialized_copy(begin(), end(), room.get() + first);
      room_ = std::move(room);
    } else if (count_ > 0) {
      std::memmove(room_.get() + first, begin(), count_ * sizeof(T));
    }
    first_ = first;
  }

  Room room_;
  std::size_t first_ = 0, count_ = 0; ///< in room_
  bool grows_in_front_ = false;
};

} // namespace scansion
