// Arrays of residuals as rANS tokens and plain bits.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/symbols.hpp"

#include "pipeline/codec/kernels.hpp"

namespace scansion {
namespace {

void add(TokenCounts& to, const TokenCounts& counts, std::size_t tokens) noexcept {
  for (std::size_t t = 0; t < tokens; ++t) to[t] += counts[t];
}

} // namespace

void SymbolWriter::clear() noexcept {
  size_ = 0;
  plain_.clear();
  for (; used_ != 0; used_ &= used_ - 1) counts_[static_cast<std::size_t>(std::countr_zero(used_))].fill(0);
  counted_ = false;
  tables_chosen_ = 0;
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
  std::uint64_t used = 0;
  last_token_ = 0;
  for (std::size_t from = 0; from < size_; from += kBlock) {
    const std::size_t end = std::min(size_, from + kBlock);
    last_token_ =
        std::max<std::uint32_t>(last_token_, kernels::tokens(values_.data() + from, tokens_.data() + from, end - from));
    for (std::size_t i = from; i < end; ++i) {
      used |= std::uint64_t{1} << contexts_[i];
      ++counts_[contexts_[i]][tokens_[i]];
    }
  }
  used_ = used;
  if (last_token_ >= kDirectTokens) find_plain();
  counted_ = true;
}

void SymbolWriter::find_plain() {
  constexpr std::uint64_t kDirectBits = (kDirectTokens - 1) * 0x0101'0101'0101'0101U;
  for (std::size_t from = 0; from < size_; from += kStride) { // most eights have none
    std::uint64_t eight;
    std::memcpy(&eight, tokens_.data() + from, sizeof eight);
    if ((eight & ~kDirectBits) == 0) continue;
    for (std::size_t i = from; i < std::min(size_, from + kStride); ++i)
      if (tokens_[i] >= kDirectTokens) plain_.push_back(static_cast<std::uint32_t>(i));
  }
}

// Contexts stand in the order of growing residuals. Neighbours share a table where that is cheaper than two tables.
void SymbolWriter::choose_tables() {
  struct Span {
    std::size_t end;         // contexts of the table end here
    std::size_t tokens;      // which the table has
    std::uint64_t cost;      // of the table and its tokens
    std::uint64_t with_next; // of one table for this and the next
  };
  std::array<Span, kMaxContexts> spans;
  std::size_t n = 0;
  const auto cost_with_next = [&](std::size_t s) {
    return coded_cost(merged_[s], merged_[s + 1], std::max(spans[s].tokens, spans[s + 1].tokens));
  };
  for (std::uint64_t used = used_; used != 0; used &= used - 1) {
    const auto c = static_cast<std::size_t>(std::countr_zero(used));
    std::size_t tokens = last_token_ + 1;
    while (counts_[c][tokens - 1] == 0) --tokens;
    merged_[n] = counts_[c];
    spans[n++] = {c + 1, tokens, coded_cost(counts_[c], tokens), 0};
  }
  for (std::size_t s = 0; s + 1 < n; ++s) spans[s].with_next = cost_with_next(s);
  while (n > 1) {
    std::size_t best = 0;
    std::int64_t best_gain = std::numeric_limits<std::int64_t>::min();
    for (std::size_t s = 0; s + 1 < n; ++s) {
      const auto gain = static_cast<std::int64_t>(spans[s].cost + spans[s + 1].cost - spans[s].with_next);
      if (gain > best_gain) {
        best = s;
        best_gain = gain;
      }
    }
    if (best_gain < 0 && n <= kMaxTables) break;
    add(merged_[best], merged_[best + 1], spans[best + 1].tokens);
    spans[best] = {spans[best + 1].end, std::max(spans[best].tokens, spans[best + 1].tokens), spans[best].with_next, 0};
    for (std::size_t s = best + 1; s + 1 < n; ++s) {
      spans[s] = spans[s + 1];
      merged_[s] = merged_[s + 1];
    }
    --n;
    if (best + 1 < n) spans[best].with_next = cost_with_next(best);
    if (best > 0) spans[best - 1].with_next = cost_with_next(best - 1);
  }
  cost_ = 0;
  std::size_t context = 0;
  for (std::size_t s = 0; s < n; ++s) cost_ += spans[s].cost;
  for (std::size_t s = 0; s < n; ++s)
    while (context < spans[s].end) table_of_[context++] = static_cast<std::uint8_t>(s);
  while (context < kMaxContexts) table_of_[context++] = static_cast<std::uint8_t>(n - 1);
  tables_chosen_ = n;
}

std::uint64_t SymbolWriter::estimate() {
  count();
  if (last_token_ == 0) return 0;
  choose_tables();
  std::uint64_t cost = cost_;
  for (const std::uint32_t i : plain_) cost += std::uint64_t{kTokenRanges[tokens_[i]].bits} << kLogBits;
  return cost >> kLogBits;
}

template <std::size_t kStates>
void SymbolWriter::write(Bytes& to) {
  if (!counted_) count();
  const bool zero = last_token_ == 0;
  if (!zero && tables_chosen_ == 0) choose_tables();
  const std::size_t tables = zero ? 0 : tables_chosen_;
  to.push_back(static_cast<std::byte>(tables));
  if (zero) return;
  std::size_t context = 0;
  for (std::uint8_t s = 0; s + 1U < tables; ++s) {
    while (table_of_[context] == s) ++context;
    to.push_back(static_cast<std::byte>(context));
  }
  BitWriter bits(to);
  for (std::size_t s = 0; s < tables; ++s) {
    const Classes classes = classes_of(merged_[s]);
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
  words_.resize(2 * size_ + 4 * kStates);
  std::byte* const end = words_.data() + words_.size();
  std::byte* at = end;
  std::array<std::uint32_t, kStates> states;
  states.fill(kRansLow);
  std::array<const RansEncodeTable::Entry*, kMaxContexts> entries;
  for (std::size_t c = 0; c < kMaxContexts; ++c) entries[c] = tables_[table_of_[c]].entries.data();
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

  words_.clear();
  BitWriter bits(words_);
  for (const std::uint32_t i : plain_) {
    const TokenRange& range = kTokenRanges[tokens_[i]];
    bits.put(fold(values_[i]) - range.first, range.bits);
  }
  bits.flush();
  put_varint(to, words_.size());
  to.insert(to.end(), words_.begin(), words_.end());
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
