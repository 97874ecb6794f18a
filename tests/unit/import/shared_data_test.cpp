// Real recordings read directly give the very points of their converter. Needs SCANSION_SHARED_DATA, the folder of recordings.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/import/support.hpp"

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <gtest/gtest.h>

namespace scansion::test {
namespace {

std::string shared_data() {
  const char* folder = std::getenv("SCANSION_SHARED_DATA"); // NOLINT(concurrency-mt-unsafe)
  return folder != nullptr ? folder : "";
}

/// Points as text, in the converter's form.
std::string text_of(const Imported& imported) {
  std::string out;
  std::array<char, 64> number{};
  for (const ImportedLine& line : imported.lines) {
    if (&line != imported.lines.data()) out += '\n';
    for (const Point& point : line.points)
      for (std::size_t axis = 0; axis < 3; ++axis) {
        char* const last = number.data() + number.size();
        const auto end = imported.lattice.source == Source::float32
                             ? std::to_chars(number.data(), last, static_cast<float>(point[axis]), std::chars_format::fixed)
                             : std::to_chars(number.data(), last, point[axis], std::chars_format::fixed);
        out.append(number.data(), end.ptr);
        out += axis < 2 ? ' ' : '\n';
      }
  }
  return out;
}

/// Zeros that a decimal does not need, taken off: sources write 3.50 and 3.5.
std::string without_zeros(const std::string& text) {
  std::string out;
  std::string word;
  const auto flush = [&] {
    if (word.find('.') != std::string::npos) word.erase(word.find_last_not_of('0') + 1);
    if (!word.empty() && word.back() == '.') word.pop_back();
    out += word == "-0" ? "0" : word;
    word.clear();
  };
  for (const char c : text) {
    if (c == ' ' || c == '\n') {
      flush();
      out += c;
    } else {
      word += c;
    }
  }
  flush();
  return out;
}

void compare(const std::string& set, const std::string& format, Unit unit, std::uint64_t lines, std::uint64_t points) {
  const std::string folder = shared_data();
  if (folder.empty()) GTEST_SKIP() << "SKIPPED LOUDLY: set SCANSION_SHARED_DATA to the folder of recordings to compare " << set;
  const Scratch scratch;
  const std::string packed = folder + "/" + set + "/" + set + ".tar.xz";
  ASSERT_TRUE(run_command("python3 '" + folder + "/to_scanlines.py' " + format + " '" + packed +
                          "' 2>/dev/null | grep -v '^#' > '" + scratch.path("want.xyz") + "'"));
  ImportOptions options;
  options.unit = unit;
  const Imported direct = import_all({packed}, options);
  ASSERT_FALSE(direct.error) << direct.error->context;
  EXPECT_EQ(direct.counts.lines, lines);
  EXPECT_EQ(direct.counts.points, points);
  std::string want;
  std::FILE* file = std::fopen(scratch.path("want.xyz").c_str(), "rb");
  ASSERT_NE(file, nullptr);
  std::array<char, 65536> block;
  for (std::size_t n = 0; (n = std::fread(block.data(), 1, block.size(), file)) > 0;) want.append(block.data(), n);
  ASSERT_EQ(std::fclose(file), 0);
  EXPECT_TRUE(text_of(direct) == without_zeros(want));
  const Imported again = import_all({scratch.path("want.xyz")}, options);
  ASSERT_FALSE(again.error) << again.error->context;
  EXPECT_EQ(again.lattice, direct.lattice);
  EXPECT_TRUE(again.points() == direct.points());
}

TEST(SharedData, ProfilesFromATarOfCsv) {
  compare("profiler-sphere", "csv-profiles", Unit::mm, 908, 800413);
}
TEST(SharedData, RangeGridsFromATarOfPly) {
  compare("bunny-range", "ply-grid", Unit::m, 3117, 362272);
}

} // namespace
} // namespace scansion::test
