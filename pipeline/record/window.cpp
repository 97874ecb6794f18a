// The sliding view.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/window.hpp"

#include <algorithm>
#include <cstring>

namespace scansion {
namespace {

constexpr std::uint64_t kBlock = 1U << 20U;
constexpr std::uint64_t kLongestPattern = 64;

} // namespace

Result<ByteView> Window::view(std::uint64_t offset, std::uint64_t count) {
  if (offset >= size_) return ByteView{};
  count = std::min(count, size_ - offset);
  if (offset < base_ || offset - base_ > filled_ || count > filled_ - (offset - base_)) {
    const std::uint64_t take = std::min(std::max(count, kBlock), size_ - offset);
    // A rare long record must not keep its memory for the rest of the file.
    if (buffer_.size() > 4 * kBlock && take <= kBlock) std::vector<std::byte>().swap(buffer_);
    if (buffer_.size() < take) buffer_.resize(take);
    filled_ = 0;
    SCANSION_TRY(file_->read_at(offset, std::span(buffer_).first(take)));
    base_ = offset;
    filled_ = take;
  }
  return ByteView(buffer_).subspan(offset - base_, count);
}

PatternFinder::PatternFinder(Window& window, std::span<const std::string_view> patterns) : window_(&window) {
  for (const std::string_view bytes : patterns) patterns_.push_back({bytes, 0, false});
}

Result<std::optional<PatternFinder::Hit>> PatternFinder::find_in_block(std::uint64_t from) {
  std::optional<Hit> best;
  for (std::size_t k = 0; k < patterns_.size(); ++k) {
    Pattern& p = patterns_[k];
    if (!p.known || p.next < from) {
      SCANSION_TRY(bytes, window_->view(from, block_end_ - from + p.bytes.size() - 1));
      const void* at = ::memmem(bytes.data(), bytes.size(), p.bytes.data(), p.bytes.size());
      p.next = at == nullptr ? block_end_ : from + static_cast<std::uint64_t>(static_cast<const std::byte*>(at) - bytes.data());
      p.known = true;
    }
    if (p.next < block_end_ && (!best || p.next < best->offset)) best = Hit{p.next, k};
  }
  return best;
}

Result<std::optional<PatternFinder::Hit>> PatternFinder::find(std::uint64_t from, std::uint64_t to) {
  to = std::min(to, window_->size());
  while (from < to) {
    if (from < block_begin_ || from >= block_end_) {
      block_begin_ = from;
      block_end_ = std::min(from + kBlock - kLongestPattern, window_->size());
      for (Pattern& p : patterns_) p.known = false;
    }
    SCANSION_TRY(hit, find_in_block(from));
    if (hit) {
      if (hit->offset >= to) return std::optional<Hit>{};
      return hit;
    }
    from = block_end_;
  }
  return std::optional<Hit>{};
}

} // namespace scansion
