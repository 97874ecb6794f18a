// Text of points: xyz rows and CSV profiles.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/text_reader.hpp"

#include <algorithm>

namespace scansion {
namespace {

enum : std::uint8_t { kOther = 0, kBlank = 1, kDelimiter = 2, kEnd = 3 };

std::size_t byte_of(char c) noexcept {
  return static_cast<unsigned char>(c);
}

constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

} // namespace

TextReader::TextReader(ByteWindow window, TextOptions options, Notes& notes)
    : window_(std::move(window)), options_(std::move(options)), notes_(notes) {}

std::string TextReader::where(std::uint64_t place) const {
  return window_.name() + ":" + std::to_string(place);
}

Result<std::size_t> TextReader::read(std::span<Sample> out) {
  std::size_t n = 0;
  if (held_ && !out.empty()) {
    out[n++] = *held_;
    held_.reset();
  }
  std::string_view row;
  while (n < out.size()) {
    SCANSION_TRY(more, window_.next_row(row));
    if (!more) break;
    Sample& sample = out[n];
    sample.place = window_.row_number();
    if (fast_ && parse_fast(row.data(), sample)) {
      line_open_ = true;
      ++n;
      continue;
    }
    SCANSION_TRY(kind, parse_carefully(row, sample));
    if (kind == Row::nothing) continue;
    if (kind == Row::blank) {
      if (!line_open_) continue;
      sample.kind = SampleKind::line_end;
      line_open_ = false;
      ++n;
      continue;
    }
    if (new_line_ && line_open_) {
      const Sample first = sample;
      sample.kind = SampleKind::line_end;
      if (++n == out.size()) {
        held_ = first;
        line_open_ = true;
        break;
      }
      out[n] = first;
    }
    line_open_ = true;
    ++n;
  }
  return n;
}

/// The usual row: numbers in all used columns. False for anything else, which parse_carefully then explains.
bool TextReader::parse_fast(const char* p, Sample& sample) noexcept {
  const std::size_t last = columns_.size() - 1;
  char between = static_cast<char>(delimiter_);
  bool valid = true;
  for (std::size_t c = 0;; ++c) {
    while (classes_[byte_of(*p)] == kBlank) ++p;
    Number& number = sample.xyz[static_cast<std::size_t>(columns_[c])];
    const char* const end = parse_number(p, number);
    if (end == nullptr) return false;
    valid = valid && number.kind != NumberKind::invalid;
    p = end;
    while (classes_[byte_of(*p)] == kBlank) ++p;
    const std::uint8_t next = classes_[byte_of(*p)];
    if (c == last) {
      if (next == kOther && p == end) return false;
      if (next != kEnd && note_extra_) note_extra();
      break;
    }
    if (next == kEnd || (next == kOther && p == end)) return false;
    const char here = next == kDelimiter ? *p++ : ' ';
    if (between != '\0' && here != between) return false;
    between = here;
  }
  sample.kind = valid ? SampleKind::point : SampleKind::invalid;
  return true;
}

void TextReader::note_extra() {
  note_extra_ = false;
  notes_.say(Notes::Subject::extra_columns,
             window_.where() + ": columns after the first " + std::to_string(columns_.size()) + " are ignored");
}

Result<TextReader::Row> TextReader::parse_carefully(std::string_view row, Sample& sample) {
  if (window_.row_number() == 1 && row.starts_with(kByteOrderMark)) row.remove_prefix(kByteOrderMark.size());
  const RowText stripped = strip_row(row, delimiter_);
  if (stripped.text.empty()) return stripped.comment ? Row::nothing : Row::blank;
  if (stripped.text.find('\0') != std::string_view::npos)
    return fail(Errc::undecodable, window_.where(), ": binary data; give a text file of points, a CSV or a PLY file");
  if (!begun_) {
    SCANSION_TRY(heading, begin(stripped.text));
    if (heading) return Row::nothing;
  }
  // One field more than needed tells whether there are more.
  if (!split_fields(stripped.text, delimiter_, columns_.size() + 1, fields_))
    return fail(Errc::undecodable, window_.where(),
                ": different delimiters in one row (decimal commas are not read); use one throughout, and decimal points");
  SCANSION_TRY(read_fields(sample));
  return Row::sample;
}

Result<void> TextReader::read_fields(Sample& sample) {
  if (fields_.size() < columns_.size()) return too_few(fields_.size());
  if (fields_.size() > columns_.size() && note_extra_ && !fields_.back().empty()) note_extra();
  new_line_ = false;
  sample.kind = SampleKind::point;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    SCANSION_TRY(read_field(c, sample));
  }
  return success();
}

Result<void> TextReader::read_field(std::size_t column, Sample& sample) {
  const std::string_view field = fields_[column];
  const Column role = columns_[column];
  if (role == Column::skip) return success();
  if (role == Column::line) {
    new_line_ = has_line_text_ && line_text_ != field;
    has_line_text_ = true;
    line_text_.assign(field);
    return success();
  }
  if (field.empty() && options_.csv) {
    sample.kind = SampleKind::invalid;
    return success();
  }
  Number label;
  Number& number = role == Column::label ? label : sample.xyz[static_cast<std::size_t>(role)];
  const std::string_view axis = role == Column::label ? std::string_view("a label") : kAxes[static_cast<std::size_t>(role)];
  const char* const end = field.empty() ? nullptr : parse_number(field.data(), number);
  if (end != field.data() + field.size())
    return fail(Errc::undecodable, window_.where(), ": found ", quoted(field), " where a number for ", axis, " was expected; ",
                !options_.csv && is_heading(fields_) ? "put # before a heading, or name the format csv"
                                                     : "write numbers with a decimal point, # before comments");
  if (role == Column::label) {
    if (is_zero_or_one(label)) return success();
    return fail(Errc::finer, window_.where(), ": third column holds ", quoted(field),
                ", so it is no label; look at the whole input for the columns");
  }
  if (number.kind == NumberKind::invalid) sample.kind = SampleKind::invalid;
  return success();
}

Error TextReader::too_few(std::size_t found) const {
  std::string text = window_.where() + ": found " + std::to_string(found) + (found == 1 ? " field, " : " fields, ") +
                     std::to_string(columns_.size()) + " are needed; ";
  text += options_.csv ? "write the same columns in every row"
                       : "write x y z in every row (profiles of x and z only are read as CSV)";
  return Error{Errc::undecodable, std::move(text)};
}

/// Finds delimiter and columns from the first row with fields; true when that row is a heading.
Result<bool> TextReader::begin(std::string_view text) {
  begun_ = true;
  note_extra_ = true;
  if (options_.csv) delimiter_ = find_delimiter(text);
  if (!split_fields(text, delimiter_, text.size() + 1, fields_)) fields_.assign(1, text); // explained by the caller
  const bool heading = options_.csv && is_heading(fields_);
  if (!options_.columns.empty()) {
    use(options_.columns);
  } else if (heading) {
    SCANSION_TRY(begin_heading());
  } else if (!options_.csv) {
    use({Column::x, Column::y, Column::z});
  } else {
    SCANSION_TRY(begin_headless());
  }
  return heading;
}

Result<void> TextReader::begin_heading() {
  std::vector<Column> columns;
  std::string ignored;
  std::array<int, 4> seen{};
  for (const std::string_view field : fields_) {
    const Column column = column_named(field);
    columns.push_back(column);
    if (column == Column::skip) {
      if (!field.empty()) ignored += (ignored.empty() ? "" : ", ") + quoted(field);
    } else if (++seen[static_cast<std::size_t>(column)] > 1) {
      return fail(Errc::undecodable, window_.where(), ": the heading names ", quoted(field),
                  " twice; give each column its own name");
    }
  }
  if (seen[static_cast<std::size_t>(Column::x)] == 0 || seen[static_cast<std::size_t>(Column::z)] == 0)
    return fail(Errc::undecodable, window_.where(), ": the heading (", ignored.substr(0, 200),
                ") names no x or no z; name the columns x, y, z, line");
  if (!ignored.empty())
    notes_.say(Notes::Subject::other_columns, window_.where() + ": columns " + ignored.substr(0, 200) + " are ignored");
  use(std::move(columns));
  note_extra_ = false;
  return success();
}

Result<void> TextReader::begin_headless() {
  third_may_be_label_ = fields_.size() == 3;
  if (fields_.size() < 2) {
    use({Column::x, Column::z});
    return too_few(fields_.size());
  }
  if (fields_.size() == 2) {
    use({Column::x, Column::z});
  } else if (third_may_be_label_ && options_.third_is_label) {
    use({Column::x, Column::z, Column::label});
  } else {
    use({Column::x, Column::y, Column::z});
  }
  return success();
}

void TextReader::use(std::vector<Column> columns) {
  while (!columns.empty() && columns.back() == Column::skip) {
    columns.pop_back();
    note_extra_ = false; // told apart by name already
  }
  columns_ = std::move(columns);
  has_y_ = std::find(columns_.begin(), columns_.end(), Column::y) != columns_.end();
  fast_ = std::all_of(columns_.begin(), columns_.end(), [](Column c) { return c <= Column::z; });
  classes_.fill(kOther);
  classes_[byte_of('\n')] = classes_[byte_of('#')] = kEnd;
  classes_[byte_of(' ')] = classes_[byte_of('\r')] = classes_[byte_of('\t')] = kBlank;
  if (delimiter_ == Delimiter::any) {
    classes_[byte_of(',')] = classes_[byte_of(';')] = kDelimiter;
  } else if (delimiter_ != Delimiter::blanks) {
    classes_[byte_of(static_cast<char>(delimiter_))] = kDelimiter;
  }
}

} // namespace scansion
