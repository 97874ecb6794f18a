// A bounded window that moves over one member of the input.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/members.hpp"

#include <cstdint>
#include <string_view>
#include <vector>

namespace scansion {

inline constexpr std::size_t kMaxRow = 4096; ///< bytes in one text row

/// Reads a member from its start to its end. Rows are handed out inside the window, always followed by a line feed (one is
/// added after the last row), so that parsers need no bounds.
class ByteWindow {
public:
  [[nodiscard]] static Result<ByteWindow> open(const Member& member);

  /// Makes at least `want` bytes (at most kWindow) available, fewer only at the end of the member.
  [[nodiscard]] Result<void> fill(std::size_t want);
  [[nodiscard]] std::size_t available() const noexcept { return static_cast<std::size_t>(end_ - begin_); }
  [[nodiscard]] const char* data() const noexcept { return begin_; }
  void consume(std::size_t n) noexcept { begin_ += n; }

  /// The next row, without its line feed; false at the end of the member.
  [[nodiscard]] Result<bool> next_row(std::string_view& row);
  /// Number of the row that next_row() gave last, from 1.
  [[nodiscard]] std::uint64_t row_number() const noexcept { return row_; }
  /// Bytes of the member in front of the window.
  [[nodiscard]] std::uint64_t position() const noexcept { return read_ - available(); }
  [[nodiscard]] std::uint64_t remaining() const noexcept { return size_ - position(); }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// "file:row" of the last row.
  [[nodiscard]] std::string where() const { return name_ + ":" + std::to_string(row_); }

  static constexpr std::size_t kWindow = std::size_t{1} << 18U;

private:
  ByteWindow() = default;
  Result<bool> next_row_slowly(std::string_view& row);

  std::string name_;
  UniqueFd owned_;
  int fd_ = -1;
  std::uint64_t offset_ = 0, size_ = 0, read_ = 0; ///< bytes; read_ counts from the member's start
  std::uint64_t row_ = 0;
  std::vector<char> buffer_;
  char* begin_ = nullptr;
  char* end_ = nullptr;
};

/// `text` for an error message: quoted, at most 24 characters, bytes that cannot be printed as \xNN.
[[nodiscard]] std::string quoted(std::string_view text);

} // namespace scansion
