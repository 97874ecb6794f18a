// Import of any bytes: no crash, no hang, and the rules of Importer hold.
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/import_fuzz.hpp"

#include <cstdio>
#include <cstdlib>
#include <string>
#include <sys/mman.h>
#include <unistd.h>

namespace scansion::fuzz {
namespace {

void require(bool holds, const char* rule) {
  if (holds) return;
  static_cast<void>(std::fprintf(stderr, "broken: %s\n", rule));
  std::abort();
}

/// A file in memory, as a path.
class MemoryFile {
public:
  explicit MemoryFile(std::span<const std::uint8_t> content) : fd_(::memfd_create("scan", MFD_CLOEXEC)) {
    require(fd_ >= 0 && ::write(fd_, content.data(), content.size()) == static_cast<ssize_t>(content.size()), "memory file");
  }
  ~MemoryFile() { ::close(fd_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(fd_); }

private:
  int fd_;
};

void check_line(const LineBuffer& line, const Lattice& lattice) {
  std::size_t points = 0;
  std::uint64_t invalid = line.invalid_after;
  for (const Run& run : line.runs) {
    require(run.first == points && run.count > 0, "runs follow each other and are not empty");
    points += run.count;
    invalid += run.invalid_before;
  }
  require(points == line.points() && points + invalid > 0, "runs cover all points; no line is empty");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    require(line.xyz[axis].size() == points, "three coordinates each");
    require(line.ulp[axis].size() == (lattice.exact ? points : 0), "residuals for exact lattices only");
  }
}

/// Reads to the end or to an error; the counts so far.
ImportCounts read_lines(Importer& importer, Result<bool>& last) {
  LineBuffer line;
  std::uint64_t lines = 0;
  std::uint64_t points = 0;
  for (;;) {
    last = importer.next(line);
    if (!last || !last.value()) break;
    check_line(line, importer.lattice());
    ++lines;
    points += line.points();
  }
  require(importer.counts().lines == lines && importer.counts().points == points, "counts agree with the lines");
  return importer.counts();
}

} // namespace

void import_bytes(std::span<const std::uint8_t> content, const ImportOptions& options) {
  const MemoryFile file(content);
  auto opened = Importer::open({file.path()}, options, {});
  if (!opened) {
    require(opened.error().code != Errc::finer && opened.error().code != Errc::bug, "open explains what is wrong");
    require(opened.error().context.find("; ") != std::string::npos, "errors name the fix");
    return;
  }
  Importer importer = std::move(opened).value();
  require(resolution_mm(importer.lattice()).has_value(), "the resolution is a fraction in millimetres");
  Result<bool> last = false;
  const ImportCounts first = read_lines(importer, last);
  require(last || last.error().code != Errc::finer, "the first look saw all of a small input");
  const bool ended = last.has_value();
  const Lattice lattice = importer.lattice();
  const auto surveyed = importer.survey_all();
  require(surveyed || !ended, "what was read can be surveyed");
  if (!surveyed) return;
  require(importer.lattice() == lattice, "the lattice does not depend on the path");
  const ImportCounts second = read_lines(importer, last);
  require(last.has_value() == ended && first.lines == second.lines && first.points == second.points &&
              first.invalid == second.invalid && first.missing == second.missing,
          "two passes read the same");
}

ImportOptions options_of(std::uint8_t choice, ImportFormat format) {
  ImportOptions options;
  options.format = format;
  constexpr std::array<Unit, 4> kUnits{Unit::mm, Unit::m, Unit::um, Unit::in};
  options.unit = kUnits[choice & 3U];
  if ((choice >> 2U & 3U) == 1) options.resolution = ResolutionExact{};
  if ((choice >> 2U & 3U) == 2) options.resolution = ResolutionGiven{{3, 1000}};
  if ((choice & 0x10U) != 0) options.gap_mm = 2.5;
  if ((choice & 0x20U) != 0) options.grid_rows = true;
  if ((choice & 0x40U) != 0) options.columns = "-,z,line,x";
  if ((choice & 0x80U) != 0) options.spacing = 0.1;
  return options;
}

} // namespace scansion::fuzz
