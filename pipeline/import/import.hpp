// Recorded scans of other programs to scan lines on a lattice.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/lattice.hpp"
#include "pipeline/model/scan_line.hpp"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace scansion {

enum class ImportFormat : std::uint8_t { automatic, xyz, ply, csv };

struct ResolutionAuto {};  ///< found from the decimals; IEEE input whose decimals do not fit is kept exactly
struct ResolutionExact {}; ///< every bit of the IEEE value of each coordinate is kept
struct ResolutionGiven {
  Rational input_units; ///< per count; values are rounded to the nearest count, the largest error is reported
};

struct ImportOptions {
  ImportFormat format = ImportFormat::automatic;
  Unit unit = Unit::mm; ///< of the input
  std::variant<ResolutionAuto, ResolutionExact, ResolutionGiven> resolution = ResolutionAuto{};
  std::optional<double> gap_mm;     ///< a longer step between two points starts a new run
  bool grid_rows = false;           ///< a range grid's rows are the scan lines (default: its columns)
  double spacing = 1.0;             ///< input units between profiles that have no y: y = line number * spacing
  std::string columns;              ///< meaning of text columns, e.g. "x,z,-"; empty: found
  std::string name_for_stdin = "-"; ///< shown in errors
};

struct ImportCounts {
  std::uint64_t lines = 0, points = 0, invalid = 0; ///< invalid: NaN and the like
  std::uint64_t missing = 0;                        ///< empty cells of a range grid
  double rounding_mm = 0.0;                         ///< largest rounding error so far
  std::uint64_t bytes_read = 0, bytes_total = 0;    ///< for progress; bytes_total 0: unknown
};

/// Reads one scan made of one or more inputs (files, folders, archives, packed files, "-" for standard input), streaming.
/// Memory follows the line (plus the vertices of a range grid), not the input.
class Importer {
public:
  /// Opens the inputs, finds format and lattice. Errors name file, row, reason and fix. `note` receives one-line remarks for a
  /// person (a column taken for labels, files passed over); may be empty.
  [[nodiscard]] static Result<Importer> open(const std::vector<std::string>& inputs, const ImportOptions& options,
                                             std::function<void(const std::string&)> note);
  Importer(Importer&&) noexcept;
  Importer& operator=(Importer&&) noexcept;
  ~Importer();

  [[nodiscard]] const Lattice& lattice() const noexcept;
  /// The next scan line; false at the end. Fails with `finer` when a later value does not fit the lattice that the first part
  /// of the input called for: then call survey_all() and start the output again from the first line.
  [[nodiscard]] Result<bool> next(LineBuffer& line);
  /// Goes through the whole input for the lattice, then stands before the first line again.
  [[nodiscard]] Result<void> survey_all();
  [[nodiscard]] const ImportCounts& counts() const noexcept;

private:
  struct Impl;
  explicit Importer(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

} // namespace scansion
