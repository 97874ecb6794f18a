// The keys of a grbl-probe device.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/grbl-probe/options.hpp"

namespace scansion::grbl {
namespace {

constexpr double kFarthestMm = 10'000.0;

Result<void> check_order(std::string_view text) {
  if (text != "serpentine" && text != "raster") return fail(Errc::config, "is neither \"serpentine\" nor \"raster\"");
  return success();
}

Option place(std::string_view key, std::string_view meaning, std::string_view example) {
  return {.key = key,
          .type = OptionType::number,
          .meaning = meaning,
          .required = true,
          .min = -kFarthestMm,
          .max = kFarthestMm,
          .example = example};
}

Option length(std::string_view key, OptionDefault standard, std::string_view meaning) {
  return {.key = key, .type = OptionType::number, .standard = standard, .meaning = meaning, .min = 0.01, .max = 1000.0};
}

std::vector<Option> own_rows() {
  return {
      place("x_from", "mm, first column, in machine coordinates like all places here", "-60.0"),
      place("x_to", "mm, last column", "-10.0"),
      place("y_from", "mm, first row; each row is a scan line along x", "-80.0"),
      place("y_to", "mm, last row", "-20.0"),
      place("top", "mm, height at which the tip touches nothing anywhere in the area", "-2.0"),
      place("bottom", "mm, the tip never goes lower; what it does not meet above is a hole", "-30.0"),
      length("pitch", 1.0, "mm from point to point of a row"),
      length("spacing", 1.0, "mm from row to row"),
      length("clearance", 2.0, "mm that the tip is lifted above the highest point known near its way"),
      {.key = "order",
       .standard = "serpentine",
       .meaning = "serpentine: odd rows are probed backwards; raster: all in the same direction",
       .check = check_order},
      {.key = "feed",
       .type = OptionType::number,
       .standard = 60.0,
       .meaning = "mm/min while probing",
       .min = 1.0,
       .max = 10'000.0},
      length("overtravel", 1.0, "mm that the probe may be pressed in while the machine brakes; feed is lowered to keep it"),
      {.key = "max_misses",
       .type = OptionType::integer,
       .standard = std::int64_t{20},
       .meaning = "so many points together may meet nothing; one more and the machine is stopped",
       .min = 0,
       .max = 1e6},
      {.key = "resume",
       .type = OptionType::flag,
       .standard = false,
       .meaning = "go on with the rows that the device's newest recording holds, if they are of this raster and not all of it"},
      {.key = "trust_position",
       .type = OptionType::flag,
       .standard = false,
       .meaning = "go on although a controller without homing was started anew or probed elsewhere: you know that its "
                  "coordinates are right"},
  };
}

} // namespace

std::span<const Option> probe_schema() {
  static const std::vector<Option> rows = with_transport(own_rows(), kTransports);
  return rows;
}

Result<ProbeOptions> probe_options(const OptionValues& values) {
  const auto number = [&](std::string_view key) { return values.get<double>(key).value_or(0.0); };
  ProbeOptions out;
  RasterArea& area = out.session.area;
  area.x_from = number("x_from");
  area.x_to = number("x_to");
  area.y_from = number("y_from");
  area.y_to = number("y_to");
  area.top = number("top");
  area.bottom = number("bottom");
  area.pitch = number("pitch");
  area.spacing = number("spacing");
  area.clearance = number("clearance");
  area.serpentine = values.text("order") != "raster";
  out.session.feed = number("feed");
  out.session.overtravel = number("overtravel");
  out.session.max_misses = static_cast<std::uint32_t>(values.integer("max_misses"));
  out.session.trust_position = values.flag("trust_position");
  out.resume = values.flag("resume");
  SCANSION_TRY(Raster::create(area));
  return out;
}

} // namespace scansion::grbl
