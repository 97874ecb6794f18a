// Fields of one text row, and what the columns mean.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/text_fields.hpp"

#include "pipeline/import/number.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace scansion {
namespace {

bool is_blank(char c, Delimiter delimiter) noexcept {
  return c == ' ' || c == '\r' || (c == '\t' && delimiter != Delimiter::tab);
}

bool is_delimiter(char c, Delimiter delimiter) noexcept {
  if (delimiter == Delimiter::any) return c == ',' || c == ';';
  return delimiter != Delimiter::blanks && c == static_cast<char>(delimiter);
}

std::string_view trim(std::string_view text, Delimiter delimiter) noexcept {
  while (!text.empty() && is_blank(text.front(), delimiter)) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back(), delimiter)) text.remove_suffix(1);
  return text;
}

std::size_t field_end(std::string_view text, Delimiter delimiter) noexcept {
  const bool blanks_end = delimiter == Delimiter::any || delimiter == Delimiter::blanks;
  std::size_t i = 0;
  while (i < text.size() && !is_delimiter(text[i], delimiter) && !(blanks_end && is_blank(text[i], delimiter))) ++i;
  return i;
}

} // namespace

RowText strip_row(std::string_view row, Delimiter delimiter) noexcept {
  const std::size_t hash = row.find('#');
  return {trim(row.substr(0, hash), delimiter), hash != std::string_view::npos};
}

bool split_fields(std::string_view text, Delimiter delimiter, std::size_t most, std::vector<std::string_view>& fields) {
  fields.clear();
  char between = '\0';
  while (fields.size() < most) {
    const std::size_t length = field_end(text, delimiter);
    fields.push_back(trim(text.substr(0, length), delimiter));
    const std::string_view rest = trim(text.substr(length), delimiter);
    if (rest.empty()) return true;
    const bool separated = is_delimiter(rest.front(), delimiter);
    const char here = separated ? rest.front() : ' ';
    if (delimiter == Delimiter::any && fields.size() + 1 < most && between != '\0' && between != here) return false;
    between = here;
    text = separated ? rest.substr(1) : rest;
    while (!text.empty() && is_blank(text.front(), delimiter)) text.remove_prefix(1);
    if (text.empty() && fields.size() < most) {
      fields.emplace_back(); // the row ends with a delimiter
      return true;
    }
  }
  return true;
}

Delimiter find_delimiter(std::string_view text) noexcept {
  for (const Delimiter d : {Delimiter::semicolon, Delimiter::comma, Delimiter::tab})
    if (text.find(static_cast<char>(d)) != std::string_view::npos) return d;
  return Delimiter::blanks;
}

bool is_heading(const std::vector<std::string_view>& fields) noexcept {
  const auto first = std::find_if(fields.begin(), fields.end(), [](std::string_view f) { return !f.empty(); });
  if (first == fields.end()) return false;
  const char c = first->front();
  if (!(c == '"' || c == '_' || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'))) return false;
  Number number;
  return parse_number(first->data(), number) == nullptr; // nan and inf are numbers
}

Column column_named(std::string_view field) {
  std::string name;
  for (const char c : field) {
    if (c == '"') continue;
    if (!name.empty() && (c == ' ' || c == '[' || c == '(')) break; // a unit follows
    if (c != ' ') name += c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c;
  }
  if (name == "x") return Column::x;
  if (name == "y") return Column::y;
  if (name == "z") return Column::z;
  if (name == "line") return Column::line;
  return Column::skip;
}

Result<std::vector<Column>> parse_columns(std::string_view option) {
  std::vector<std::string_view> names;
  static_cast<void>(split_fields(option, Delimiter::comma, option.size() + 1, names));
  std::vector<Column> columns;
  std::array<int, 4> seen{};
  for (const std::string_view name : names) {
    const Column column = column_named(name);
    if (column == Column::skip && name != "-")
      return fail(Errc::usage, "columns: unknown column \"", name, "\"; use x, y, z, line or - for each column");
    if (column != Column::skip && ++seen[static_cast<std::size_t>(column)] > 1)
      return fail(Errc::usage, "columns: \"", name, "\" is named twice; name it once");
    columns.push_back(column);
  }
  if (seen[static_cast<std::size_t>(Column::x)] == 0 || seen[static_cast<std::size_t>(Column::z)] == 0)
    return fail(Errc::usage, "columns: \"", option, "\" has no x or no z; name both, e.g. x,z or x,y,z");
  return columns;
}

} // namespace scansion
