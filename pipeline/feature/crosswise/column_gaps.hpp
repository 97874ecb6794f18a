// Columns that tracks have passed over.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace scansion {

/// Tracks by number; each may have passed over many columns, of which the last kMost are kept. Thread-bound; allocates only
/// when there are more gaps than ever.
class ColumnGaps {
public:
  /// The track has no point in this column but points on both sides.
  void put(std::uint32_t track, std::int64_t column) {
    if (track >= columns_.size()) columns_.resize(track + 1U);
    auto& own = columns_[track];
    if (own.size() == kMost) take(track, own.front());
    own.push_back(column);
    list_of(column).push_back({column, track});
  }
  /// It has one now.
  void take(std::uint32_t track, std::int64_t column) {
    std::erase(columns_[track], column);
    leave(track, column);
  }
  /// What was passed over by one track was so by the other, which it is a part of now.
  void hand_over(std::uint32_t from, std::uint32_t into) {
    if (from >= columns_.size()) return;
    if (into >= columns_.size()) columns_.resize(into + 1U); // not below, while columns of `from` are walked
    for (const std::int64_t column : columns_[from]) {
      leave(from, column);
      put(into, column);
    }
    columns_[from].clear();
  }
  /// The track is no more.
  void take_all(std::uint32_t track) {
    if (track >= columns_.size()) return;
    for (const std::int64_t column : columns_[track]) leave(track, column);
    columns_[track].clear();
  }
  /// Calls `look` with each track that passed over the column.
  template <typename Look>
  void visit(std::int64_t column, const Look& look) const {
    for (const Gap& gap : lists_[index_of(column)])
      if (gap.column == column) look(gap.track);
  }

private:
  static constexpr std::size_t kMost = 16;    // of a track
  static constexpr std::size_t kLists = 1024; // a power of two
  struct Gap {
    std::int64_t column = 0;
    std::uint32_t track = 0;
  };
  [[nodiscard]] static std::size_t index_of(std::int64_t column) noexcept {
    return static_cast<std::size_t>(column) & (kLists - 1);
  }
  [[nodiscard]] std::vector<Gap>& list_of(std::int64_t column) noexcept { return lists_[index_of(column)]; }
  void leave(std::uint32_t track, std::int64_t column) {
    std::erase_if(list_of(column), [&](const Gap& gap) { return gap.track == track && gap.column == column; });
  }

  std::array<std::vector<Gap>, kLists> lists_;
  std::vector<std::vector<std::int64_t>> columns_; ///< by track, in the order in which they were passed over
};

} // namespace scansion
