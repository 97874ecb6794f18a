// Parsing and printing the choice of an alpha-set.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/model/alpha_set.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace scansion {
namespace {

constexpr double kMaxTolerance = 1e9; // mm

Result<double> parse_tolerance(std::string_view text, std::string_view what) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value) || value <= 0 || value > kMaxTolerance)
    return fail(Errc::usage, what, " '", text, "' is no number of millimetres above 0 and at most 1e9");
  return value;
}

Result<std::uint32_t> parse_count(std::string_view text) {
  std::uint32_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (error != std::errc{} || end != text.data() + text.size() || count < 1 || count > kMaxLevels)
    return fail(Errc::usage, "number of levels '", text, "' is not 1 to ", std::to_string(kMaxLevels));
  return count;
}

Result<LevelSpec> parse_explicit(std::string_view list) {
  LevelSpec spec;
  spec.kind = LevelSpec::Kind::explicit_list;
  while (true) {
    const std::size_t comma = list.find(',');
    SCANSION_TRY(value, parse_tolerance(list.substr(0, comma), "tolerance"));
    if (!spec.explicit_tolerances.empty() && value >= spec.explicit_tolerances.back())
      return fail(Errc::usage, "explicit tolerances must decrease: write the coarsest first");
    spec.explicit_tolerances.push_back(value);
    if (comma == std::string_view::npos) break;
    list.remove_prefix(comma + 1);
  }
  if (spec.explicit_tolerances.size() > kMaxLevels)
    return fail(Errc::usage, "more than ", std::to_string(kMaxLevels), " tolerances");
  spec.count = static_cast<std::uint32_t>(spec.explicit_tolerances.size());
  return spec;
}

std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

} // namespace

Result<Floor> parse_floor(std::string_view text) {
  if (text == "off") return Floor{};
  if (text == "half") return Floor{0.5, true};
  const auto mm = parse_tolerance(text, "floor");
  if (!mm)
    return fail(Errc::usage, "floor '", text, "' is none of off, half or a number of millimetres above 0 and at most 1e9");
  return Floor{mm.value(), false};
}

std::string to_string(const Floor& floor) {
  if (!floor.on()) return "off";
  return floor.counts ? "half" : shortest(floor.value);
}

Result<LevelSpec> parse_level_spec(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string_view kind = text.substr(0, colon);
  if (colon == std::string_view::npos || (kind != "geometric" && kind != "uniform" && kind != "explicit"))
    return fail(Errc::usage, "levels '", text, "' are none of geometric:N[:RATIO], uniform:N[:DMAX], explicit:T1,T2,...");
  const std::string_view rest = text.substr(colon + 1);
  if (kind == "explicit") return parse_explicit(rest);

  LevelSpec spec;
  spec.kind = kind == "geometric" ? LevelSpec::Kind::geometric : LevelSpec::Kind::uniform;
  const std::size_t second = rest.find(':');
  SCANSION_TRY(count, parse_count(rest.substr(0, second)));
  spec.count = count;
  if (second == std::string_view::npos) return spec;
  SCANSION_TRY(value, parse_tolerance(rest.substr(second + 1), kind == "geometric" ? "ratio" : "largest tolerance"));
  if (spec.kind == LevelSpec::Kind::geometric) {
    if (value < 1.1 || value > 100) return fail(Errc::usage, "ratio '", rest.substr(second + 1), "' is not 1.1 to 100");
    spec.ratio = value;
  } else {
    spec.d_max = value;
  }
  return spec;
}

std::string to_string(const LevelSpec& spec) {
  switch (spec.kind) {
    case LevelSpec::Kind::geometric: return "geometric:" + std::to_string(spec.count) + ":" + shortest(spec.ratio);
    case LevelSpec::Kind::uniform:
      return "uniform:" + std::to_string(spec.count) + (spec.d_max > 0 ? ":" + shortest(spec.d_max) : std::string{});
    case LevelSpec::Kind::explicit_list: break;
  }
  std::string text = "explicit:";
  for (const double t : spec.explicit_tolerances) {
    if (text.back() != ':') text += ',';
    text += shortest(t);
  }
  return text;
}

} // namespace scansion
