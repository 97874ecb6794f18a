// What the caller named as input, as a list of files in reading order, each readable more than once.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/notes.hpp"
#include "pipeline/import/temp_file.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace scansion {

/// One file of the input: a plain file, or a stretch of the spool or of standard input.
struct Member {
  std::string name;         ///< for errors, e.g. "scan.tar.xz:a/b.csv"
  std::string path;         ///< plain file to open; empty: `fd`
  int fd = -1;              ///< borrowed from MemberList
  std::uint64_t offset = 0; ///< bytes
  std::uint64_t size = 0;   ///< bytes
};

struct MemberList {
  std::vector<Member> members;
  TempFile spool;          ///< unpacked members and piped input
  UniqueFd standard_input; ///< when it is a plain file

  [[nodiscard]] std::uint64_t bytes() const noexcept;
};

/// Walks folders, opens archives and packed files. Names in folders and archives whose ending is not one of .xyz .txt .asc .csv
/// .ply (also packed) are passed over with one note. Plain files are left where they are; everything else is unpacked into an
/// unnamed temporary file.
[[nodiscard]] Result<MemberList> list_members(const std::vector<std::string>& inputs, const std::string& name_for_stdin,
                                              Notes& notes);

/// Ending of `name` in lower case without the dot, .gz .xz .zst left out: "a/B.CSV.xz" gives "csv".
[[nodiscard]] std::string ending_of(std::string_view name);

/// Whether `start`, the first bytes of a file, begins a PLY file.
[[nodiscard]] bool starts_ply(std::string_view start) noexcept;
/// Whether `start`, the first bytes of a file, is neither text nor PLY.
[[nodiscard]] bool is_binary(std::string_view start) noexcept;

} // namespace scansion
