// One element table of a PLY file, read row by row.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/number.hpp"
#include "pipeline/import/ply_header.hpp"

namespace scansion {

/// What is wanted of one instance of an element.
struct PlyRecord {
  std::array<Number, 4> values; ///< by slot; of a list its first item
  std::uint64_t list_count = 0; ///< items of the last wanted list
};

/// Reads the instances of one element in order. `slots` names for each property the place in PlyRecord::values, or kIgnore.
class PlyElementReader {
public:
  static constexpr std::uint8_t kIgnore = 255;

  PlyElementReader(const PlyElement& element, PlyEncoding encoding, std::vector<std::uint8_t> slots);

  /// Fails when the rest of the file cannot hold what the header claims.
  [[nodiscard]] Result<void> check_room(const ByteWindow& window) const;
  [[nodiscard]] Result<void> read(ByteWindow& window, PlyRecord& record);
  [[nodiscard]] bool done() const noexcept { return index_ == element_.count; }
  /// Instances read.
  [[nodiscard]] std::uint64_t index() const noexcept { return index_; }

private:
  [[nodiscard]] bool parse_row(const char* p, PlyRecord& record) const noexcept;
  [[nodiscard]] Result<void> read_text(ByteWindow& window, PlyRecord& record);
  [[nodiscard]] Result<void> read_text_property(const ByteWindow& window, std::size_t property, std::string_view& row,
                                                PlyRecord& record) const;
  [[nodiscard]] Result<void> read_fixed(ByteWindow& window, PlyRecord& record);
  [[nodiscard]] Result<void> read_lists(ByteWindow& window, PlyRecord& record);
  [[nodiscard]] Result<void> skip(ByteWindow& window, std::uint64_t bytes);
  [[nodiscard]] Result<void> need(ByteWindow& window, std::size_t bytes);
  [[nodiscard]] Number decode(PlyType type, const char* p) const noexcept;
  [[nodiscard]] Error cut_off(const ByteWindow& window) const;

  const PlyElement& element_;
  PlyEncoding encoding_;
  std::vector<std::uint8_t> slots_;
  bool lists_ = false;     ///< some property is a list
  std::size_t stride_ = 0; ///< bytes of an instance without its lists' items
  std::size_t wanted_ = 0; ///< properties up to the last wanted one
  std::uint64_t index_ = 0;
};

} // namespace scansion
