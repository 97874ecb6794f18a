// Found feature lines and patches from the files that `scansion export` writes.
// SPDX-License-Identifier: Apache-2.0
#include "tests/score/found_file.hpp"

#include <charconv>
#include <optional>

namespace scansion::score {
namespace {

std::string_view take_row(std::string_view& text) noexcept {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view row = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return row;
}

/// The next number of `row`; empty at its end or before what is none.
std::optional<double> take_number(std::string_view& row) noexcept {
  while (row.starts_with(' ') || row.starts_with('\t')) row.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(row.data(), row.data() + row.size(), value);
  if (error != std::errc{}) return std::nullopt;
  row.remove_prefix(static_cast<std::size_t>(end - row.data()));
  return value;
}

std::optional<FeatureType> type_in(std::string_view header) {
  constexpr std::string_view kKey = " type=";
  const std::size_t at = header.find(kKey);
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view word = header.substr(at + kKey.size());
  for (std::size_t k = 0; k < kFeatureTypes; ++k) {
    const auto type = static_cast<FeatureType>(k);
    if (word.substr(0, word.find(' ')) == name(type)) return type;
  }
  return std::nullopt;
}

} // namespace

Result<std::vector<FoundLine>> parse_lines_text(std::string_view text) {
  std::vector<FoundLine> lines;
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view row = take_row(text);
    if (row.starts_with("# id=")) {
      const auto type = type_in(row);
      if (!type) return fail(Errc::undecodable, "row ", std::to_string(number), ": no known type in '", row, "'");
      lines.push_back({*type, {}});
      continue;
    }
    if (row.empty() || row.starts_with('#')) continue;
    const auto x = take_number(row);
    const auto y = take_number(row);
    const auto z = take_number(row);
    if (!z || lines.empty()) return fail(Errc::undecodable, "row ", std::to_string(number), ": not a vertex of a feature line");
    lines.back().points.push_back({*x, *y, *z});
  }
  return lines;
}

Result<std::vector<std::vector<std::uint32_t>>> parse_patches_text(std::string_view text, const Truth& truth) {
  std::vector<std::vector<std::uint32_t>> patches;
  std::size_t line = 0;
  std::size_t left = 0;
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view row = take_row(text);
    if (row.empty() || row.starts_with('#')) continue;
    std::optional<double> value;
    for (int k = 0; k < 4; ++k) value = take_number(row);
    if (!value) return fail(Errc::undecodable, "row ", std::to_string(number), ": not x y z patch");
    if (left == 0) {
      if (line == truth.lines.size()) return fail(Errc::undecodable, "more points than the scan has");
      for (const TrueRun& run : truth.lines[line]) left += run.count;
      patches.emplace_back();
      ++line;
    }
    --left;
    patches.back().push_back(*value < 0.0 ? kNoPatch : static_cast<std::uint32_t>(*value));
  }
  return patches;
}

} // namespace scansion::score
