// All members of the input as one stream of samples.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/import/sample_stream.hpp"

#include "pipeline/import/byte_window.hpp"
#include "pipeline/import/ply_reader.hpp"
#include "pipeline/import/text_reader.hpp"
#include "pipeline/import/unpack.hpp"

#include <algorithm>

namespace scansion {
namespace {

/// Text without a telling ending is CSV when it begins with a heading of columns x and z, or with two fields between commas,
/// semicolons or tabs.
ImportFormat format_of_text(std::string_view start) {
  if (start.starts_with("\xEF\xBB\xBF")) start.remove_prefix(3);
  std::vector<std::string_view> fields;
  while (!start.empty()) {
    const std::size_t length = std::min(start.find('\n'), start.size());
    const std::string_view row = start.substr(0, length);
    start.remove_prefix(std::min(length + 1, start.size()));
    const std::string_view text = strip_row(row, Delimiter::any).text;
    if (text.empty()) continue;
    const Delimiter delimiter = find_delimiter(text);
    static_cast<void>(split_fields(text, delimiter, text.size() + 1, fields));
    const auto names = [&](Column column) {
      return std::any_of(fields.begin(), fields.end(), [&](std::string_view f) { return column_named(f) == column; });
    };
    const bool heading = names(Column::x) && names(Column::z);
    const bool two = fields.size() == 2 && delimiter != Delimiter::blanks;
    return heading || two ? ImportFormat::csv : ImportFormat::xyz;
  }
  return ImportFormat::xyz;
}

ImportFormat format_of(const Member& member, std::string_view start) {
  const std::string ending = ending_of(member.name);
  if (ending == "csv") return ImportFormat::csv;
  if (ending == "ply") return ImportFormat::ply;
  if (ending == "xyz" || ending == "txt" || ending == "asc") return ImportFormat::xyz;
  return starts_ply(start) ? ImportFormat::ply : format_of_text(start);
}

} // namespace

SampleStream::SampleStream(MemberList list, std::vector<Column> columns, const ImportOptions& options, Notes& notes)
    : list_(std::move(list)), columns_(std::move(columns)), options_(options), notes_(notes),
      spacing_(shortest_decimal(Number::ieee(NumberKind::float64, options.spacing))), total_(list_.bytes()) {
  restart(ThirdColumn::height);
}

void SampleStream::restart(ThirdColumn third) {
  third_ = third;
  member_ = 0;
  reader_.reset();
  ended_ = false;
  done_ = 0;
  line_ = 0;
  line_open_ = false;
  y_ = y_of_line();
}

Result<std::span<const Sample>> SampleStream::next() {
  if (ended_) skip_member();
  if (!reader_) {
    if (member_ == list_.members.size()) return std::span<const Sample>();
    SCANSION_TRY(reader, open(list_.members[member_]));
    reader_ = std::move(reader);
    ++member_;
  }
  SCANSION_TRY(n, reader_->read(block_));
  std::size_t count = n;
  if (count == 0) {
    block_[0] = Sample{};
    block_[0].kind = SampleKind::line_end;
    count = 1;
    ended_ = true;
  }
  const std::span<Sample> samples = std::span(block_).first(count);
  fill_in_y(samples);
  return std::span<const Sample>(samples);
}

void SampleStream::skip_member() noexcept {
  ended_ = false;
  reader_.reset();
  if (member_ > 0) done_ += list_.members[member_ - 1].size;
}

std::string SampleStream::where(std::uint64_t place) const {
  return reader_ ? reader_->where(place) : description();
}

std::string SampleStream::description() const {
  if (list_.members.empty()) return "input";
  const std::size_t more = list_.members.size() - 1;
  return list_.members[0].name + (more > 0 ? " and " + std::to_string(more) + " more" : std::string());
}

Result<std::unique_ptr<SampleReader>> SampleStream::open(const Member& member) const {
  SCANSION_TRY(window, ByteWindow::open(member));
  SCANSION_TRY(window.fill(kSniffBytes));
  const std::string_view start(window.data(), std::min(window.available(), kSniffBytes));
  const ImportFormat format = options_.format == ImportFormat::automatic ? format_of(member, start) : options_.format;
  if (format == ImportFormat::ply) return open_ply(std::move(window), options_.grid_rows, notes_);
  if (starts_ply(start))
    return fail(Errc::undecodable, member.name, ":1: is a PLY file, not text; let its name end in .ply or name the format ply");
  TextOptions text{.csv = format == ImportFormat::csv, .columns = columns_, .third_is_label = third_ == ThirdColumn::label};
  return std::unique_ptr<SampleReader>(std::make_unique<TextReader>(std::move(window), std::move(text), notes_));
}

void SampleStream::fill_in_y(std::span<Sample> samples) {
  const bool without_y = reader_->without_y();
  for (Sample& sample : samples) {
    if (sample.kind == SampleKind::line_end) {
      line_ += line_open_ ? 1 : 0;
      line_open_ = false;
      if (without_y) y_ = y_of_line();
    } else if (sample.kind != SampleKind::missing) {
      line_open_ = true;
      if (without_y) sample.xyz[1] = y_;
    }
  }
}

Number SampleStream::y_of_line() const noexcept {
  Number y{0, spacing_.exponent, NumberKind::decimal};
  const std::int64_t most = kPowersOfTen[kMaxDigits] - 1;
  if (__builtin_mul_overflow(spacing_.mantissa, line_, &y.mantissa) || y.mantissa > most || y.mantissa < -most)
    return Number::ieee(NumberKind::float64,
                        static_cast<double>(static_cast<long double>(to_double(spacing_)) * static_cast<long double>(line_)));
  return y;
}

} // namespace scansion
