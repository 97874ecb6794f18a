// A view that slides over a file: bounded memory, whole records in sight, byte patterns found across block borders.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/file.hpp"

#include <optional>
#include <string_view>
#include <vector>

namespace scansion {

class Window {
public:
  /// The file must outlive the window. `size` is where the file ends for this window, however it grows meanwhile.
  Window(const File& file, std::uint64_t size) noexcept : file_(&file), size_(size) {}

  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  [[nodiscard]] const File& file() const noexcept { return *file_; }

  /// `count` bytes at `offset`, or as many as there are before the end. Valid until the next call of any function here.
  [[nodiscard]] Result<ByteView> view(std::uint64_t offset, std::uint64_t count);

private:
  const File* file_;
  std::uint64_t size_;
  std::uint64_t base_ = 0;
  std::size_t filled_ = 0;
  std::vector<std::byte> buffer_;
};

/// Finds byte patterns in a window, in order of their places. Moving forward costs one pass over the file however close the
/// hits stand, so that a hostile file cannot make the search quadratic.
class PatternFinder {
public:
  /// 1 to 64 bytes each; the strings must outlive the finder.
  PatternFinder(Window& window, std::span<const std::string_view> patterns);

  struct Hit {
    std::uint64_t offset = 0;
    std::size_t pattern = 0; ///< which one
  };
  /// The first place in [from, to) where a pattern starts; it may reach beyond `to`.
  [[nodiscard]] Result<std::optional<Hit>> find(std::uint64_t from, std::uint64_t to);

private:
  struct Pattern {
    std::string_view bytes;
    std::uint64_t next = 0; ///< first hit in the block at or after where the last search began; block end when none
    bool known = false;
  };
  [[nodiscard]] Result<std::optional<Hit>> find_in_block(std::uint64_t from);
  Window* window_;
  std::vector<Pattern> patterns_;
  std::uint64_t block_begin_ = 0;
  std::uint64_t block_end_ = 0;
};

} // namespace scansion
