// An axis of the rest as byte planes: what repeats itself in a way that no prediction sees is better left to zstd.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/planes.hpp"
#include "pipeline/codec/rest_coder.hpp"

namespace scansion {

/// Tries byte planes for one axis of a group. One object, one thread; memory is used again.
class PlainAxis {
public:
  /// A small part, of large groups from several places, says whether to try all. True when mode and planes, in bytes(), are
  /// fewer than `limit` bytes.
  [[nodiscard]] bool find(std::span<const Run> runs, std::span<const PointIndex> vertices, std::span<const std::int32_t> u,
                          std::size_t limit, PlaneWriter& planes);
  [[nodiscard]] ByteView bytes() const noexcept { return bytes_; }

private:
  static std::size_t take(std::span<const Run> runs, std::span<const PointIndex> vertices, std::span<const std::int32_t> u,
                          RestMode mode, std::span<std::int64_t> residuals) noexcept;
  void take_part(std::span<const Run> runs, std::span<const PointIndex> vertices, std::span<const std::int32_t> u,
                 RestMode mode, std::size_t most);
  [[nodiscard]] std::uint64_t bits() const noexcept;
  void put(RestMode mode, PlaneWriter& planes);

  std::vector<std::int64_t> memory_;
  std::span<const std::int64_t> residuals_;
  Bytes bytes_;
};

} // namespace scansion
