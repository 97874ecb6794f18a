// Helpers of the import tests.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/import/support.hpp"

#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

namespace scansion::test {

Scratch::Scratch() {
  std::string pattern = (std::filesystem::temp_directory_path() / "scansion-import-XXXXXX").string();
  folder_ = ::mkdtemp(pattern.data()) != nullptr ? pattern : std::string();
  EXPECT_FALSE(folder_.empty());
}

Scratch::~Scratch() {
  std::error_code error;
  std::filesystem::remove_all(folder_, error);
}

std::string Scratch::write(const std::string& name, std::string_view content) const {
  const std::filesystem::path file = path(name);
  std::filesystem::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::binary);
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  EXPECT_TRUE(out.good()) << file;
  return file.string();
}

std::vector<Point> Imported::points() const {
  std::vector<Point> all;
  for (const ImportedLine& line : lines) all.insert(all.end(), line.points.begin(), line.points.end());
  return all;
}

namespace {

ImportedLine values_of(const Lattice& lattice, const LineBuffer& buffer) {
  ImportedLine line;
  line.runs = buffer.runs;
  line.invalid_after = buffer.invalid_after;
  for (std::size_t i = 0; i < buffer.points(); ++i) {
    Point point{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      point[axis] = lattice_value(lattice, lattice.origin[axis] + buffer.xyz[axis][i]);
      if (lattice.exact) point[axis] = step_ulps(lattice.source, point[axis], buffer.ulp[axis][i]);
    }
    line.points.push_back(point);
  }
  return line;
}

} // namespace

Imported import_all(const std::vector<std::string>& inputs, const ImportOptions& options) {
  Imported result;
  auto opened = Importer::open(inputs, options, [&](const std::string& note) { result.notes.push_back(note); });
  if (!opened) {
    result.error = opened.error();
    return result;
  }
  Importer importer = std::move(opened).value();
  LineBuffer buffer;
  for (;;) {
    const auto more = importer.next(buffer);
    if (!more && more.error().code == Errc::finer && result.restarts == 0) {
      ++result.restarts;
      result.lines.clear();
      const auto surveyed = importer.survey_all();
      if (surveyed) continue;
      result.error = surveyed.error();
      return result;
    }
    if (!more) result.error = more.error();
    if (!more || !more.value()) break;
    EXPECT_EQ(buffer.ulp[0].size(), importer.lattice().exact ? buffer.points() : 0U);
    result.lines.push_back(values_of(importer.lattice(), buffer));
  }
  result.lattice = importer.lattice();
  result.counts = importer.counts();
  return result;
}

Imported import_text(std::string_view text, const ImportOptions& options, const std::string& name) {
  const Scratch scratch;
  return import_all({scratch.write(name, text)}, options);
}

bool run_command(const std::string& command) {
  return std::system(command.c_str()) == 0;
} // NOLINT(cert-env33-c)

} // namespace scansion::test
