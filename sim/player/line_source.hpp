// Scan lines for a device model to play: of a recorded scan or of a scene, in millimetres.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"
#include "sim/scene/scan_plan.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace scansion {

struct PlayedPoint {
  double x = 0.0, y = 0.0, z = 0.0; ///< mm
  bool starts_run = false;          ///< invalid samples, or nothing, before it
};
using PlayedLine = std::vector<PlayedPoint>;

/// What to play: exactly one of the two.
struct PlayPlan {
  std::string scan;  ///< a recorded scan that `scansion compress` reads
  std::string scene; ///< a scene's name, scanned as `plan` says
  ScanPlan plan;
  bool loop = false; ///< from the first line again after the last
};

struct PlayedBox {
  double min_along = 0.0, max_along = 0.0; ///< mm along the lines
  double min_z = 0.0, max_z = 0.0;         ///< mm
  std::uint64_t lines = 0;
  std::size_t most_points = 0; ///< of a line
};

/// Memory follows one line. Thread-bound.
class LineSource {
public:
  /// Reads the whole scan once, for its extent and the direction of its lines.
  [[nodiscard]] static Result<LineSource> open(const PlayPlan& plan);
  LineSource(LineSource&&) noexcept;
  LineSource& operator=(LineSource&&) noexcept;
  ~LineSource();

  /// False after the last line, never with `loop`.
  [[nodiscard]] Result<bool> next(PlayedLine& line);
  [[nodiscard]] Result<void> rewind();
  [[nodiscard]] const PlayedBox& box() const noexcept;
  /// A point's place along the lines, mm.
  [[nodiscard]] double along(const PlayedPoint& point) const noexcept;

private:
  struct Impl;
  explicit LineSource(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

} // namespace scansion
