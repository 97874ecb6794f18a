// The newest raw bytes of a device.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/raw_ring.hpp"

#include <algorithm>
#include <cstring>

namespace scansion {

void RawRing::put(const void* data, std::size_t size) noexcept {
  if (size == 0) return;
  const std::size_t at = (first_ + used_) % kBytes;
  const std::size_t head = std::min(size, kBytes - at);
  std::memcpy(ring_.data() + at, data, head);
  if (size > head) std::memcpy(ring_.data(), static_cast<const std::uint8_t*>(data) + head, size - head);
  used_ += size;
}

void RawRing::get(std::size_t from, void* data, std::size_t size) const noexcept {
  if (size == 0) return;
  from %= kBytes;
  const std::size_t head = std::min(size, kBytes - from);
  std::memcpy(data, ring_.data() + from, head);
  if (size > head) std::memcpy(static_cast<std::uint8_t*>(data) + head, ring_.data(), size - head);
}

void RawRing::drop_oldest() noexcept {
  Head head;
  get(first_, &head, sizeof head);
  const std::size_t whole = sizeof head + head.size;
  first_ = (first_ + whole) % kBytes;
  used_ -= whole;
}

void RawRing::push(RawEvent::Kind kind, const Moment& at, std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  if (kind == RawEvent::Kind::received) received_ = true;
  bytes = bytes.last(std::min(bytes.size(), kBytes / 2));
  const Head head{kind, at, static_cast<std::uint32_t>(bytes.size())};
  while (used_ + sizeof head + bytes.size() > kBytes) drop_oldest();
  put(&head, sizeof head);
  put(bytes.data(), bytes.size());
}

std::string RawRing::transcript() const {
  const std::lock_guard lock(mutex_);
  std::string text;
  if (used_ == 0) return text;
  text = kTranscriptHeading;
  std::vector<std::uint8_t> bytes;
  for (std::size_t at = 0; at < used_;) {
    Head head;
    get(first_ + at, &head, sizeof head);
    bytes.resize(head.size);
    get(first_ + at + sizeof head, bytes.data(), bytes.size());
    append_event(text, head.kind, head.at, bytes);
    at += sizeof head + head.size;
  }
  return text;
}

bool RawRing::has_received() const {
  const std::lock_guard lock(mutex_);
  return received_;
}

} // namespace scansion
