// What stands in a record of a described stream.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/stream/field.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace scansion::stream {
namespace {

constexpr std::pair<std::string_view, Role> kRoles[] = {
    {"-", Role::ignored},       {"x", Role::x},     {"y", Role::y}, {"z", Role::z}, {"line", Role::line}, {"time", Role::time},
    {"encoder", Role::encoder}, {"bad", Role::bad},
};

std::optional<Storage> parse_storage(std::string_view text) {
  Storage out;
  if (text.size() < 2) return std::nullopt;
  const bool has_order = text.ends_with("le") || text.ends_with("be");
  out.is_big_endian = text.ends_with("be");
  const std::string_view type = has_order ? text.substr(0, text.size() - 2) : text;
  const char kind = type.front();
  const std::string_view bits = type.substr(1);
  out.is_float = kind == 'f';
  out.is_signed = kind == 'i';
  if (kind != 'f' && kind != 'i' && kind != 'u') return std::nullopt;
  if (bits == "8" && kind != 'f') out.bytes = 1;
  if (bits == "16" && kind != 'f') out.bytes = 2;
  if (bits == "24" && kind != 'f') out.bytes = 3;
  if (bits == "32") out.bytes = 4;
  if (bits == "64") out.bytes = 8;
  if (out.bytes == 0 || (out.bytes > 1 && !has_order)) return std::nullopt;
  return out;
}

Result<Field> parse_field(std::string_view word, bool is_binary) {
  Field field;
  if (word.front() == '=') {
    if (is_binary)
      return fail(Errc::config, "has \"", word, "\" in a binary record; use sync for bytes that are always the same");
    if (word.size() == 1) return fail(Errc::config, "has an = without a text behind it");
    field.role = Role::literal;
    field.text = word.substr(1);
    return field;
  }
  const std::string_view whole = word;
  if (const std::size_t star = word.find('*'); star != std::string_view::npos) {
    auto scale = parse_rational(word.substr(star + 1));
    if (!scale) return fail(Errc::config, "has \"", whole, "\", whose scale is no positive decimal; write such as x*0.001");
    field.scale = scale.assume_value();
    word = word.substr(0, star);
  }
  const std::size_t colon = word.find(':');
  if (is_binary != (colon != std::string_view::npos)) {
    return fail(Errc::config, "has \"", whole,
                is_binary ? "\" without a type; write such as x:i32le" : "\" with a type in text; leave it out");
  }
  if (is_binary) {
    const auto storage = parse_storage(word.substr(colon + 1));
    if (!storage) {
      return fail(Errc::config, "has \"", whole,
                  "\", whose type is none of u8, i8, u16, i16, u24, i24, u32, i32, u64, i64, f32, f64 with le or be behind it");
    }
    field.storage = *storage;
    word = word.substr(0, colon);
  }
  const auto* at = std::find_if(std::begin(kRoles), std::end(kRoles), [&](const auto& role) { return role.first == word; });
  if (at == std::end(kRoles)) {
    return fail(Errc::config, "has \"", whole, "\", which is none of x, y, z, line, time, encoder, bad, - and =TEXT");
  }
  field.role = at->second;
  if (field.storage.is_float && (field.role == Role::line || field.role == Role::encoder)) {
    return fail(Errc::config, "has \"", whole, "\", which counts and cannot be a float");
  }
  return field;
}

} // namespace

Result<std::vector<Field>> parse_fields(std::string_view text, bool is_binary) {
  constexpr std::size_t kMostFields = 64;
  std::vector<Field> out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    if (end > 0) {
      SCANSION_TRY(field, parse_field(text.substr(0, end), is_binary));
      if (field.role != Role::ignored && field.role != Role::literal && has(out, field.role)) {
        return fail(Errc::config, "names \"", text.substr(0, end), "\" twice");
      }
      out.push_back(std::move(field));
    }
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (!has(out, Role::x) || !has(out, Role::z))
    return fail(Errc::config, "has not both x and z; without y, lines stand by spacing");
  if (out.size() > kMostFields) return fail(Errc::config, "has more than 64 fields");
  return out;
}

bool has(const std::vector<Field>& fields, Role role) noexcept {
  return std::any_of(fields.begin(), fields.end(), [&](const Field& field) { return field.role == role; });
}

std::size_t bytes_of(const std::vector<Field>& fields) noexcept {
  std::size_t sum = 0;
  for (const Field& field : fields) sum += field.storage.bytes;
  return sum;
}

} // namespace scansion::stream
