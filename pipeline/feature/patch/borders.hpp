// What one patch borders on.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace scansion {

/// The border of one patch with another, lengths in mm. A patch may border on itself: a crease that ends inside of it.
struct Border {
  std::array<double, 3> length{}; ///< by BorderKind: convex, concave, step
  double backed = 0.0;            ///< of these, backed by points of feature lines
  double contact = 0.0;           ///< where nothing cuts them apart
  double height = 0.0;            ///< integral of (this patch's height - the other's) along the border, steps only
  std::array<double, 3> rim{};    ///< integral of this patch's own (s, c, w) along the border
  double gap = 1e300;             ///< between the nearest two samples, in space
  [[nodiscard]] double total() const noexcept { return length[0] + length[1] + length[2]; }
  void add(const Border& other) noexcept;
};

/// Borders by the other patch's id, in ascending order. Ids lie together: each row asks for a few among many. References are
/// good until borders are added or erased.
class Borders {
public:
  class Iterator {
  public:
    Iterator(const std::uint32_t* id, const Border* border) noexcept : id_(id), border_(border) {}
    [[nodiscard]] std::pair<std::uint32_t, const Border&> operator*() const noexcept { return {*id_, *border_}; }
    Iterator& operator++() noexcept {
      ++id_;
      ++border_;
      return *this;
    }
    friend bool operator==(const Iterator& a, const Iterator& b) noexcept { return a.id_ == b.id_; }

  private:
    const std::uint32_t* id_;
    const Border* border_;
  };
  [[nodiscard]] Iterator begin() const noexcept { return {ids_.data(), borders_.data()}; }
  [[nodiscard]] Iterator end() const noexcept { return {ids_.data() + ids_.size(), borders_.data() + borders_.size()}; }

  /// Null: there is none.
  [[nodiscard]] const Border* find(std::uint32_t id) const noexcept {
    const std::size_t at = place_of(id);
    return at < ids_.size() && ids_[at] == id ? &borders_[at] : nullptr;
  }
  /// One that is known to be there.
  [[nodiscard]] const Border& at(std::uint32_t id) const noexcept { return borders_[place_of(id)]; }
  /// An empty one if there was none.
  [[nodiscard]] Border& operator[](std::uint32_t id) {
    const std::size_t at = place_of(id);
    if (at == ids_.size() || ids_[at] != id) {
      ids_.insert(ids_.begin() + static_cast<std::ptrdiff_t>(at), id);
      borders_.insert(borders_.begin() + static_cast<std::ptrdiff_t>(at), Border());
    }
    return borders_[at];
  }
  void erase(std::uint32_t id) noexcept {
    const std::size_t at = place_of(id);
    if (at == ids_.size() || ids_[at] != id) return;
    ids_.erase(ids_.begin() + static_cast<std::ptrdiff_t>(at));
    borders_.erase(borders_.begin() + static_cast<std::ptrdiff_t>(at));
  }
  void clear() noexcept {
    ids_.clear();
    borders_.clear();
  }

private:
  // Of the first id that is no lower. Which half it lies in is hard to foresee: without branches.
  [[nodiscard]] std::size_t place_of(std::uint32_t id) const noexcept {
    const std::uint32_t* first = ids_.data();
    for (std::size_t n = ids_.size(); n > 0;) {
      const std::size_t half = n / 2;
      const bool behind = first[half] < id;
      first = behind ? first + half + 1 : first;
      n = behind ? n - half - 1 : half;
    }
    return static_cast<std::size_t>(first - ids_.data());
  }

  std::vector<std::uint32_t> ids_;
  std::vector<Border> borders_; ///< in the same order
};

} // namespace scansion
