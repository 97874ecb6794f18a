// The header of a PLY file.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/ply_header.hpp"

#include "pipeline/import/text_fields.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

namespace scansion {
namespace {

constexpr std::uint64_t kMaxHeader = std::uint64_t{1} << 20U; ///< bytes
constexpr std::size_t kMaxElements = 64;
constexpr std::size_t kMaxProperties = 256; ///< of one element

constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes{{{"char", PlyType::i8},
                                                                       {"int8", PlyType::i8},
                                                                       {"uchar", PlyType::u8},
                                                                       {"uint8", PlyType::u8},
                                                                       {"short", PlyType::i16},
                                                                       {"int16", PlyType::i16},
                                                                       {"ushort", PlyType::u16},
                                                                       {"uint16", PlyType::u16},
                                                                       {"int", PlyType::i32},
                                                                       {"int32", PlyType::i32},
                                                                       {"uint", PlyType::u32},
                                                                       {"uint32", PlyType::u32},
                                                                       {"float", PlyType::f32},
                                                                       {"float32", PlyType::f32},
                                                                       {"double", PlyType::f64},
                                                                       {"float64", PlyType::f64}}};

std::optional<PlyType> type_named(std::string_view name) noexcept {
  for (const auto& [text, type] : kTypes)
    if (text == name) return type;
  return std::nullopt;
}

bool parse_count(std::string_view text, std::uint64_t& out) noexcept {
  const auto read = std::from_chars(text.data(), text.data() + text.size(), out);
  return read.ec == std::errc() && read.ptr == text.data() + text.size();
}

/// Takes the header row by row.
class HeaderParser {
public:
  explicit HeaderParser(ByteWindow& window) : window_(window) {}

  Result<PlyHeader> parse() {
    std::string_view row;
    for (bool first = true;; first = false) {
      SCANSION_TRY(more, window_.next_row(row));
      if (!more || window_.position() > kMaxHeader)
        return fail(Errc::undecodable, window_.where(), ": the PLY header has no end_header; the file is cut off or not PLY");
      while (!row.empty() && (row.back() == '\r' || row.back() == ' ')) row.remove_suffix(1);
      if (first) {
        if (row != "ply")
          return bad("found " + quoted(row) + " where \"ply\" was expected", "give a PLY file or name the format");
        continue;
      }
      if (row == "end_header") break;
      SCANSION_TRY(take(row));
    }
    if (!has_format_) return bad("the PLY header has no format row", "add \"format ascii 1.0\" or the binary one");
    return std::move(header_);
  }

private:
  [[nodiscard]] Error bad(const std::string& reason, const char* fix) const {
    return Error{Errc::undecodable, window_.where() + ": " + reason + "; " + fix};
  }

  Result<void> take(std::string_view row) {
    if (row.empty()) return success();
    static_cast<void>(split_fields(row, Delimiter::blanks, 6, words_));
    const std::string_view key = words_[0];
    if (key == "comment") return success();
    if (key == "format") return take_format();
    if (key == "obj_info") return take_info();
    if (key == "element") return take_element();
    if (key == "property") return take_property();
    return bad("unknown PLY header row " + quoted(row), "correct the header or convert the file to text");
  }

  Result<void> take_format() {
    const std::string_view name = words_.size() > 1 ? words_[1] : std::string_view();
    has_format_ = true;
    if (name == "ascii") {
      header_.encoding = PlyEncoding::ascii;
    } else if (name == "binary_little_endian") {
      header_.encoding = PlyEncoding::little;
    } else if (name == "binary_big_endian") {
      header_.encoding = PlyEncoding::big;
    } else {
      return bad("unknown PLY format " + quoted(name), "use ascii, binary_little_endian or binary_big_endian");
    }
    return success();
  }

  Result<void> take_info() {
    if (words_.size() < 3) return success();
    auto* const target = words_[1] == "num_cols" ? &header_.num_cols : words_[1] == "num_rows" ? &header_.num_rows : nullptr;
    std::uint64_t value = 0;
    if (target == nullptr) return success();
    if (!parse_count(words_[2], value))
      return bad("found " + quoted(words_[2]) + " where a number was expected", "correct the header");
    *target = value;
    return success();
  }

  Result<void> take_element() {
    PlyElement element;
    if (words_.size() < 3 || !parse_count(words_[2], element.count))
      return bad("an element row needs a name and a number", "write e.g. \"element vertex 1000\"");
    if (header_.elements.size() == kMaxElements) return bad("more than 64 elements", "correct the header");
    element.name = words_[1];
    if (header_.find(element.name) != nullptr)
      return bad("element " + quoted(element.name) + " is there twice", "correct the header");
    header_.elements.push_back(std::move(element));
    return success();
  }

  Result<void> take_property() {
    if (header_.elements.empty()) return bad("a property before any element", "correct the header");
    auto& properties = header_.elements.back().properties;
    if (properties.size() == kMaxProperties) return bad("more than 256 properties", "correct the header");
    const bool list = words_.size() > 1 && words_[1] == "list";
    if (words_.size() < (list ? 5U : 3U))
      return bad("a property row needs a type and a name", "write e.g. \"property float x\"");
    PlyProperty property;
    const auto type = type_named(words_[list ? 3 : 1]);
    if (list) property.count_type = type_named(words_[2]);
    if (!type || (list && (!property.count_type || !is_integer(*property.count_type))))
      return bad("unknown property type", "use char, uchar, short, ushort, int, uint, float or double");
    property.type = *type;
    property.name = words_[list ? 4 : 2];
    properties.push_back(std::move(property));
    return success();
  }

  ByteWindow& window_;
  PlyHeader header_;
  bool has_format_ = false;
  std::vector<std::string_view> words_;
};

} // namespace

std::size_t size_of(PlyType type) noexcept {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

const PlyElement* PlyHeader::find(std::string_view name) const noexcept {
  const auto found = std::find_if(elements.begin(), elements.end(), [name](const PlyElement& e) { return e.name == name; });
  return found == elements.end() ? nullptr : &*found;
}

Result<PlyHeader> read_ply_header(ByteWindow& window) {
  return HeaderParser(window).parse();
}

} // namespace scansion
