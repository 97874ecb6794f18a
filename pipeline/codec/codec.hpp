// Groups of ranked scan lines to payloads and back, level by level (docs/FORMAT.md).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/payload.hpp"
#include "pipeline/model/alpha_set.hpp"
#include "pipeline/model/scan_line.hpp"

#include <memory>

namespace scansion {

/// D and depth of every point of a group, in the order of LineGroup::xyz.
struct GroupRanks {
  std::vector<double> distance; ///< mm; +infinity for end points of runs
  std::vector<std::uint32_t> depth;
};

/// Log time of a line in ns: its host realtime stamp; without one, line index * 1 ms.
[[nodiscard]] std::uint64_t log_time_ns(const ScanLine& line) noexcept;

/// Encodes groups. Holds scratch memory: one object, one thread. The output is a function of the arguments alone.
class GroupEncoder {
public:
  GroupEncoder();
  ~GroupEncoder();
  GroupEncoder(GroupEncoder&&) noexcept;
  GroupEncoder& operator=(GroupEncoder&&) noexcept;

  void encode(const LineGroup& group, const GroupRanks& ranks, const AlphaSet& alpha, std::uint32_t stream, EncodedGroup& out);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A group as far as it has been read.
struct DecodedGroup {
  static constexpr std::uint8_t kUnknown = 0xFF;

  LineGroup group;                 ///< all lines and runs; points that are not known yet hold 0
  std::vector<std::uint8_t> width; ///< per point: its alpha-width, or kUnknown while it is not known
  std::uint32_t levels = 0;        ///< n
  std::uint32_t known_levels = 0;  ///< how many of lod0 .. rest have been read: n + 1 means lossless
  AlphaSet alpha;                  ///< tolerances of the levels read
  double left_out = 0.0;           ///< mm: exact largest distance left out at this state

  [[nodiscard]] bool lossless() const noexcept { return known_levels == levels + 1; }
};

/// Decodes payloads in the order lines, lod0, lod1, ..., rest. Every byte is treated as hostile: errors are values, memory is
/// bounded by the checked counts of the line table.
class GroupDecoder {
public:
  GroupDecoder();
  ~GroupDecoder();
  GroupDecoder(GroupDecoder&&) noexcept;
  GroupDecoder& operator=(GroupDecoder&&) noexcept;

  /// Starts a group from its line table. Checks the checksum.
  [[nodiscard]] Result<void> begin(ByteView lines_payload, DecodedGroup& out);
  /// Adds the next level (lod<k> with k = out.known_levels, or rest when k = n). Checks the checksum and that the payload
  /// belongs to the same stream and group.
  [[nodiscard]] Result<void> add(ByteView level_payload, DecodedGroup& out);

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

} // namespace scansion
