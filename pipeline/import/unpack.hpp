// Packed files and tar archives, unpacked into a spool.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/members.hpp"

#include <functional>

namespace scansion {

enum class Packing : std::uint8_t {
  none,   ///< plain
  packed, ///< gzip, xz or zstd; what is inside is unknown
  tar     ///< a plain tar archive
};

inline constexpr std::size_t kSniffBytes = 4096;

[[nodiscard]] Packing packing_of(std::string_view start) noexcept;

/// Where packed bytes come from.
struct PackedSource {
  int fd = -1;
  bool seekable = false; ///< read `size` bytes at `offset`; else read on to the end
  std::uint64_t offset = 0;
  std::uint64_t size = 0;
};

struct UnpackPlan {
  bool archives = true;                                  ///< look for tar; else a tar archive is just bytes
  std::function<bool(const std::string& member)> wanted; ///< asked for the members of an archive
};

/// Unpacks `source`, called `name`, to the end of `list.spool` and adds what it holds to `list.members`: one member for a
/// packed file, one for each wanted file of an archive, in the archive's order. Stops at the first block of a member that is
/// binary.
[[nodiscard]] Result<void> unpack(const PackedSource& source, const std::string& name, const UnpackPlan& plan,
                                  MemberList& list);

} // namespace scansion
