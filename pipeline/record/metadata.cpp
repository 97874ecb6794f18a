// Facts and totals to text entries and back.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/metadata.hpp"

#include "pipeline/codec/crc32c.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace scansion {
namespace {

using mcap::Entries;

constexpr std::string_view kChecksumKey = "crc32c";
constexpr std::size_t kMaxDevice = 64;

template <class T>
std::string number(T value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::string hex8(std::uint32_t value) {
  std::string text(8, '0');
  for (std::size_t k = 0; k < 8; ++k) text[k] = "0123456789abcdef"[(value >> (28 - 4 * k)) & 15U];
  return text;
}

std::string_view name_of(Source source) noexcept {
  switch (source) {
    case Source::decimal: return "decimal";
    case Source::float32: return "float32";
    case Source::float64: return "float64";
  }
  return "decimal";
}

/// Over the entries as they stand in the record: each length, key, length, value.
std::uint32_t checksum(const Entries& entries) {
  Bytes bytes;
  mcap::Builder(bytes).entries(entries);
  return crc32c(0, ByteView(bytes).subspan(4));
}

Bytes record(std::string_view name, Entries entries) {
  const std::uint32_t sum = checksum(entries);
  entries.emplace_back(kChecksumKey, hex8(sum));
  Bytes bytes;
  mcap::Builder b(bytes);
  const std::size_t begun = b.begin(mcap::Opcode::metadata);
  b.string(name);
  b.entries(entries);
  b.end(begun);
  return bytes;
}

/// The entries of a checked record; remembers the first value that could not be read.
class Values {
public:
  [[nodiscard]] static Result<Values> read(ByteView content, std::string_view name) {
    if (content.size() > kMaxMetadata) return fail(Errc::damaged, "metadata record is longer than 64 KiB");
    mcap::Cursor cursor(content);
    if (cursor.string() != name) return fail(Errc::damaged, "no metadata record '", name, "'");
    Values values;
    values.entries_ = cursor.entries();
    if (!cursor.at_end() || values.entries_.empty()) return fail(Errc::damaged, "metadata record '", name, "' is broken");
    const auto [key, sum] = values.entries_.back();
    values.entries_.pop_back();
    if (key != kChecksumKey || sum != hex8(checksum(values.entries_)))
      return fail(Errc::damaged, "metadata record '", name, "': checksum is wrong");
    return values;
  }

  [[nodiscard]] std::optional<std::string_view> find(std::string_view key) const noexcept {
    const auto at = std::find_if(entries_.begin(), entries_.end(), [&](const auto& entry) { return entry.first == key; });
    if (at == entries_.end()) return std::nullopt;
    return at->second;
  }
  [[nodiscard]] std::string_view text(std::string_view key) {
    const auto value = find(key);
    if (!value) reject(key);
    return value.value_or(std::string_view{});
  }
  template <class T>
  [[nodiscard]] T number(std::string_view key) {
    return parse<T>(key, text(key));
  }
  template <class T>
  [[nodiscard]] std::optional<T> optional_number(std::string_view key) {
    const auto value = find(key);
    if (!value) return std::nullopt;
    return parse<T>(key, *value);
  }
  template <class T>
  [[nodiscard]] T parse(std::string_view key, std::string_view value) {
    T result{};
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), result);
    if (error != std::errc{} || end != value.data() + value.size()) reject(key);
    return result;
  }
  /// Whether the entry is there; then it says yes.
  [[nodiscard]] bool yes(std::string_view key) {
    const auto value = find(key);
    if (value && *value != "yes") reject(key);
    return value.has_value();
  }
  void reject(std::string_view key) {
    if (rejected_.empty()) rejected_ = key;
  }
  [[nodiscard]] Result<void> all_read() const {
    if (!rejected_.empty()) return fail(Errc::damaged, "metadata entry '", rejected_, "' is missing or impossible");
    return success();
  }

private:
  Entries entries_;
  std::string rejected_;
};

void parse_resolution(Values& values, Rational& out) {
  const std::string_view text = values.text("resolution");
  const std::size_t slash = text.find('/');
  if (slash == std::string_view::npos) return values.reject("resolution");
  const auto num = values.parse<std::int64_t>("resolution", text.substr(0, slash));
  const auto den = values.parse<std::int64_t>("resolution", text.substr(slash + 1));
  if (num < 1 || den < 1) return values.reject("resolution");
  const auto reduced = make_rational(num, den);
  if (!reduced) return values.reject("resolution");
  out = reduced.value();
}

void parse_origin(Values& values, std::array<std::int64_t, 3>& out) {
  std::string_view text = *values.find("origin");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t space = axis < 2 ? text.find(' ') : text.size();
    if (space == std::string_view::npos) return values.reject("origin");
    out[axis] = values.parse<std::int64_t>("origin", text.substr(0, space));
    text.remove_prefix(std::min(space + 1, text.size()));
  }
}

void parse_lattice(Values& values, Lattice& out) {
  parse_resolution(values, out.resolution);
  if (values.find("origin")) parse_origin(values, out.origin);
  const auto unit = parse_unit(values.text("unit"));
  if (unit)
    out.unit = unit.value();
  else
    values.reject("unit");
  const std::string_view source = values.find("source").value_or("decimal");
  if (source == "float32")
    out.source = Source::float32;
  else if (source == "float64")
    out.source = Source::float64;
  else if (source != "decimal")
    values.reject("source");
  out.exact = values.yes("exact");
}

bool device_name_fits(std::string_view device) noexcept {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
  };
  return !device.empty() && device.size() <= kMaxDevice && std::all_of(device.begin(), device.end(), fits);
}

bool not_negative(double value) noexcept {
  return std::isfinite(value) && value >= 0.0;
}

} // namespace

Bytes facts_record(const RecordingFacts& f) {
  const auto& o = f.lattice.origin;
  Entries e{{"format", std::string(kFormatVersion)},
            {"device", f.device},
            {"stream", number(f.stream)},
            {"unit", std::string(name(f.lattice.unit))},
            {"resolution", number(f.lattice.resolution.num) + "/" + number(f.lattice.resolution.den)},
            {"levels", to_string(f.levels)},
            {"level_count", number(f.level_count)}};
  // What most recordings have is left out.
  if (o != std::array<std::int64_t, 3>{}) e.emplace_back("origin", number(o[0]) + " " + number(o[1]) + " " + number(o[2]));
  if (f.lattice.source != Source::decimal) e.emplace_back("source", name_of(f.lattice.source));
  if (f.lattice.exact) e.emplace_back("exact", "yes");
  if (f.stored_levels != f.level_count + 1) e.emplace_back("stored_levels", number(f.stored_levels));
  if (f.rounding_mm != 0.0) e.emplace_back("rounding_mm", number(f.rounding_mm));
  if (f.gap_mm) e.emplace_back("gap_mm", number(*f.gap_mm));
  if (f.started_ns) e.emplace_back("started_ns", number(*f.started_ns));
  if (f.features) e.emplace_back("features", "yes");
  if (f.levels.floor.on()) e.emplace_back("floor", to_string(f.levels.floor));
  return record(kFactsName, std::move(e));
}

Bytes end_record(const RecordingEnd& end) {
  Entries e{
      {"lines", number(end.lines)}, {"points", number(end.points)}, {"runs", number(end.runs)}, {"groups", number(end.groups)}};
  if (end.invalid != 0) e.emplace_back("invalid", number(end.invalid));
  if (end.gaps != 0) e.emplace_back("gaps", number(end.gaps));
  if (end.rounding_mm != 0.0) e.emplace_back("rounding_mm", number(end.rounding_mm));
  if (end.ended_ns) e.emplace_back("ended_ns", number(*end.ended_ns));
  return record(kEndName, std::move(e));
}

Result<RecordingFacts> parse_facts(ByteView content) {
  SCANSION_TRY(values, Values::read(content, kFactsName));
  const std::string_view format = values.text("format");
  if (format != kFormatVersion)
    return fail(Errc::undecodable, "the recording has format version '", format,
                "'; this program reads version 1: use a newer one");
  RecordingFacts f;
  f.device = values.text("device");
  if (!device_name_fits(f.device)) values.reject("device");
  f.stream = values.number<std::uint32_t>("stream");
  parse_lattice(values, f.lattice);
  const auto levels = parse_level_spec(values.text("levels"));
  if (levels)
    f.levels = levels.value();
  else
    values.reject("levels");
  f.level_count = values.number<std::uint32_t>("level_count");
  if (f.level_count < 1 || f.level_count > kMaxLevels) values.reject("level_count");
  f.stored_levels = values.optional_number<std::uint32_t>("stored_levels").value_or(f.level_count + 1);
  if (f.stored_levels < 1 || f.stored_levels > f.level_count + 1) values.reject("stored_levels");
  f.rounding_mm = values.optional_number<double>("rounding_mm").value_or(0.0);
  if (!not_negative(f.rounding_mm)) values.reject("rounding_mm");
  f.gap_mm = values.optional_number<double>("gap_mm");
  if (f.gap_mm && !not_negative(*f.gap_mm)) values.reject("gap_mm");
  f.started_ns = values.optional_number<std::int64_t>("started_ns");
  f.features = values.yes("features");
  if (const auto text = values.find("floor")) {
    const auto floor = parse_floor(*text);
    if (floor && floor.value().on())
      f.levels.floor = floor.value();
    else
      values.reject("floor");
  }
  SCANSION_TRY(values.all_read());
  return f;
}

Result<RecordingEnd> parse_end(ByteView content) {
  SCANSION_TRY(values, Values::read(content, kEndName));
  RecordingEnd end;
  end.lines = values.number<std::uint64_t>("lines");
  end.points = values.number<std::uint64_t>("points");
  end.runs = values.number<std::uint64_t>("runs");
  end.invalid = values.optional_number<std::uint64_t>("invalid").value_or(0);
  end.gaps = values.optional_number<std::uint64_t>("gaps").value_or(0);
  end.groups = values.number<std::uint64_t>("groups");
  end.rounding_mm = values.optional_number<double>("rounding_mm").value_or(0.0);
  if (!not_negative(end.rounding_mm)) values.reject("rounding_mm");
  end.ended_ns = values.optional_number<std::int64_t>("ended_ns");
  SCANSION_TRY(values.all_read());
  return end;
}

Result<void> check_facts(const RecordingFacts& facts) {
  if (!device_name_fits(facts.device))
    return fail(Errc::usage, "device name '", facts.device, "' cannot stand in a recording; use 1 to 64 of a-z A-Z 0-9 - _ .");
  const Bytes bytes = facts_record(facts);
  const auto again = parse_facts(ByteView(bytes).subspan(mcap::kRecordHead));
  if (!again) return fail(Errc::usage, "these facts cannot be written into a recording: ", again.error().context);
  if (again.value() != facts)
    return fail(Errc::usage, "these facts do not come back the same from a recording: levels or numbers");
  return success();
}

} // namespace scansion
