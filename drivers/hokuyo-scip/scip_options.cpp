// The keys of a hokuyo-scip device.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/hokuyo-scip/scip_options.hpp"

namespace scansion::scip {
namespace {

Result<void> check_mode(std::string_view text) {
  if (text == "MD" || text == "MS" || text == "ME" || text == "ND" || text == "NE") return success();
  return fail(Errc::config, "is none of MD, MS, ME, ND, NE");
}

std::optional<EchoChoice> parse_echo(std::string_view text) noexcept {
  if (text == "nearest") return EchoChoice::nearest;
  if (text == "farthest") return EchoChoice::farthest;
  if (text == "strongest") return EchoChoice::strongest;
  return std::nullopt;
}

Result<void> check_echo(std::string_view text) {
  if (parse_echo(text)) return success();
  return fail(Errc::config, "is none of nearest, farthest, strongest");
}

std::vector<Option> all_rows() {
  constexpr double kMostStep = 9999;
  std::vector<Option> rows{
      {.key = "mode",
       .standard = "MD",
       .meaning =
           "MD: distances to 262 m; MS: to 4 m, in two thirds of the bytes; ME: with intensity, twice the bytes; ND, NE: "
           "MD, ME with up to three echoes a step",
       .check = check_mode},
      {.key = "echo",
       .standard = "nearest",
       .meaning = "the echo that is the point, of ND and NE: nearest, farthest or (NE) strongest",
       .check = check_echo},
      {.key = "start",
       .type = OptionType::integer,
       .meaning = "first step; without it the sensor's first",
       .min = 0,
       .max = kMostStep,
       .example = "180"},
      {.key = "end",
       .type = OptionType::integer,
       .meaning = "last step; without it the sensor's last",
       .min = 0,
       .max = kMostStep,
       .example = "900"},
      {.key = "cluster",
       .type = OptionType::integer,
       .standard = std::int64_t{1},
       .meaning = "steps that are made into one point, the nearest",
       .min = 1,
       .max = 99},
      {.key = "skip",
       .type = OptionType::integer,
       .standard = std::int64_t{0},
       .meaning = "scans left out after each one",
       .min = 0,
       .max = 9},
      {.key = "height",
       .type = OptionType::number,
       .standard = 0.0,
       .meaning = "mm, z of the sensor, which looks down",
       .min = -1e6,
       .max = 1e6},
      {.key = "gap",
       .type = OptionType::number,
       .meaning = "a step longer than this many mm splits a line; without it no step does",
       .min = 1e-3,
       .max = 1e6,
       .example = "50.0"},
  };
  for (const Option& row : spacing_rows()) {
    if (row.key != "encoder") rows.push_back(row); // the sensors have none
  }
  rows.push_back({.key = "change_baud",
                  .type = OptionType::integer,
                  .meaning = "bit/s to which an RS-232 sensor is told to change after it answered at baud",
                  .min = 19200,
                  .max = 750'000,
                  .example = "115200",
                  .alternative = true});
  return with_transport(rows, kScipKinds);
}

} // namespace

std::span<const Option> schema() noexcept {
  static const std::vector<Option> rows = all_rows();
  return rows;
}

Result<Options> read_options(const OptionValues& values) {
  Options out;
  const std::string mode = values.text("mode");
  out.plan.has_echoes = mode[0] == 'N';
  out.plan.kind = mode[1];
  out.plan.echo = parse_echo(values.text("echo")).value_or(EchoChoice::nearest);
  if (out.plan.echo != EchoChoice::nearest && !out.plan.has_echoes)
    return fail(Errc::config, "echo = \"", values.text("echo"), "\": mode = \"", mode, "\" has one echo a step; use ND or NE");
  if (out.plan.echo == EchoChoice::strongest && mode != "NE")
    return fail(Errc::config, "echo = \"strongest\" needs intensities; use mode = \"NE\"");
  const auto step = [&](std::string_view key) -> std::optional<std::int32_t> {
    const auto value = values.get<std::int64_t>(key);
    return value ? std::optional(static_cast<std::int32_t>(*value)) : std::nullopt;
  };
  out.start = step("start");
  out.end = step("end");
  if (out.start && out.end && *out.end < *out.start) return fail(Errc::config, "end is before start");
  out.plan.cluster = static_cast<std::int32_t>(values.integer("cluster"));
  out.plan.skip = static_cast<std::int32_t>(values.integer("skip"));
  out.baud = static_cast<int>(values.integer("baud"));
  if (const auto rate = values.get<std::int64_t>("change_baud")) {
    if (values.find("port") == nullptr && values.find("transcript") == nullptr)
      return fail(Errc::config, "change_baud is for a serial port; remove it, or give port");
    out.change_baud = static_cast<int>(*rate);
  }
  out.height_mm = values.get<double>("height").value_or(0.0);
  out.gap_mm = values.get<double>("gap");
  SCANSION_TRY(spacing, LineSpacing::create(values));
  out.spacing = spacing;
  return out;
}

} // namespace scansion::scip
