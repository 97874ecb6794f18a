// Which tracks end in a column.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace scansion {

/// Tracks by number, each in one column at most. Columns share lists when they stand far apart. Thread-bound; allocates only
/// when there are more tracks than ever.
class ColumnEnds {
public:
  static constexpr std::uint32_t kNoTrack = 0xffffffffU;

  ColumnEnds() { firsts_.fill(kNoTrack); }

  /// The track ends here now.
  void put(std::uint32_t track, std::int64_t column) {
    if (track >= links_.size()) links_.resize(track + 1U);
    take(track);
    std::uint32_t& first = firsts_[list_of(column)];
    links_[track] = {column, first, true};
    first = track;
  }
  /// The track ends nowhere any more.
  void take(std::uint32_t track) noexcept {
    if (track >= links_.size() || !links_[track].in) return;
    std::uint32_t* at = &firsts_[list_of(links_[track].column)];
    while (*at != track) at = &links_[*at].next;
    *at = links_[track].next;
    links_[track].in = false;
  }
  /// Calls `look` with each track that ends in the column.
  template <typename Look>
  void visit(std::int64_t column, const Look& look) const {
    for (std::uint32_t t = firsts_[list_of(column)]; t != kNoTrack; t = links_[t].next)
      if (links_[t].column == column) look(t);
  }

private:
  static constexpr std::size_t kLists = 4096; // a power of two
  struct Link {
    std::int64_t column = 0;
    std::uint32_t next = kNoTrack;
    bool in = false;
  };
  [[nodiscard]] static std::size_t list_of(std::int64_t column) noexcept {
    return static_cast<std::size_t>(column) & (kLists - 1);
  }

  std::array<std::uint32_t, kLists> firsts_{};
  std::vector<Link> links_; ///< by track
};

} // namespace scansion
