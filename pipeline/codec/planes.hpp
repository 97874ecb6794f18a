// Byte strings and integer arrays, packed: the two building blocks of payload bodies (docs/FORMAT.md, "Blob" and "Planes").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/varint.hpp"

#include <memory>
#include <span>

namespace scansion {

/// Compresses; holds a zstd context. One object, one thread.
class PlaneWriter {
public:
  /// Quick packing takes two thirds of the time. Residuals of axes come out no larger by it, IEEE residuals by a hundredth.
  enum class Effort : std::uint8_t { usual, quick };
  PlaneWriter();
  ~PlaneWriter();
  PlaneWriter(PlaneWriter&&) noexcept;
  PlaneWriter& operator=(PlaneWriter&&) noexcept;

  /// A byte string with its length in front.
  void put_blob(Bytes& to, ByteView raw);
  /// Signed integers whose count the reader knows: zigzag, then one plane per byte of the largest.
  void put_planes(Bytes& to, std::span<const std::int64_t> values, Effort effort = Effort::usual);

private:
  void put_packed(Bytes& to, ByteView raw, Effort effort);
  struct Context;
  std::unique_ptr<Context> context_;
  std::vector<std::uint64_t> zigzags_; ///< memory
  Bytes plane_;
};

/// Unpacks. Allocates what the caller allows and not a byte more.
class PlaneReader {
public:
  PlaneReader();
  ~PlaneReader();
  PlaneReader(PlaneReader&&) noexcept;
  PlaneReader& operator=(PlaneReader&&) noexcept;

  /// Fails with damaged when the string is longer than `limit`.
  [[nodiscard]] Result<void> get_blob(ByteReader& from, std::size_t limit, Bytes& raw);
  [[nodiscard]] Result<void> get_planes(ByteReader& from, std::size_t count, std::vector<std::int64_t>& values);

private:
  [[nodiscard]] Result<void> get_packed(ByteReader& from, std::span<std::byte> raw);
  struct Context;
  std::unique_ptr<Context> context_;
  Bytes plane_;
};

} // namespace scansion
