// Arrays of residuals as rANS tokens and plain bits.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/symbols.hpp"

#include "pipeline/codec/kernels.hpp"

namespace scansion {

void SymbolWriter::clear() noexcept {
  size_ = 0;
  shared_.clear();
  counted_ = false;
}

void SymbolWriter::grow(std::size_t more) {
  const std::size_t room = 2 * (size_ + more) + 64;
  values_.resize(room);
  contexts_.resize(room);
  tokens_.resize(room);
}

// Tokens of all values, and how many of each there are in each context; as many at a time as stay in the nearest cache.
void SymbolWriter::count() {
  constexpr std::size_t kBlock = 2048;
  last_token_ = 0;
  for (std::size_t from = 0; from < size_; from += kBlock) {
    const std::size_t n = std::min(size_ - from, kBlock);
    last_token_ = std::max<std::uint32_t>(last_token_, kernels::tokens(values_.data() + from, tokens_.data() + from, n));
    shared_.count(contexts_.data() + from, tokens_.data() + from, n, last_token_);
  }
  counted_ = true;
}

std::uint64_t SymbolWriter::estimate() {
  count();
  return last_token_ == 0 ? 0 : shared_.choose() >> kLogBits;
}

template <std::size_t kStates>
void SymbolWriter::write(Bytes& to) {
  if (!counted_) count();
  const bool zero = last_token_ == 0;
  if (!zero && shared_.tables() == 0) (void)shared_.choose();
  const std::size_t tables = zero ? 0 : shared_.tables();
  to.push_back(static_cast<std::byte>(tables));
  if (zero) return;
  std::size_t context = 0;
  for (std::uint8_t s = 0; s + 1U < tables; ++s) {
    while (shared_.table_of(context) == s) ++context;
    to.push_back(static_cast<std::byte>(context));
  }
  BitWriter bits(to);
  for (std::size_t s = 0; s < tables; ++s) {
    const Classes classes = classes_of(shared_.counts(s));
    Frequencies frequencies;
    (void)frequencies_of(classes, frequencies);
    tables_[s].set(frequencies);
    write_classes(classes, bits);
  }
  bits.flush();
  write_symbols<kStates>(to);
}

template void SymbolWriter::write<kShortStates>(Bytes& to);
template void SymbolWriter::write<kLongStates>(Bytes& to);

template <std::size_t kStates>
void SymbolWriter::write_symbols(Bytes& to) {
  // Last in, first out: the reader's first token is pushed last.
  words_.resize(std::max(words_.size(), 2 * size_ + 4 * kStates));
  std::byte* const end = words_.data() + words_.size();
  std::byte* at = end;
  std::array<std::uint32_t, kStates> states;
  states.fill(kRansLow);
  std::array<const RansEncodeTable::Entry*, kMaxContexts> entries;
  for (std::size_t c = 0; c < kMaxContexts; ++c) entries[c] = tables_[shared_.table_of(c)].entries.data();
  const std::uint8_t* const tokens = tokens_.data();
  const std::uint8_t* const contexts = contexts_.data();
  std::size_t n = size_;
  const auto push = [&](std::uint32_t state) {
    --n;
    return rans_push(state, entries[contexts[n]][tokens[n]], at);
  };
  if (n % kStates != 0) states[0] = push(states[0]);
  for (std::size_t turns = n / kStates; turns > 0; --turns) {
    if constexpr (kStates == kLongStates) states[1] = push(states[1]);
    states[0] = push(states[0]);
  }
  for (std::size_t s = kStates; s-- > 0;) store_le(at -= 4, states[s]);
  put_varint(to, static_cast<std::uint64_t>(end - at));
  to.insert(to.end(), at, end);
  write_plain(to);
}

// Most eights of tokens have none with plain bits.
void SymbolWriter::write_plain(Bytes& to) {
  constexpr std::uint64_t kOverDirect = ~std::uint64_t{kDirectTokens - 1} & 0xFFU;
  constexpr std::uint64_t kAnyOver = kOverDirect * 0x0101'0101'0101'0101U;
  bits_.resize(std::max(bits_.size(), 4 * size_ + 8));
  std::byte* at = bits_.data();
  std::uint64_t waiting = 0;
  unsigned filled = 0; // less than a byte
  for (std::size_t from = 0; last_token_ >= kDirectTokens && from < size_; from += kStride) {
    std::uint64_t over;
    std::memcpy(&over, tokens_.data() + from, sizeof over);
    over &= kAnyOver;
    if (const std::size_t left = size_ - from; left < kStride) over &= (std::uint64_t{1} << 8 * left) - 1;
    while (over != 0) {
      const auto place = static_cast<unsigned>(std::countr_zero(over)) / 8;
      over &= ~(std::uint64_t{0xFF} << 8 * place);
      const TokenRange& range = kTokenRanges[tokens_[from + place]];
      waiting |= std::uint64_t{fold(values_[from + place]) - range.first} << filled;
      store_le(at, waiting);
      filled += range.bits;
      at += filled / 8;
      waiting >>= filled & ~7U;
      filled &= 7U;
    }
  }
  const std::size_t bytes = static_cast<std::size_t>(at - bits_.data()) + (filled != 0 ? 1 : 0);
  put_varint(to, bytes);
  to.insert(to.end(), bits_.begin(), bits_.begin() + static_cast<std::ptrdiff_t>(bytes));
}

SymbolReader::SymbolReader() {
  // With the whole total its only token leaves every state as it is.
  Frequencies all{};
  all[0] = kTotal;
  zero_.set(all);
}

Result<void> SymbolReader::begin(ByteReader& from, std::size_t states, std::size_t unheld) {
  const std::size_t tables = from.byte();
  if (!from.ok() || tables > kMaxTables) return fail(Errc::damaged, "coded integers have an impossible number of tables");
  ByteView words;
  ByteView plain;
  if (tables == 0) {
    table_of_.fill(&zero_);
    words_.assign(4 * states, std::byte{});
    for (std::size_t s = 0; s < states; ++s) store_le(words_.data() + 4 * s, kRansLow);
    words = words_;
  } else {
    table_of_.fill(&tables_[tables - 1]);
    std::size_t context = 0;
    for (std::size_t s = 0; s + 1 < tables; ++s) {
      const std::size_t end = from.byte();
      if (end <= context || end >= kMaxContexts) return fail(Errc::damaged, "coded integers have an impossible table");
      while (context < end) table_of_[context++] = &tables_[s];
    }
    BitReader bits(from.rest());
    for (std::size_t s = 0; s < tables; ++s) {
      Classes classes;
      Frequencies frequencies;
      if (!read_classes(bits, classes) || !frequencies_of(classes, frequencies))
        return fail(Errc::damaged, "coded integers have an impossible table");
      tables_[s].set(frequencies);
    }
    (void)from.bytes(from.left() - bits.untouched().size());
    words = from.bytes(from.varint());
    plain = from.bytes(from.varint());
  }
  if (!from.ok() || words.size() < 4 * states || words.size() % 2 != 0)
    return fail(Errc::damaged, "coded integers are cut short");
  if (tables != 0) words_.assign(words.begin(), words.end());
  words_.resize(words_.size() + 2 * unheld);
  cursor_.tables_ = table_of_.data();
  cursor_.state_ = load_le<std::uint32_t>(words_.data());
  cursor_.other_ = states == kLongStates ? load_le<std::uint32_t>(words_.data() + 4) : kRansLow;
  cursor_.next_ = words_.data() + 4 * states;
  cursor_.end_ = words_.data() + words_.size() - 2 * unheld;
  cursor_.bits_ = BitReader(plain);
  return success();
}

bool SymbolReader::finish() const noexcept {
  return cursor_.next_ == cursor_.end_ && cursor_.bits_.at_end() && cursor_.state_ == kRansLow && cursor_.other_ == kRansLow;
}

} // namespace scansion
