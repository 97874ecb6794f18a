// Fields of one text row, and what the columns mean.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <cstddef>
#include <string_view>
#include <vector>

namespace scansion {

/// What stands between two fields.
enum class Delimiter : char {
  any = 0,      ///< blanks or tabs, or one comma or semicolon: the same throughout a row
  blanks = ' ', ///< blanks or tabs only
  comma = ',',
  semicolon = ';',
  tab = '\t'
};

enum class Column : unsigned char {
  x,
  y,
  z,
  line,  ///< a change of its text starts a new scan line
  label, ///< 0 or 1, not used
  skip
};

/// A row as it is, without comment and outer blanks.
struct RowText {
  std::string_view text;
  bool comment = false; ///< there was one
};
[[nodiscard]] RowText strip_row(std::string_view row, Delimiter delimiter) noexcept;

/// Cuts `text` (from strip_row, not empty) into at most `most` fields, with blanks around them taken off. False when
/// different delimiters stand between the first `most` - 1 fields. What comes after `most` fields is not looked at.
[[nodiscard]] bool split_fields(std::string_view text, Delimiter delimiter, std::size_t most,
                                std::vector<std::string_view>& fields);

/// The delimiter of a CSV file by one of its rows.
[[nodiscard]] Delimiter find_delimiter(std::string_view text) noexcept;

/// Whether a first row is a heading: its first field that is not empty is a word.
[[nodiscard]] bool is_heading(const std::vector<std::string_view>& fields) noexcept;

/// "x", "Y", "z [mm]", "\"line\"": the column of that name; anything else is skip.
[[nodiscard]] Column column_named(std::string_view field);

/// The option `columns`, e.g. "x,z,-".
[[nodiscard]] Result<std::vector<Column>> parse_columns(std::string_view option);

} // namespace scansion
