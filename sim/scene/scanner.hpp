// Scans a scene line by line: true points of the surface in the scan plane, with noise and faults, in whole micrometres.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"
#include "sim/scene/random.hpp"
#include "sim/scene/scan_plan.hpp"
#include "sim/scene/scene.hpp"

#include <cstdint>
#include <vector>

namespace scansion {

enum class SampleState : std::uint8_t {
  measured,
  outlier, ///< its height carries a spike
  missing, ///< a dropout; its coordinates are 0
  hole     ///< nothing is there to be measured; x and y are known
};

struct ScenePoint {
  std::int32_t x = 0, y = 0, z = 0; ///< um
  SampleState state = SampleState::measured;

  [[nodiscard]] bool is_there() const noexcept { return state == SampleState::measured || state == SampleState::outlier; }
  friend bool operator==(const ScenePoint&, const ScenePoint&) = default;
};

struct SceneLine {
  std::uint32_t index = 0;
  bool missing = false;           ///< the whole line was lost: no points
  std::vector<ScenePoint> points; ///< in the order of scanning
};

struct ScanCounts {
  std::uint64_t lines = 0;  ///< with at least one point
  std::uint64_t points = 0; ///< measured and outliers
  std::uint64_t outliers = 0, dropouts = 0, missing_lines = 0;
  std::uint64_t in_holes = 0; ///< samples with nothing to measure
};

/// The same scene, plan and seed give the same lines on every machine. Memory follows one line. Thread-bound.
class SceneScanner {
public:
  /// Fails with usage when the plan cannot be carried out.
  [[nodiscard]] static Result<SceneScanner> create(Scene scene, const ScanPlan& plan);

  /// The next line into `line`, whose buffer is used again; false after the last.
  [[nodiscard]] bool next(SceneLine& line);

  /// Lines come as they are and not as the machine tells of them: in the order along the line, without backlash.
  void undeceive() noexcept { deceived_ = false; }

  [[nodiscard]] const Scene& scene() const noexcept { return scene_; }
  [[nodiscard]] const ScanGeometry& geometry() const noexcept { return geometry_; }
  /// Of the lines so far.
  [[nodiscard]] const ScanCounts& counts() const noexcept { return counts_; }

private:
  SceneScanner(Scene scene, const ScanPlan& plan, const ScanGeometry& geometry);

  [[nodiscard]] std::uint32_t samples_of_line(std::uint32_t index) noexcept;
  void mark_dropouts(std::uint32_t index, std::vector<ScenePoint>& points) const;
  void measure(SceneLine& line) const;
  void count(const SceneLine& line) noexcept;
  [[nodiscard]] double texture(std::uint32_t sample, Random& coin) const noexcept;
  [[nodiscard]] ScenePoint place(double s, double t, double disturbance) const noexcept;
  void move_along(ScenePoint& point, double um) const noexcept;
  [[nodiscard]] double trace(double x, double y) const noexcept;

  Scene scene_;
  ScanPlan plan_;
  ScanGeometry geometry_;
  ScanCounts counts_;
  bool deceived_ = true;
  std::uint32_t line_ = 0;
  std::uint64_t carry_ = 0; // what is left over from handing out samples to lines
  double keep_ = 0.0;       // share of a sample's noise that the next one keeps
  double fresh_ = 1.0;      // and of new noise
};

} // namespace scansion
