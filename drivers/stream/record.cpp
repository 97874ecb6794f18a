// One record of a described stream: bytes to values on the lattice.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/stream/record.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

namespace scansion::stream {
namespace {

__extension__ using Wide = __int128;

constexpr std::int32_t kMostDecimals = 21; ///< with which 127 bits hold twice a divisor

constexpr bool is_separator(char c) noexcept {
  return c == ' ' || c == '\t' || c == ',' || c == ';';
}
constexpr bool is_letter(char c) noexcept {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// The next field of a row: parted by spaces, or by one comma or semicolon with any spaces. False: there is none.
bool take_word(std::string_view& row, bool& is_open, std::string_view& word) noexcept {
  const auto skip = [&] {
    while (!row.empty() && (row.front() == ' ' || row.front() == '\t')) row.remove_prefix(1);
  };
  skip();
  if (row.empty() && !std::exchange(is_open, false)) return false;
  is_open = false;
  const auto* end = std::find_if(row.begin(), row.end(), is_separator);
  word = std::string_view(row.begin(), static_cast<std::size_t>(end - row.begin()));
  row.remove_prefix(word.size());
  skip();
  if (row.empty() || (row.front() != ',' && row.front() != ';')) return true;
  row.remove_prefix(1);
  is_open = true; // something must follow, if only an empty field
  return true;
}

/// "X12.5", "x=12.5" and "x:12.5" are 12.5.
std::string_view without_label(std::string_view word) noexcept {
  std::string_view rest = word;
  while (!rest.empty() && is_letter(rest.front())) rest.remove_prefix(1);
  if (rest.size() == word.size()) return word;
  if (!rest.empty() && (rest.front() == '=' || rest.front() == ':')) rest.remove_prefix(1);
  const bool is_number = !rest.empty() && (rest.front() == '-' || rest.front() == '+' || rest.front() == '.' ||
                                           (rest.front() >= '0' && rest.front() <= '9'));
  return is_number ? rest : word;
}

/// What one of the field is worth in counts, or in ns.
Result<Rational> factor_of(const Field& field, Rational resolution) {
  if (field.role == Role::time) return multiply(field.scale, {1'000'000'000, 1});
  if (field.role == Role::x || field.role == Role::y || field.role == Role::z) {
    return multiply(field.scale, {resolution.den, resolution.num});
  }
  return Rational{1, 1};
}

} // namespace

std::optional<Rounded> round_to(const Number& number, Rational factor, std::int64_t most) noexcept {
  if (number.kind == NumberKind::decimal && number.exponent >= -kMostDecimals && number.exponent <= kMaxDigits) {
    Wide top = Wide{number.mantissa} * factor.num;
    Wide bottom = factor.den;
    for (std::int32_t i = 0; i > number.exponent; --i) bottom *= 10;
    for (std::int32_t i = 0; i < number.exponent; ++i) {
      top *= 10;
      if (top / factor.den > most || top / factor.den < -Wide{most}) return std::nullopt;
    }
    const Wide half = top >= 0 ? bottom : -bottom;
    const Wide nearest = (2 * top + half) / (2 * bottom);
    if (nearest > most || nearest < -Wide{most}) return std::nullopt;
    const Wide off = top - nearest * bottom;
    return Rounded{static_cast<std::int64_t>(nearest), std::abs(static_cast<double>(off) / static_cast<double>(bottom))};
  }
  const double value = to_double(number) * static_cast<double>(factor.num) / static_cast<double>(factor.den);
  if (!(std::abs(value) < static_cast<double>(most))) return std::nullopt;
  const double nearest = std::round(value);
  return Rounded{static_cast<std::int64_t>(nearest), std::abs(value - nearest)};
}

Result<RecordReader> RecordReader::create(const Plan& plan) {
  RecordReader out;
  out.fields_ = plan.fields;
  for (const Field& field : plan.fields) {
    auto factor = factor_of(field, plan.resolution);
    if (!factor)
      return fail(Errc::config, "a scale in fields and the resolution have no exact ratio; give both with fewer digits");
    out.factors_.push_back(factor.assume_value());
  }
  out.sum_ = plan.sum;
  out.sum_from_ = plan.sum_from;
  out.is_sum_big_endian_ = plan.is_sum_big_endian;
  out.null_ = plan.null;
  if (Number number; !plan.null.empty() && parse_number(plan.null.c_str(), number) == plan.null.c_str() + plan.null.size())
    out.null_number_ = number;
  if (plan.is_binary && !plan.null.empty() && !out.null_number_)
    return fail(Errc::config, "null = \"", plan.null, "\" is no number, which it must be for binary records");
  return out;
}

/// Puts a field's number where it belongs. False: it cannot be.
bool RecordReader::take(const Field& field, Rational factor, const Number& number, Record& out) {
  const bool is_null = number.kind == NumberKind::invalid;
  const auto whole = [&](std::optional<std::int64_t>& to, std::int64_t most) {
    const auto rounded = is_null ? std::nullopt : round_to(number, factor, most);
    if (rounded) to = rounded->value;
    return rounded && (field.role == Role::time || rounded->error == 0.0);
  };
  switch (field.role) {
    case Role::ignored:
    case Role::literal: return true;
    case Role::line: return whole(out.line, INT64_MAX / 2) && *out.line >= 0;
    case Role::time: return whole(out.time_ns, INT64_MAX / 2);
    case Role::encoder: return whole(out.encoder, INT64_MAX / 2);
    case Role::bad: out.is_invalid |= is_null || to_double(number) != 0.0; return true;
    case Role::x:
    case Role::y:
    case Role::z: break;
  }
  if (is_null) {
    out.is_invalid = true;
    return true;
  }
  const auto counts = round_to(number, factor, kMostCounts);
  if (!counts) return false;
  out.xyz[static_cast<std::size_t>(field.role) - static_cast<std::size_t>(Role::x)] = counts->value;
  rounding_ = std::max(rounding_, counts->error);
  return true;
}

bool RecordReader::cut_sum(std::string_view& row) const noexcept {
  const std::size_t digits = 2 * bytes_of(sum_);
  if (row.size() < digits + 1 + sum_from_ || row[row.size() - digits - 1] != '*') return false;
  const char* end = row.data() + row.size();
  std::uint32_t said = 0;
  const auto [stop, error] = std::from_chars(end - digits, end, said, 16);
  if (error != std::errc() || stop != end) return false;
  row.remove_suffix(digits + 1);
  const std::string_view summed = row.substr(sum_from_);
  return said == checksum(sum_, {reinterpret_cast<const std::uint8_t*>(summed.data()), summed.size()});
}

std::optional<Reject> RecordReader::read(std::string_view row, Record& out) {
  if (sum_ != Checksum::none && !cut_sum(row)) return Reject::checksum;
  bool is_open = false;
  std::string_view word;
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const Field& field = fields_[i];
    if (!take_word(row, is_open, word)) return Reject::count;
    if (field.role == Role::ignored) continue;
    if (field.role == Role::literal) {
      if (word != field.text) return Reject::framing;
      continue;
    }
    Number number = Number::none();
    if (!word.empty() && (null_.empty() || word != null_)) {
      word = without_label(word);
      if (parse_number(word.data(), number) != word.data() + word.size()) return Reject::value;
    }
    if (!take(field, factors_[i], number, out)) return Reject::value;
  }
  if (take_word(row, is_open, word)) return Reject::count;
  return std::nullopt;
}

Number RecordReader::load(const Storage& storage, const std::uint8_t* at) const noexcept {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < storage.bytes; ++i) {
    bits |= std::uint64_t{at[storage.is_big_endian ? storage.bytes - 1U - i : i]} << (8U * i);
  }
  if (storage.is_float) {
    const double value =
        storage.bytes == 4 ? double{std::bit_cast<float>(static_cast<std::uint32_t>(bits))} : std::bit_cast<double>(bits);
    return std::isfinite(value) ? Number::ieee(NumberKind::float64, value) : Number::none();
  }
  const unsigned unused = 64U - 8U * storage.bytes;
  if (storage.is_signed) return Number::whole(static_cast<std::int64_t>(bits << unused) >> unused);
  // Beyond 63 bits there is nothing that fits a lattice or a stamp.
  return bits <= INT64_MAX ? Number::whole(static_cast<std::int64_t>(bits))
                           : Number::ieee(NumberKind::float64, static_cast<double>(bits));
}

bool RecordReader::is_sum_right(std::span<const std::uint8_t> record) const noexcept {
  const std::size_t bytes = bytes_of(sum_);
  std::uint32_t said = 0;
  for (std::size_t i = 0; i < bytes; ++i) {
    said |= std::uint32_t{record[record.size() - bytes + (is_sum_big_endian_ ? bytes - 1U - i : i)]} << (8U * i);
  }
  return said == checksum(sum_, record.subspan(sum_from_, record.size() - bytes - sum_from_));
}

std::optional<Reject> RecordReader::read(std::span<const std::uint8_t> fields, Record& out) {
  const std::uint8_t* at = fields.data();
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    const Field& field = fields_[i];
    Number number = load(field.storage, at);
    at += field.storage.bytes;
    const bool is_place = field.role == Role::x || field.role == Role::y || field.role == Role::z;
    if (is_place && null_number_ && number.kind != NumberKind::invalid && to_double(number) == to_double(*null_number_))
      number = Number::none();
    if (!take(field, factors_[i], number, out)) return Reject::value;
  }
  return std::nullopt;
}

} // namespace scansion::stream
