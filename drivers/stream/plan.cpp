// How a stream is described.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/stream/plan.hpp"

#include <charconv>
#include <cmath>

namespace scansion::stream {
namespace {

constexpr std::size_t kLongestSync = 16;

Result<void> check_format(std::string_view text) {
  if (text != "text" && text != "binary") return fail(Errc::config, "is neither text nor binary");
  return success();
}
Result<void> check_unit(std::string_view text) {
  if (!parse_unit(text)) return fail(Errc::config, "is none of m, mm, um, in, ft");
  return success();
}
Result<void> check_resolution(std::string_view text) {
  if (!parse_rational(text)) return fail(Errc::config, "is no positive decimal such as 0.001");
  return success();
}
Result<void> check_sum(std::string_view text) {
  if (!parse_checksum(text)) return fail(Errc::config, "is none of none, xor, sum, crc16-modbus, crc16-ccitt, crc32");
  return success();
}
Result<void> check_order(std::string_view text) {
  if (text != "little" && text != "big") return fail(Errc::config, "is neither little nor big");
  return success();
}
Result<void> check_axis(std::string_view text) {
  if (text != "x" && text != "y" && text != "z") return fail(Errc::config, "is none of x, y, z");
  return success();
}

std::optional<Break> parse_break(std::string_view text) noexcept {
  if (text == "line") return Break::field;
  if (text == "blank") return Break::blank;
  if (text == "mark") return Break::mark;
  if (text == "reversal") return Break::reversal;
  if (text == "pause") return Break::pause;
  if (text == "points") return Break::points;
  return std::nullopt;
}
Result<void> check_break(std::string_view text) {
  if (text != "auto" && !parse_break(text)) {
    return fail(Errc::config, "is none of auto, line, blank, mark, reversal, pause, points");
  }
  return success();
}

Result<void> check_sync(std::string_view text) {
  SCANSION_TRY(parse_sync(text));
  return success();
}

Result<void> choose_break(const OptionValues& values, Plan& plan) {
  const std::string text = values.text("break");
  if (const auto chosen = parse_break(text))
    plan.line_break = *chosen;
  else if (has(plan.fields, Role::line))
    plan.line_break = Break::field;
  else if (plan.is_binary)
    return fail(
        Errc::config,
        "break = \"auto\": a binary stream without a field \"line\" has no blank rows; choose reversal, pause or points");
  const Break chosen = plan.line_break;
  if (chosen == Break::field && !has(plan.fields, Role::line))
    return fail(Errc::config, "break = \"line\": fields has no \"line\"; add it or choose another break");
  if (plan.is_binary && (chosen == Break::blank || chosen == Break::mark))
    return fail(Errc::config, "break = \"", text, "\": binary records have no rows; choose line, reversal, pause or points");
  if (chosen == Break::mark && plan.mark.empty())
    return fail(Errc::config, "break = \"mark\": the key mark is missing; give the row that ends a line");
  if (chosen == Break::pause && plan.pause_ns == 0)
    return fail(Errc::config, "break = \"pause\": the key pause_ms is missing; give the time after which a line is over");
  if (chosen == Break::points && plan.points == 0)
    return fail(Errc::config, "break = \"points\": the key points is missing; give the number of points in a line");
  if (chosen == Break::reversal && plan.axis == 1 && !has(plan.fields, Role::y))
    return fail(Errc::config, "axis = \"y\": fields has no y; choose x or z");
  return success();
}

Result<void> check_way(const OptionValues& values, const Plan& plan) {
  const bool by_time = values.find("speed") != nullptr;
  const bool by_encoder = values.find("encoder") != nullptr;
  if (has(plan.fields, Role::y) && (by_time || by_encoder || values.find("spacing") != nullptr))
    return fail(Errc::config, "spacing, speed and encoder say where lines without a y stand, but fields has y; remove one");
  if (by_time && !has(plan.fields, Role::time)) return fail(Errc::config, "speed needs the device's time; fields has no time");
  if (by_encoder && !has(plan.fields, Role::encoder)) return fail(Errc::config, "encoder needs counts; fields has no encoder");
  return success();
}

} // namespace

Result<std::vector<std::uint8_t>> parse_sync(std::string_view text) {
  std::vector<std::uint8_t> out;
  while (!text.empty()) {
    if (text.front() == ' ') {
      text.remove_prefix(1);
      continue;
    }
    std::uint8_t byte = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + std::min<std::size_t>(2, text.size()), byte, 16);
    if (error != std::errc() || end != text.data() + 2 || out.size() == kLongestSync) {
      return fail(Errc::config, "is no list of 1 to 16 bytes as pairs of hex digits such as \"AA 55\"");
    }
    out.push_back(byte);
    text.remove_prefix(2);
  }
  return out;
}
std::span<const Option> rows() noexcept {
  static const std::vector<Option> all = [] {
    std::vector<Option> out{
        {.key = "format",
         .standard = "text",
         .meaning = "text: a row a point; binary: records of fixed length",
         .check = check_format},
        {.key = "fields",
         .standard = "x y z",
         .meaning = "what a record holds: x y z line time encoder bad - =TEXT, each NAME[:TYPE][*SCALE], see drivers/stream"},
        {.key = "unit", .standard = "mm", .meaning = "unit of x, y, z: m, mm, um, in or ft", .check = check_unit},
        {.key = "resolution",
         .type = OptionType::text_or_number,
         .standard = "0.001",
         .meaning = "units per count; values between counts are rounded to the nearest",
         .check = check_resolution},
        {.key = "gap",
         .type = OptionType::number,
         .meaning = "a step longer than this many mm splits a line; without it no step does",
         .min = 1e-3,
         .max = 1e6,
         .example = "5.0"},
        {.key = "break",
         .standard = "auto",
         .meaning =
             "what ends a line: line (that field changes), blank (row), mark, reversal, pause, points; auto: line or blank",
         .check = check_break},
        {.key = "mark", .meaning = "the row that ends a line", .example = "\"END\"", .alternative = true},
        {.key = "axis", .standard = "x", .meaning = "axis whose way turns round at a reversal: x, y or z", .check = check_axis},
        {.key = "turn",
         .type = OptionType::number,
         .standard = 1.0,
         .meaning = "units the way goes back before it counts as a reversal",
         .min = 1e-6,
         .max = 1e6},
        {.key = "pause_ms",
         .type = OptionType::integer,
         .meaning = "ms without a byte after which a line is over; with any break",
         .min = 1,
         .max = 3'600'000,
         .example = "500",
         .alternative = true},
        {.key = "points",
         .type = OptionType::integer,
         .meaning = "records in a line",
         .min = 1,
         .max = 1'000'000,
         .example = "1000",
         .alternative = true},
        {.key = "checksum",
         .standard = "none",
         .meaning = "none, xor, sum, crc16-modbus, crc16-ccitt, crc32: *HEX at a row's end, bytes at a record's",
         .check = check_sum},
        {.key = "checksum_from",
         .type = OptionType::integer,
         .standard = std::int64_t{0},
         .meaning = "bytes of a record before the first one in its sum; 1 leaves the $ of NMEA rows out",
         .min = 0,
         .max = 255},
        {.key = "checksum_order",
         .standard = "little",
         .meaning = "byte order of a binary record's sum: little or big",
         .check = check_order},
        {.key = "sync",
         .meaning = "bytes in hex that every binary record begins with",
         .check = check_sync,
         .example = "\"AA 55\"",
         .alternative = true},
        {.key = "null", .meaning = "a coordinate that stands for no value", .example = "\"-9999\"", .alternative = true},
        {.key = "comment", .standard = "#", .meaning = "rows that begin with this are passed over"},
        {.key = "start", .meaning = "text sent when the device is opened", .example = "\"START\\r\\n\"", .alternative = true},
        {.key = "stop", .meaning = "text sent before it is closed", .example = "\"STOP\\r\\n\"", .alternative = true},
    };
    for (Option row : spacing_rows()) {
      row.alternative = true;
      out.push_back(row);
    }
    return out;
  }();
  return all;
}

Result<Plan> make_plan(const OptionValues& values) {
  Plan plan;
  plan.is_binary = values.text("format") == "binary";
  auto fields = parse_fields(values.text("fields"), plan.is_binary);
  if (!fields) return fail(Errc::config, "fields = \"", values.text("fields"), "\" ", fields.assume_error().context);
  plan.fields = std::move(fields).assume_value();
  SCANSION_TRY(unit, parse_unit(values.text("unit")));
  plan.unit = unit;
  SCANSION_TRY(resolution, parse_rational(values.text("resolution")));
  plan.resolution = resolution;
  plan.gap_mm = values.get<double>("gap");
  plan.mark = values.text("mark");
  plan.axis = static_cast<std::size_t>(values.text("axis").front() - 'x');
  plan.turn = std::max<std::int64_t>(1, std::llround(values.get<double>("turn").value_or(1.0) / resolution.value()));
  plan.pause_ns = values.integer("pause_ms") * 1'000'000;
  plan.points = static_cast<std::uint32_t>(values.integer("points"));
  plan.sum = parse_checksum(values.text("checksum")).value_or(Checksum::none);
  plan.sum_from = static_cast<std::size_t>(values.integer("checksum_from"));
  plan.is_sum_big_endian = values.text("checksum_order") == "big";
  SCANSION_TRY(sync, parse_sync(values.text("sync")));
  plan.sync = std::move(sync);
  plan.null = values.text("null");
  plan.comment = values.text("comment");
  plan.start = values.text("start");
  plan.stop = values.text("stop");
  if (!plan.is_binary && !plan.sync.empty()) return fail(Errc::config, "sync is for binary records; in text use a field =TEXT");
  if (plan.is_binary && plan.sum_from >= plan.sync.size() + bytes_of(plan.fields))
    return fail(Errc::config, "checksum_from leaves no byte of a record; give a smaller one");
  SCANSION_TRY(choose_break(values, plan));
  SCANSION_TRY(check_way(values, plan));
  SCANSION_TRY(spacing, LineSpacing::create(values));
  plan.spacing = spacing;
  return plan;
}

} // namespace scansion::stream
