// The points as text, packed by the programs that everybody has.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/packers.hpp"

#include "pipeline/export/value_format.hpp"
#include "tests/bench/process.hpp"
#include "tests/bench/scratch.hpp"

#include <zstd.h>

namespace scansion::bench {

Result<std::string> text_of(const LineSet& set) {
  SCANSION_TRY(format, ValueFormat::make(set.lattice, set.unit, false));
  std::string text;
  std::array<char, ValueFormat::kMaxText> value{};
  for (const LineBuffer& line : set.lines) {
    if (!text.empty()) text.push_back('\n');
    for (std::size_t k = 0; k < line.points(); ++k) {
      for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t ulp = line.ulp[a].empty() ? 0 : line.ulp[a][k];
        text.append(value.data(), format.write(value.data(), a, line.xyz[a][k], ulp));
        text.push_back(a == 2 ? '\n' : ' ');
      }
    }
  }
  return text;
}

Packed pack_text_xz(const std::string& text) {
  const ScratchFolder folder;
  const std::string file = folder.file("points.xyz");
  if (!write_file(file, text)) return {0, "no room"};
  const Ended ended = run_program({"xz", "-9", "-c", file});
  if (ended.status != 0) return {0, "not found: xz"};
  return {ended.out.size(), {}};
}

Packed pack_text_zstd(const std::string& text) {
  std::string out(ZSTD_compressBound(text.size()), '\0');
  return {ZSTD_compress(out.data(), out.size(), text.data(), text.size(), 19), {}};
}

} // namespace scansion::bench
