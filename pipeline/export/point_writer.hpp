// Writers of points: one per file format.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/export/output_file.hpp"
#include "pipeline/export/selection.hpp"
#include "pipeline/export/value_format.hpp"

#include <memory>
#include <string_view>

namespace scansion {

enum class PointFormat : std::uint8_t { xyz, csv, ply, pcd, obj, json };

/// The format of a name: "xyz" (or "txt"), "csv", "ply", "pcd", "obj", "json".
[[nodiscard]] Result<PointFormat> parse_point_format(std::string_view name);
/// True when the format's header holds the number of points, which is known at the end only.
[[nodiscard]] bool needs_patching(PointFormat format) noexcept;

struct PointStyle {
  Unit unit = Unit::mm;
  bool single = false; ///< IEEE single precision
  std::string remark;  ///< one line for the header comment
};

/// Receives the chosen points of all lines in order. Errors are those of the file.
class PointWriter {
public:
  virtual ~PointWriter() = default;
  PointWriter() = default;
  PointWriter(const PointWriter&) = delete;
  PointWriter& operator=(const PointWriter&) = delete;

  [[nodiscard]] virtual Result<void> begin(OutputFile& file) = 0;
  /// One scan line: the points of `group` with these indexes, ascending. Not called for a line without points.
  [[nodiscard]] virtual Result<void> line(OutputFile& file, std::uint64_t index, const LineGroup& group,
                                          std::span<const std::uint32_t> points) = 0;
  [[nodiscard]] virtual Result<void> end(OutputFile& file) = 0;
};

[[nodiscard]] std::unique_ptr<PointWriter> make_point_writer(PointFormat format, const ValueFormat& values,
                                                             const PointStyle& style);

/// The same for the binary forms; make_point_writer() calls it for ply and pcd.
[[nodiscard]] std::unique_ptr<PointWriter> make_binary_writer(PointFormat format, const ValueFormat& values,
                                                              const PointStyle& style);

/// IEEE residual of a point; 0 for lattices that have none.
[[nodiscard]] inline std::int64_t ulp_of(const LineGroup& group, std::size_t axis, std::uint32_t point) noexcept {
  return group.ulp[axis].empty() ? 0 : group.ulp[axis][point];
}

} // namespace scansion
