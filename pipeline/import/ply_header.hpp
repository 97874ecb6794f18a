// The header of a PLY file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/byte_window.hpp"

#include <optional>
#include <string>
#include <vector>

namespace scansion {

enum class PlyEncoding : std::uint8_t { ascii, little, big };
enum class PlyType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

[[nodiscard]] std::size_t size_of(PlyType type) noexcept;
[[nodiscard]] constexpr bool is_integer(PlyType type) noexcept {
  return type < PlyType::f32;
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::f32;
  std::optional<PlyType> count_type; ///< of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0; ///< a claim: nothing is allocated from it
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::optional<std::uint64_t> num_cols, num_rows; ///< obj_info of range grids

  [[nodiscard]] const PlyElement* find(std::string_view name) const noexcept;
};

/// Reads the header; `window` then stands at the first byte after it.
[[nodiscard]] Result<PlyHeader> read_ply_header(ByteWindow& window);

} // namespace scansion
