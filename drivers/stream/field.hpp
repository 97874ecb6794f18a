// What stands in a record of a described stream, field by field.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/lattice.hpp"

#include <string>
#include <vector>

namespace scansion::stream {

enum class Role : std::uint8_t {
  ignored,
  literal, ///< this very text
  x,
  y,
  z,
  line,    ///< number of the scan line
  time,    ///< seconds of the device's clock
  encoder, ///< counts
  bad      ///< not 0: the sample is invalid
};

/// How a field of a binary record is stored.
struct Storage {
  std::uint8_t bytes = 0; ///< 1 to 8; 0: text
  bool is_signed = false, is_float = false, is_big_endian = false;

  friend bool operator==(const Storage&, const Storage&) = default;
};

struct Field {
  Role role = Role::ignored;
  Storage storage;
  Rational scale{1, 1}; ///< what one stands for: units (x, y, z), seconds (time)
  std::string text;     ///< of a literal
};

/// `NAME[:TYPE][*SCALE]` parted by spaces, such as "x y z" or "line:u16le x:i32le*0.0005 z:i16le*0.001". NAME is x, y, z, line,
/// time, encoder, bad, - (anything) or =TEXT; TYPE is needed in binary records and not allowed in text. The context of its
/// error is the reason.
[[nodiscard]] Result<std::vector<Field>> parse_fields(std::string_view text, bool is_binary);
[[nodiscard]] bool has(const std::vector<Field>& fields, Role role) noexcept;
/// Bytes of a binary record's fields.
[[nodiscard]] std::size_t bytes_of(const std::vector<Field>& fields) noexcept;

} // namespace scansion::stream
