// Scan lines for a device model to play.
// SPDX-License-Identifier: Apache-2.0
#include "sim/player/line_source.hpp"

#include "pipeline/import/import.hpp"
#include "sim/scene/catalog.hpp"
#include "sim/scene/scanner.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {
namespace {

void append_line(const LineBuffer& from, const Lattice& lattice, double unit_mm, PlayedLine& to) {
  for (const Run& run : from.runs) {
    for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
      double mm[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        double value = lattice_value(lattice, lattice.origin[axis] + from.xyz[axis][i]);
        if (lattice.exact && !from.ulp[axis].empty()) value = step_ulps(lattice.source, value, from.ulp[axis][i]);
        mm[axis] = value * unit_mm;
      }
      to.push_back({mm[0], mm[1], mm[2], i == run.first});
    }
  }
}

} // namespace

struct LineSource::Impl {
  PlayPlan plan;
  std::optional<Importer> importer;
  std::optional<SceneScanner> scanner;
  LineBuffer buffer;
  SceneLine scene_line;
  PlayedBox box;
  double direction[2] = {1.0, 0.0}; ///< of the lines, in plan

  Result<void> begin() {
    if (plan.scan.empty()) {
      SCANSION_TRY(scene, make_scene(plan.scene));
      SCANSION_TRY(made, SceneScanner::create(std::move(scene), plan.plan));
      scanner.emplace(std::move(made));
      return success();
    }
    SCANSION_TRY(opened, Importer::open({plan.scan}, {}, {}));
    importer.emplace(std::move(opened));
    return importer->survey_all();
  }

  Result<bool> take(PlayedLine& line) {
    line.clear();
    if (scanner) {
      if (!scanner->next(scene_line)) return false;
      bool starts = true;
      for (const ScenePoint& point : scene_line.points) {
        if (!point.is_there()) {
          starts = true;
          continue;
        }
        line.push_back({point.x / 1000.0, point.y / 1000.0, point.z / 1000.0, starts});
        starts = false;
      }
      return true;
    }
    buffer.clear();
    SCANSION_TRY(more, importer->next(buffer));
    if (more) append_line(buffer, importer->lattice(), millimetres(importer->lattice().unit).value(), line);
    return more;
  }

  [[nodiscard]] double along(const PlayedPoint& point) const noexcept {
    return point.x * direction[0] + point.y * direction[1];
  }

  /// The direction of the first line that has one.
  bool find_direction(const PlayedLine& line) noexcept {
    if (line.size() < 2) return false;
    const double dx = line.back().x - line.front().x;
    const double dy = line.back().y - line.front().y;
    const double length = std::hypot(dx, dy);
    if (!(length > 0.0)) return false;
    direction[0] = dx / length;
    direction[1] = dy / length;
    // Along an axis exactly, where it is nearly so: coordinates stay what they are.
    for (std::size_t axis = 0; axis < 2; ++axis) {
      if (std::abs(direction[axis]) < 1e-6) {
        direction[axis] = 0.0;
        direction[1 - axis] = std::copysign(1.0, direction[1 - axis]);
      }
    }
    return true;
  }

  Result<void> survey() {
    PlayedLine line;
    bool has_direction = false;
    bool is_first = true;
    for (;;) {
      SCANSION_TRY(more, take(line));
      if (!more) break;
      ++box.lines;
      box.most_points = std::max(box.most_points, line.size());
      if (!has_direction) has_direction = find_direction(line);
      for (const PlayedPoint& point : line) {
        const double s = along(point);
        if (std::exchange(is_first, false)) {
          box.min_along = box.max_along = s;
          box.min_z = box.max_z = point.z;
        }
        box.min_along = std::min(box.min_along, s);
        box.max_along = std::max(box.max_along, s);
        box.min_z = std::min(box.min_z, point.z);
        box.max_z = std::max(box.max_z, point.z);
      }
    }
    if (box.lines == 0) return fail(Errc::undecodable, plan.scan, plan.scene, ": holds no scan line to play");
    return begin();
  }
};

LineSource::LineSource(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
LineSource::LineSource(LineSource&&) noexcept = default;
LineSource& LineSource::operator=(LineSource&&) noexcept = default;
LineSource::~LineSource() = default;

Result<LineSource> LineSource::open(const PlayPlan& plan) {
  if (plan.scan.empty() == plan.scene.empty()) return fail(Errc::usage, "give one of --scan FILE and --scene NAME to play");
  auto impl = std::make_unique<Impl>();
  impl->plan = plan;
  SCANSION_TRY(impl->begin());
  SCANSION_TRY(impl->survey());
  return LineSource(std::move(impl));
}

Result<bool> LineSource::next(PlayedLine& line) {
  SCANSION_TRY(more, impl_->take(line));
  if (more || !impl_->plan.loop) return more;
  SCANSION_TRY(impl_->begin());
  return impl_->take(line);
}

Result<void> LineSource::rewind() {
  return impl_->begin();
}

const PlayedBox& LineSource::box() const noexcept {
  return impl_->box;
}

double LineSource::along(const PlayedPoint& point) const noexcept {
  return impl_->along(point);
}

} // namespace scansion
