// The subset of MCAP (https://mcap.dev/spec) that a recording uses: record framing, and its values to and from bytes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/payload.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scansion::mcap {

enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  data_end = 0x0F
};

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};

/// Bytes of the parts whose size never changes here.
inline constexpr std::size_t kRecordHead = 9;   ///< opcode and length of any record
inline constexpr std::size_t kChunkHead = 49;   ///< of a Chunk without compression, before its records
inline constexpr std::size_t kMessageHead = 31; ///< of a Message, before its data
inline constexpr std::size_t kDataEnd = 13;     ///< a whole DataEnd
inline constexpr std::size_t kFooter = 29;      ///< a whole Footer
/// From the start of a chunk to the data of its first message; the most with a schema and a channel before that message.
inline constexpr std::size_t kFirstData = kChunkHead + kMessageHead;
inline constexpr std::size_t kMaxFirstData = kFirstData + 512;

/// A whole MessageIndex of so many messages.
[[nodiscard]] constexpr std::uint64_t message_index_size(std::uint64_t messages) noexcept {
  return kRecordHead + 6 + 16 * messages;
}

using Entries = std::vector<std::pair<std::string, std::string>>;

/// Appends values and records to a buffer.
class Builder {
public:
  explicit Builder(Bytes& out) noexcept : out_(&out) {}

  void u8(std::uint8_t v);
  void u16(std::uint16_t v);
  void u32(std::uint32_t v);
  void u64(std::uint64_t v);
  void raw(std::string_view bytes);
  void string(std::string_view text); ///< u32 length, bytes
  void entries(const Entries& map);   ///< Map<string, string>: u32 byte length, pairs

  /// Starts a record; end() with the same value writes its length.
  [[nodiscard]] std::size_t begin(Opcode opcode);
  void end(std::size_t begun);
  /// Starts a record whose content is `length` bytes.
  void begin_sized(Opcode opcode, std::uint64_t length);

private:
  Bytes* out_;
};

/// Reads values from bytes. After a read beyond the end, ok() is false and all values are 0 or empty.
class Cursor {
public:
  explicit Cursor(ByteView bytes) noexcept : bytes_(bytes) {}

  [[nodiscard]] std::uint8_t u8() noexcept;
  [[nodiscard]] std::uint16_t u16() noexcept;
  [[nodiscard]] std::uint32_t u32() noexcept;
  [[nodiscard]] std::uint64_t u64() noexcept;
  [[nodiscard]] ByteView take(std::uint64_t count) noexcept;
  [[nodiscard]] std::string string();
  [[nodiscard]] Entries entries();

  [[nodiscard]] bool ok() const noexcept { return ok_; }
  [[nodiscard]] bool at_end() const noexcept { return ok_ && bytes_.empty(); }

private:
  ByteView bytes_;
  bool ok_ = true;
};

struct RecordHead {
  std::uint8_t opcode = 0;
  std::uint64_t length = 0; ///< of the content
};
/// The first nine bytes of a record; opcode 0 (which no record has) when there are fewer.
[[nodiscard]] RecordHead record_head(ByteView bytes) noexcept;
[[nodiscard]] inline bool is(const RecordHead& head, Opcode opcode) noexcept {
  return head.opcode == static_cast<std::uint8_t>(opcode);
}

/// CRC-32 as MCAP uses it (zlib's), continued from `crc`.
[[nodiscard]] std::uint32_t crc32(std::uint32_t crc, ByteView bytes) noexcept;
/// The CRC-32 of two stretches, from theirs and the length of the second.
[[nodiscard]] std::uint32_t crc32_joined(std::uint32_t first, std::uint32_t second, std::uint64_t second_length) noexcept;

[[nodiscard]] bool same(ByteView a, ByteView b) noexcept;
/// How many bytes at the start of `a` and `b` are the same.
[[nodiscard]] std::size_t same_bytes(ByteView a, ByteView b) noexcept;

[[nodiscard]] inline ByteView bytes_of(std::string_view text) noexcept {
  return std::as_bytes(std::span(text));
}
[[nodiscard]] inline std::string_view text_of(ByteView bytes) noexcept {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

} // namespace scansion::mcap
