// The keys of a replay device.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/replay/options.hpp"

#include <charconv>
#include <cmath>

namespace scansion {
namespace {

constexpr double kMaxRate = 1e6;

Result<std::optional<double>> parse_rate(std::string_view text) {
  if (text == "max") return std::optional<double>();
  double rate = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rate);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(rate) || rate < 1e-3 || rate > kMaxRate) {
    return fail(Errc::config, "is neither \"max\" nor a number of lines per second from 0.001 to 1000000");
  }
  return std::optional<double>(rate);
}

Result<decltype(ImportOptions::resolution)> parse_resolution(std::string_view text) {
  using Resolution = decltype(ImportOptions::resolution);
  if (text == "auto") return Resolution(ResolutionAuto{});
  if (text == "exact") return Resolution(ResolutionExact{});
  auto rational = parse_rational(text);
  if (!rational) return fail(Errc::config, "is neither \"auto\", \"exact\" nor a positive decimal such as 0.005");
  return Resolution(ResolutionGiven{rational.assume_value()});
}

Result<ImportFormat> parse_format(std::string_view text) {
  if (text == "auto") return ImportFormat::automatic;
  if (text == "xyz") return ImportFormat::xyz;
  if (text == "ply") return ImportFormat::ply;
  if (text == "csv") return ImportFormat::csv;
  return fail(Errc::config, "is none of auto, xyz, ply, csv");
}

Result<void> check_rate(std::string_view text) {
  SCANSION_TRY(parse_rate(text));
  return success();
}
Result<void> check_resolution(std::string_view text) {
  SCANSION_TRY(parse_resolution(text));
  return success();
}
Result<void> check_format(std::string_view text) {
  SCANSION_TRY(parse_format(text));
  return success();
}
Result<void> check_unit(std::string_view text) {
  if (!parse_unit(text)) return fail(Errc::config, "is none of m, mm, um, in, ft");
  return success();
}
Result<void> check_file(std::string_view text) {
  if (text.empty()) return fail(Errc::config, "is empty; name a recorded scan");
  if (text == "-") return fail(Errc::config, "is standard input, which a daemon does not have; name a file");
  return success();
}

} // namespace

std::span<const Option> replay_schema() noexcept {
  static const Option rows[] = {
      {.key = "file",
       .meaning = "recorded scan to play: a file, a folder or an archive that `scansion compress` reads",
       .required = true,
       .check = check_file,
       .example = "\"/var/lib/scansion/scan.xyz\""},
      {.key = "format", .standard = "auto", .meaning = "auto, xyz, ply or csv", .check = check_format},
      {.key = "unit", .standard = "mm", .meaning = "unit of the file: m, mm, um, in or ft", .check = check_unit},
      {.key = "resolution",
       .type = OptionType::text_or_number,
       .standard = "auto",
       .meaning = "file units per count: auto, exact, or a decimal such as 0.005",
       .check = check_resolution},
      {.key = "gap",
       .type = OptionType::number,
       .meaning = "a step longer than this many mm splits a line; without it no step does",
       .min = 1e-3,
       .max = 1e6,
       .example = "5.0"},
      {.key = "rate",
       .type = OptionType::text_or_number,
       .standard = "max",
       .meaning = "lines per second, or max: as fast as they can be recorded",
       .check = check_rate},
      {.key = "loop", .type = OptionType::flag, .standard = false, .meaning = "start again at the end of the file"},
  };
  return rows;
}

Result<ReplayOptions> replay_options(const OptionValues& values) {
  ReplayOptions out;
  out.file = values.text("file");
  SCANSION_TRY(format, parse_format(values.text("format")));
  out.import.format = format;
  SCANSION_TRY(unit, parse_unit(values.text("unit")));
  out.import.unit = unit;
  SCANSION_TRY(resolution, parse_resolution(values.text("resolution")));
  out.import.resolution = resolution;
  out.import.gap_mm = values.get<double>("gap");
  SCANSION_TRY(rate, parse_rate(values.text("rate")));
  out.rate = rate;
  out.loop = values.flag("loop");
  return out;
}

} // namespace scansion
