// The decoder of Gocator profiles: bytes to messages, and back into step.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/lmi-gocator/decoder.hpp"

#include <algorithm>

namespace scansion {

using gdp::get;

namespace {

/// With this many bytes the size of a stamp message follows from its other fields.
constexpr std::size_t kStampSize = 12;

bool is_stamp_size(const std::uint8_t* at, std::size_t size) noexcept {
  const auto count = get<std::uint32_t>(at + 6);
  const auto bytes = get<std::uint16_t>(at + 10);
  return count >= 1 && count <= GocatorDecoder::kMaxProfiles && bytes >= gdp::kOldStamp &&
         size == gdp::kStampHead + std::size_t{count} * bytes;
}

bool is_stamp(const std::uint8_t* at) noexcept {
  const auto type = static_cast<gdp::Type>(get<std::uint16_t>(at + 4) & ~gdp::kLastOfGroup);
  return type == gdp::Type::stamp && is_stamp_size(at, get<std::uint32_t>(at));
}

} // namespace

GocatorDecoder::Head GocatorDecoder::judge_stamp(std::size_t size) {
  if (message_.size() < gdp::kStampHead) return Head::short_of;
  if (!is_stamp_size(message_.data(), size) || size > kMaxMessage) return Head::wrong;
  size_ = size;
  return Head::whole;
}

GocatorDecoder::Head GocatorDecoder::judge_profile(gdp::Type type, std::size_t size) {
  if (message_.size() < gdp::kProfileHead) return Head::short_of;
  const auto attributes = get<std::uint16_t>(&message_[6]);
  profile_ = {};
  profile_.type = type;
  profile_.count = get<std::uint32_t>(&message_[8]);
  profile_.width = get<std::uint32_t>(&message_[12]);
  profile_.samples_at = gdp::kAttributes + attributes;
  if (attributes < gdp::kOldAttributes || profile_.count < 1 || profile_.count > kMaxProfiles || profile_.width > kMaxWidth)
    return Head::wrong;
  const std::size_t samples = std::size_t{profile_.count} * profile_.width * profile_.sample_bytes();
  if (size != profile_.samples_at + samples || size > kMaxMessage) return Head::wrong;
  size_ = size;
  return Head::whole;
}

/// What the head at the start of message_ says, as far as it is there. The sizes of stamps and profiles follow from their
/// other fields: hardly anything but a message passes.
GocatorDecoder::Head GocatorDecoder::judge() {
  if (message_.size() < gdp::kHead) return Head::short_of;
  const std::size_t size = get<std::uint32_t>(message_.data());
  const auto control = get<std::uint16_t>(&message_[4]);
  const auto number = static_cast<std::uint16_t>(control & ~gdp::kLastOfGroup);
  const auto type = static_cast<gdp::Type>(number);
  if (type == gdp::Type::stamp) return judge_stamp(size);
  if (is_searching_ || number >= gdp::kTypes || size < gdp::kHead) return Head::wrong;
  if (type == gdp::Type::point_cloud_profile || type == gdp::Type::uniform_profile) return judge_profile(type, size);
  if (size > kMaxOther) return Head::wrong;
  skip_ = size;
  note_other(type);
  return Head::other;
}

void GocatorDecoder::drop_first_byte() {
  if (!is_searching_) counters_.reject(Reject::framing);
  is_searching_ = true;
  message_.erase(message_.begin());
}

/// Another message says how long it is, but one wrong bit there would hide megabytes of profiles: so what is passed over is
/// watched for a stamp. message_ is the window meanwhile. False: `bytes` are used up.
bool GocatorDecoder::pass_over(std::span<const std::uint8_t> bytes, std::size_t& used) {
  constexpr std::size_t kPart = 4096;
  while (skip_ > 0) {
    const std::size_t part = std::min({skip_, bytes.size() - used, kPart});
    if (part == 0) return false;
    const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(used);
    message_.insert(message_.end(), from, from + static_cast<std::ptrdiff_t>(part));
    used += part;
    skip_ -= part;
    std::size_t at = 0;
    for (; at + kStampSize <= message_.size(); ++at) {
      if (!is_stamp(&message_[at])) continue;
      counters_.reject(Reject::framing);
      used -= message_.size() - (at + kStampSize);
      message_.resize(at + kStampSize);
      skip_ = 0;
      break;
    }
    message_.erase(message_.begin(), message_.begin() + static_cast<std::ptrdiff_t>(at));
    if (message_.size() == kStampSize) return true;
  }
  message_.clear();
  return true;
}

/// Moves bytes to message_ until it holds a whole message of stamps or profiles: true. False: `bytes` are used up.
bool GocatorDecoder::assemble(std::span<const std::uint8_t> bytes, std::size_t& used) {
  const auto take_until = [&](std::size_t wanted) {
    const std::size_t part = std::min(wanted - std::min(wanted, message_.size()), bytes.size() - used);
    const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(used);
    message_.insert(message_.end(), from, from + static_cast<std::ptrdiff_t>(part));
    used += part;
    return message_.size() >= wanted;
  };
  for (;;) {
    if (skip_ > 0 && !pass_over(bytes, used)) return false;
    if (size_ > 0) return take_until(size_);
    switch (judge()) {
      case Head::short_of:
        if (!take_until(message_.size() < gdp::kHead ? gdp::kHead : gdp::kProfileHead)) return false;
        break;
      case Head::whole: is_searching_ = false; break;
      case Head::wrong: drop_first_byte(); break;
      case Head::other:
        begin_message();
        counters_.accept();
        skip_ -= message_.size(); // a head, no more
        if (skip_ == 0) message_.clear();
        break;
    }
  }
}

} // namespace scansion
