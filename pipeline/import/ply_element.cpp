// One element table of a PLY file, read row by row.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/ply_element.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace scansion {
namespace {

template <class T>
T load(const char* p, bool swap) noexcept {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), p, sizeof(T));
  if (swap) std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

/// Reads the number at `p`, which a blank or the row's end must follow; null when there is none.
const char* parse_word(const char* p, Number& out) noexcept {
  while (*p == ' ' || *p == '\t') ++p;
  const char* const end = parse_number(p, out);
  return end != nullptr && (*end == ' ' || *end == '\n' || *end == '\t' || *end == '\r') ? end : nullptr;
}

bool is_blank_row(std::string_view row) noexcept {
  return row.find_first_not_of(" \t\r") == std::string_view::npos;
}

/// Cuts the next word off `row`; empty at its end.
std::string_view next_word(std::string_view& row) noexcept {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  const auto begin = std::find_if_not(row.begin(), row.end(), blank);
  const auto end = std::find_if(begin, row.end(), blank);
  const std::string_view word(begin, end);
  row = std::string_view(end, row.end());
  return word;
}

} // namespace

PlyElementReader::PlyElementReader(const PlyElement& element, PlyEncoding encoding, std::vector<std::uint8_t> slots)
    : element_(element), encoding_(encoding), slots_(std::move(slots)) {
  for (std::size_t i = 0; i < element_.properties.size(); ++i) {
    const PlyProperty& property = element_.properties[i];
    stride_ += size_of(property.count_type.value_or(property.type));
    lists_ = lists_ || property.count_type.has_value();
    if (slots_[i] != kIgnore) wanted_ = i + 1;
  }
}

Result<void> PlyElementReader::check_room(const ByteWindow& window) const {
  if (element_.count == 0) return success();
  const std::string what = window.name() + ": element " + quoted(element_.name);
  if (element_.properties.empty()) return fail(Errc::undecodable, what, " has no properties; correct the header");
  // A text row is one character and a line feed at least; the last one may lack the latter.
  const std::uint64_t least = encoding_ == PlyEncoding::ascii ? 2 : stride_;
  if (element_.count <= (window.remaining() + 1) / least) return success();
  return fail(Errc::undecodable, what, ": the header claims ", std::to_string(element_.count), " rows, the file has ",
              std::to_string(window.remaining()), " bytes left; it is cut off or the header is wrong");
}

Result<void> PlyElementReader::read(ByteWindow& window, PlyRecord& record) {
  record.list_count = 0;
  if (encoding_ == PlyEncoding::ascii) {
    SCANSION_TRY(read_text(window, record));
  } else if (lists_) {
    SCANSION_TRY(read_lists(window, record));
  } else {
    SCANSION_TRY(read_fixed(window, record));
  }
  ++index_;
  return success();
}

/// The usual row; false for anything else, which read_text_property then explains.
bool PlyElementReader::parse_row(const char* p, PlyRecord& record) const noexcept {
  Number spare;
  for (std::size_t i = 0; i < wanted_; ++i) {
    Number& number = slots_[i] == kIgnore ? spare : record.values[slots_[i]];
    std::int64_t count = 1;
    if (element_.properties[i].count_type) {
      p = parse_word(p, spare);
      if (p == nullptr || spare.kind != NumberKind::decimal || spare.exponent != 0 || spare.mantissa < 0) return false;
      count = spare.mantissa;
      if (slots_[i] != kIgnore) record.list_count = static_cast<std::uint64_t>(count);
    }
    for (std::int64_t k = 0; k < count; ++k) {
      p = parse_word(p, k == 0 ? number : spare);
      if (p == nullptr) return false;
    }
  }
  return true;
}

Result<void> PlyElementReader::read_text(ByteWindow& window, PlyRecord& record) {
  std::string_view row;
  do {
    SCANSION_TRY(more, window.next_row(row));
    if (!more) return cut_off(window);
    if (wanted_ > 0 ? parse_row(row.data(), record) : !is_blank_row(row)) return success();
  } while (is_blank_row(row));
  record.list_count = 0;
  for (std::size_t i = 0; i < wanted_; ++i) {
    SCANSION_TRY(read_text_property(window, i, row, record));
  }
  return success();
}

Result<void> PlyElementReader::read_text_property(const ByteWindow& window, std::size_t property, std::string_view& row,
                                                  PlyRecord& record) const {
  const PlyProperty& described = element_.properties[property];
  const std::uint8_t slot = slots_[property];
  const auto number = [&](Number& out) -> Result<void> {
    const std::string_view word = next_word(row);
    if (!word.empty() && parse_number(word.data(), out) == word.data() + word.size()) return success();
    return fail(Errc::undecodable, window.where(), ": found ", quoted(word), " where a number for ", quoted(described.name),
                " of ", quoted(element_.name), " was expected; correct the row");
  };
  Number first;
  if (!described.count_type) {
    if (slot != kIgnore) return number(record.values[slot]);
    static_cast<void>(next_word(row));
    return success();
  }
  SCANSION_TRY(number(first));
  if (first.kind != NumberKind::decimal || first.exponent != 0 || first.mantissa < 0)
    return fail(Errc::undecodable, window.where(), ": the length of list ", quoted(described.name),
                " is no whole number; correct the row");
  const auto count = static_cast<std::uint64_t>(first.mantissa);
  for (std::uint64_t i = 0; i < count; ++i) {
    SCANSION_TRY(number(first));
    if (i == 0 && slot != kIgnore) record.values[slot] = first;
  }
  if (slot != kIgnore) record.list_count = count;
  return success();
}

Result<void> PlyElementReader::read_fixed(ByteWindow& window, PlyRecord& record) {
  SCANSION_TRY(need(window, stride_));
  const char* p = window.data();
  for (std::size_t i = 0; i < wanted_; ++i) {
    const PlyType type = element_.properties[i].type;
    if (slots_[i] != kIgnore) record.values[slots_[i]] = decode(type, p);
    p += size_of(type);
  }
  window.consume(stride_);
  return success();
}

Result<void> PlyElementReader::read_lists(ByteWindow& window, PlyRecord& record) {
  for (std::size_t i = 0; i < element_.properties.size(); ++i) {
    const PlyProperty& property = element_.properties[i];
    const PlyType head = property.count_type.value_or(property.type);
    SCANSION_TRY(need(window, size_of(head)));
    Number value = decode(head, window.data());
    window.consume(size_of(head));
    if (!property.count_type) {
      if (slots_[i] != kIgnore) record.values[slots_[i]] = value;
      continue;
    }
    if (value.mantissa < 0)
      return fail(Errc::undecodable, window.name(), ": ", element_.name, " ", std::to_string(index_), ": list ",
                  quoted(property.name), " has a negative length; the file is damaged");
    const auto count = static_cast<std::uint64_t>(value.mantissa);
    const std::size_t item = size_of(property.type);
    if (count > window.remaining() / item) return cut_off(window);
    if (slots_[i] != kIgnore) {
      record.list_count = count;
      if (count > 0) {
        SCANSION_TRY(need(window, item));
        record.values[slots_[i]] = decode(property.type, window.data());
      }
    }
    SCANSION_TRY(skip(window, count * item));
  }
  return success();
}

Result<void> PlyElementReader::skip(ByteWindow& window, std::uint64_t bytes) {
  while (bytes > 0) {
    const auto step = static_cast<std::size_t>(std::min<std::uint64_t>(bytes, ByteWindow::kWindow));
    SCANSION_TRY(need(window, step));
    window.consume(step);
    bytes -= step;
  }
  return success();
}

Result<void> PlyElementReader::need(ByteWindow& window, std::size_t bytes) {
  if (window.available() >= bytes) return success();
  SCANSION_TRY(window.fill(bytes));
  if (window.available() < bytes) return cut_off(window);
  return success();
}

Number PlyElementReader::decode(PlyType type, const char* p) const noexcept {
  const bool swap = (encoding_ == PlyEncoding::big) == (std::endian::native == std::endian::little);
  switch (type) {
    case PlyType::i8: return Number::whole(static_cast<signed char>(*p));
    case PlyType::u8: return Number::whole(static_cast<unsigned char>(*p));
    case PlyType::i16: return Number::whole(load<std::int16_t>(p, swap));
    case PlyType::u16: return Number::whole(load<std::uint16_t>(p, swap));
    case PlyType::i32: return Number::whole(load<std::int32_t>(p, swap));
    case PlyType::u32: return Number::whole(load<std::uint32_t>(p, swap));
    case PlyType::f32: return Number::ieee(NumberKind::float32, static_cast<double>(load<float>(p, swap)));
    case PlyType::f64: return Number::ieee(NumberKind::float64, load<double>(p, swap));
  }
  return Number::none();
}

Error PlyElementReader::cut_off(const ByteWindow& window) const {
  return Error{Errc::undecodable, window.name() + ": " + quoted(element_.name) + " ends after " + std::to_string(index_) +
                                      " of " + std::to_string(element_.count) + " rows; the file is cut off, copy it again"};
}

} // namespace scansion
