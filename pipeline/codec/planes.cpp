// Byte strings and integer arrays, packed with zstd where that is smaller.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/planes.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>
#include <zstd.h>

namespace scansion {
namespace {

constexpr int kZstdLevel = 3;
constexpr int kQuickZstdLevel = 1;
constexpr std::uint64_t kRaw = 0;
constexpr std::uint64_t kZstd = 1;
constexpr std::uint64_t kConstant = 2;
constexpr std::size_t kMaxPlanes = 8;

} // namespace

struct PlaneWriter::Context {
  ZSTD_CCtx* zstd = ZSTD_createCCtx();
  Bytes packed;
  Context() {
    if (zstd == nullptr) throw std::bad_alloc();
    // The reader knows the size, and payloads carry their own checksum.
    ZSTD_CCtx_setParameter(zstd, ZSTD_c_contentSizeFlag, 0);
    ZSTD_CCtx_setParameter(zstd, ZSTD_c_checksumFlag, 0);
  }
  ~Context() { ZSTD_freeCCtx(zstd); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
};

PlaneWriter::PlaneWriter() : context_(std::make_unique<Context>()) {}
PlaneWriter::~PlaneWriter() = default;
PlaneWriter::PlaneWriter(PlaneWriter&&) noexcept = default;
PlaneWriter& PlaneWriter::operator=(PlaneWriter&&) noexcept = default;

void PlaneWriter::put_packed(Bytes& to, ByteView raw, Effort effort) {
  if (raw.empty()) return;
  if (std::all_of(raw.begin(), raw.end(), [&](std::byte b) { return b == raw.front(); })) {
    put_varint(to, (1U << 2U) | kConstant);
    to.push_back(raw.front());
    return;
  }
  Bytes& packed = context_->packed;
  packed.resize(std::max(packed.size(), ZSTD_compressBound(raw.size())));
  ZSTD_CCtx_setParameter(context_->zstd, ZSTD_c_compressionLevel, effort == Effort::quick ? kQuickZstdLevel : kZstdLevel);
  const std::size_t size = ZSTD_compress2(context_->zstd, packed.data(), packed.size(), raw.data(), raw.size());
  const bool smaller = ZSTD_isError(size) == 0 && size < raw.size();
  const ByteView stored = smaller ? ByteView(packed).first(size) : raw;
  put_varint(to, (std::uint64_t{stored.size()} << 2U) | (smaller ? kZstd : kRaw));
  to.insert(to.end(), stored.begin(), stored.end());
}

void PlaneWriter::put_blob(Bytes& to, ByteView raw) {
  put_varint(to, raw.size());
  put_packed(to, raw, Effort::usual);
}

void PlaneWriter::put_planes(Bytes& to, std::span<const std::int64_t> values, Effort effort) {
  std::uint64_t all = 0;
  zigzags_.resize(std::max(zigzags_.size(), values.size()));
  std::uint64_t* const folded = zigzags_.data();
  for (std::size_t i = 0; i < values.size(); ++i) all |= folded[i] = zigzag(values[i]);
  const auto width = static_cast<std::size_t>(std::bit_width(all) + 7) / 8;
  to.push_back(static_cast<std::byte>(width));
  plane_.resize(std::max(plane_.size(), values.size()));
  std::byte* const plane = plane_.data();
  for (std::size_t p = 0; p < width; ++p) {
    for (std::size_t i = 0; i < values.size(); ++i) plane[i] = static_cast<std::byte>(folded[i] >> (8 * p));
    put_packed(to, ByteView(plane_).first(values.size()), effort);
  }
}

struct PlaneReader::Context {
  ZSTD_DCtx* zstd = ZSTD_createDCtx();
  Context() {
    if (zstd == nullptr) throw std::bad_alloc();
  }
  ~Context() { ZSTD_freeDCtx(zstd); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
};

PlaneReader::PlaneReader() : context_(std::make_unique<Context>()) {}
PlaneReader::~PlaneReader() = default;
PlaneReader::PlaneReader(PlaneReader&&) noexcept = default;
PlaneReader& PlaneReader::operator=(PlaneReader&&) noexcept = default;

Result<void> PlaneReader::get_packed(ByteReader& from, std::span<std::byte> raw) {
  if (raw.empty()) return success();
  const std::uint64_t head = from.varint();
  const ByteView stored = from.bytes(head >> 2U);
  if (!from.ok()) return fail(Errc::damaged, "packed bytes are cut short");
  switch (head & 3U) {
    case kRaw:
      if (stored.size() != raw.size()) return fail(Errc::damaged, "packed bytes have the wrong length");
      std::memcpy(raw.data(), stored.data(), raw.size());
      return success();
    case kConstant:
      if (stored.size() != 1) return fail(Errc::damaged, "packed bytes have the wrong length");
      std::fill(raw.begin(), raw.end(), stored.front());
      return success();
    case kZstd: {
      const std::size_t size = ZSTD_decompressDCtx(context_->zstd, raw.data(), raw.size(), stored.data(), stored.size());
      if (ZSTD_isError(size) != 0 || size != raw.size()) return fail(Errc::damaged, "packed bytes do not unpack");
      return success();
    }
    default: return fail(Errc::damaged, "packed bytes name an unknown method");
  }
}

Result<void> PlaneReader::get_blob(ByteReader& from, std::size_t limit, Bytes& raw) {
  const std::uint64_t size = from.varint();
  if (!from.ok() || size > limit) return fail(Errc::damaged, "a byte string is longer than it can be");
  raw.resize(static_cast<std::size_t>(size));
  return get_packed(from, raw);
}

Result<void> PlaneReader::get_planes(ByteReader& from, std::size_t count, std::vector<std::int64_t>& values) {
  const std::size_t width = from.byte();
  if (!from.ok() || width > kMaxPlanes) return fail(Errc::damaged, "an integer array has an impossible width");
  values.assign(count, 0);
  plane_.resize(count);
  for (std::size_t p = 0; p < width; ++p) {
    SCANSION_TRY(get_packed(from, plane_));
    for (std::size_t i = 0; i < count; ++i)
      values[i] =
          static_cast<std::int64_t>(static_cast<std::uint64_t>(values[i]) | static_cast<std::uint64_t>(plane_[i]) << (8 * p));
  }
  for (std::int64_t& v : values) v = unzigzag(static_cast<std::uint64_t>(v));
  return success();
}

} // namespace scansion
