// A table of fixed-size rows: written once in order, then read at random, in bounded memory.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/temp_file.hpp"

#include <algorithm>
#include <bit>
#include <span>
#include <type_traits>
#include <vector>

namespace scansion {

/// Up to kMemory bytes stay in memory; a larger table moves to a temporary file and is read through a cache of pages.
template <class Row>
class PagedTable {
  static_assert(std::is_trivially_copyable_v<Row>);

public:
  static constexpr std::size_t kMemory = std::size_t{32} << 20U;
  static constexpr std::size_t kPageRows = std::bit_floor(std::size_t{4096} / sizeof(Row));
  static constexpr std::size_t kSlotBits = 12;

  [[nodiscard]] std::uint64_t size() const noexcept { return spilled_ + rows_.size(); }

  [[nodiscard]] Result<void> append(const Row& row) {
    if (rows_.size() == kRowsInMemory || (spilled_ > 0 && rows_.size() == kWriteRows)) {
      SCANSION_TRY(spill());
    }
    rows_.push_back(row);
    return success();
  }

  /// Ends the writing.
  [[nodiscard]] Result<void> seal() {
    if (spilled_ == 0) return success();
    SCANSION_TRY(spill());
    rows_ = {};
    pages_.resize(kPageRows << kSlotBits);
    tags_.assign(std::size_t{1} << kSlotBits, kEmpty);
    return success();
  }

  /// Row `index`, below size(), of a sealed table. The pointer holds until the next call.
  [[nodiscard]] Result<const Row*> at(std::uint64_t index) {
    if (spilled_ == 0) return rows_.data() + index;
    const std::uint64_t page = index / kPageRows;
    // Multiplying first spreads pages at a fixed distance, as the cells of one grid column are, over all slots.
    const auto slot = static_cast<std::size_t>((page * 0x9E3779B97F4A7C15U) >> (64 - kSlotBits));
    Row* const rows = pages_.data() + slot * kPageRows;
    if (tags_[slot] != page) {
      tags_[slot] = kEmpty;
      const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kPageRows, spilled_ - page * kPageRows));
      SCANSION_TRY(file_.read(page * kPageRows * sizeof(Row), std::as_writable_bytes(std::span(rows, count))));
      tags_[slot] = page;
    }
    return rows + index % kPageRows;
  }

private:
  static constexpr std::size_t kRowsInMemory = kMemory / sizeof(Row);
  static constexpr std::size_t kWriteRows = kRowsInMemory / 32;
  static constexpr std::uint64_t kEmpty = ~std::uint64_t{0};

  Result<void> spill() {
    SCANSION_TRY(file_.append(std::as_bytes(std::span(rows_))));
    if (spilled_ == 0) {
      rows_ = {};
      rows_.reserve(kWriteRows);
    }
    rows_.clear();
    spilled_ = file_.size() / sizeof(Row);
    return success();
  }

  std::vector<Row> rows_;
  std::uint64_t spilled_ = 0;
  TempFile file_;
  std::vector<Row> pages_;
  std::vector<std::uint64_t> tags_;
};

} // namespace scansion
