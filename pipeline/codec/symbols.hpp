// Arrays of residuals, each with a context that both sides know, as rANS tokens and plain bits (docs/FORMAT.md, "Coded").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/context_tables.hpp"
#include "pipeline/codec/rans.hpp"
#include "pipeline/codec/varint.hpp"

namespace scansion {

/// Collects residuals front to back, then writes them. One object, one thread; memory is used again.
class SymbolWriter {
public:
  void clear() noexcept;
  void put(std::int32_t value, std::uint32_t context) {
    if (size_ + kStride > values_.size()) grow(1);
    values_[size_] = value;
    contexts_[size_++] = static_cast<std::uint8_t>(context);
  }
  /// Both are read up to kStride elements behind the end of a stretch.
  static constexpr std::size_t kStride = 8;
  /// Several, one after the other; short stretches are what this is for.
  void put(const std::int32_t* values, const std::uint8_t* contexts, std::size_t count) {
    if (size_ + count + kStride > values_.size()) grow(count);
    for (std::size_t i = 0; i < count; i += kStride) {
      std::memcpy(values_.data() + size_ + i, values + i, kStride * sizeof *values);
      std::memcpy(contexts_.data() + size_ + i, contexts + i, kStride);
    }
    size_ += count;
  }
  /// About how many bits write() would take, for a choice between two ways.
  [[nodiscard]] std::uint64_t estimate();
  /// Appends the values put since clear(). The reader is told by where they stand which of the two it was.
  void write(Bytes& to) { write<kShortStates>(to); }
  void write_long(Bytes& to) { write<kLongStates>(to); }

private:
  void grow(std::size_t more);
  void count();
  template <std::size_t kStates>
  void write(Bytes& to);
  template <std::size_t kStates>
  void write_symbols(Bytes& to);
  void write_plain(Bytes& to);

  // The first size_ of these count; the others are memory.
  std::vector<std::int32_t> values_;
  std::vector<std::uint8_t> contexts_;
  std::vector<std::uint8_t> tokens_;
  std::size_t size_ = 0;
  bool counted_ = false;         ///< what follows holds for all values
  std::uint32_t last_token_ = 0; ///< the largest
  ContextTables shared_;
  std::array<RansEncodeTable, kMaxTables> tables_{};
  Bytes words_; ///< memory
  Bytes bits_;
};

/// Reads what a SymbolWriter wrote, one value at a time. Hostile bytes give wrong values and a false finish(), nothing worse.
class SymbolReader {
public:
  /// The place in the array. A copy of its own stays in registers in a loop that writes to memory.
  class Cursor {
  public:
    [[nodiscard]] const RansDecodeTable& table(std::uint32_t context) const noexcept { return *tables_[context]; }
    /// The folded form of the next value. Part of the loop around it, which then keeps all of this in registers.
    template <std::size_t kStates>
    [[nodiscard]] __attribute__((always_inline)) std::uint32_t next(const RansDecodeTable& table) noexcept {
      const std::uint32_t slot = state_ & (kTotal - 1);
      const std::uint32_t token = table.token[slot];
      const RansDecodeTable::Entry entry = table.entries[token];
      const std::uint32_t state = entry.frequency * (state_ >> kTotalBits) + slot - entry.start;
      // Nobody can tell beforehand when it is low, so nothing here may become a branch.
      const std::uint32_t low = 0U - (state < kRansLow ? 1U : 0U);
      const std::uint32_t refilled = state << 16U | load_le<std::uint16_t>(next_);
      if constexpr (kStates == kLongStates) state_ = other_;
      (kStates == kLongStates ? other_ : state_) = state ^ ((state ^ refilled) & low);
      next_ += low & 2U;
      if (token < kDirectTokens) return token;
      const TokenRange range = kTokenRanges[token];
      return range.first + bits_.take(range.bits);
    }

    /// Goes back to the end of the bytes if it has left them.
    void hold() noexcept { next_ = std::min(next_, end_); }

  private:
    friend class SymbolReader;
    const RansDecodeTable* const* tables_ = nullptr; ///< by context
    std::uint32_t state_ = 0, other_ = 0;            ///< whose turn it is, and the other, if there is one
    const std::byte* next_ = nullptr;
    const std::byte* end_ = nullptr; ///< some bytes may be read behind it
    BitReader bits_;
  };

  SymbolReader();
  /// Takes the bytes of a short array from `from`.
  [[nodiscard]] Result<void> begin(ByteReader& from) { return begin(from, kShortStates, 1); }
  [[nodiscard]] std::int32_t next(std::uint32_t context) noexcept {
    const std::uint32_t folded = cursor_.next<kShortStates>(cursor_.table(context));
    cursor_.hold();
    return unfold(folded);
  }
  /// The same of a long one, which is read with a cursor; that must hold() after `unheld` values at the latest.
  [[nodiscard]] Result<void> begin_long(ByteReader& from, std::size_t unheld) { return begin(from, kLongStates, unheld); }
  [[nodiscard]] Cursor cursor() const noexcept { return cursor_; }
  void set(const Cursor& cursor) noexcept { cursor_ = cursor; }
  /// True when exactly the bytes given were used.
  [[nodiscard]] bool finish() const noexcept;

private:
  [[nodiscard]] Result<void> begin(ByteReader& from, std::size_t states, std::size_t unheld);

  std::array<RansDecodeTable, kMaxTables> tables_{};
  RansDecodeTable zero_{}; ///< for arrays that hold nothing but 0 and have no table
  std::array<const RansDecodeTable*, kMaxContexts> table_of_{};
  Bytes words_;
  Cursor cursor_;
};

} // namespace scansion
