// Helpers of the import tests: scratch folders, and a whole import as plain values.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/import.hpp"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scansion::test {

/// A folder that is removed at the end of the test.
class Scratch {
public:
  Scratch();
  ~Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  [[nodiscard]] std::string path(const std::string& name = {}) const { return name.empty() ? folder_ : folder_ + "/" + name; }
  /// Writes a file (folders are made) and returns its path.
  std::string write(const std::string& name, std::string_view content) const;

private:
  std::string folder_;
};

using Point = std::array<double, 3>;

struct ImportedLine {
  std::vector<Point> points; ///< values in the input unit
  std::vector<Run> runs;
  std::uint32_t invalid_after = 0;
};

struct Imported {
  Lattice lattice;
  ImportCounts counts;
  std::vector<ImportedLine> lines;
  std::vector<std::string> notes;
  int restarts = 0; ///< how often survey_all() was called
  std::optional<Error> error;

  [[nodiscard]] std::vector<Point> points() const;
};

/// Opens, reads to the end, starts again after `finer`: what every caller of Importer does.
[[nodiscard]] Imported import_all(const std::vector<std::string>& inputs, const ImportOptions& options = {});
/// The same for the text of one file called scan.xyz (or `name`).
[[nodiscard]] Imported import_text(std::string_view text, const ImportOptions& options = {},
                                   const std::string& name = "scan.xyz");

/// Runs a shell command; true when it exits with 0.
[[nodiscard]] bool run_command(const std::string& command);

} // namespace scansion::test
