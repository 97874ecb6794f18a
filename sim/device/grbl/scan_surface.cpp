// A recorded scan as a surface.
// SPDX-License-Identifier: Apache-2.0
#include "sim/device/grbl/scan_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scansion::sim::grbl {
namespace {

constexpr double kNothing = -std::numeric_limits<double>::infinity();
constexpr double kSame = 1e-6; // mm

bool lies_along_y(const PlayedLine& points) {
  const auto span = [&](double PlayedPoint::*axis) {
    const auto [low, high] = std::minmax_element(points.begin(), points.end(),
                                                 [&](const PlayedPoint& a, const PlayedPoint& b) { return a.*axis < b.*axis; });
    return (*high).*axis - (*low).*axis;
  };
  return span(&PlayedPoint::y) > span(&PlayedPoint::x);
}

} // namespace

ScanSurface::Line ScanSurface::make_line(const PlayedLine& points, bool is_along_y) {
  Line out;
  for (const PlayedPoint& point : points) {
    out.across += (is_along_y ? point.x : point.y) / static_cast<double>(points.size());
    out.knots.push_back({is_along_y ? point.y : point.x, point.z, point.starts_run});
  }
  const auto by_place = [](const Knot& a, const Knot& b) { return a.along < b.along; };
  if (out.knots.size() > 1 && out.knots.back().along < out.knots.front().along) {
    // Scanned backwards: a run then begins where it ended.
    std::vector<bool> starts(out.knots.size());
    for (std::size_t i = 0; i < out.knots.size(); ++i) starts[i] = out.knots[i].starts_run;
    std::reverse(out.knots.begin(), out.knots.end());
    for (std::size_t i = 0; i < out.knots.size(); ++i) out.knots[i].starts_run = i > 0 && starts[out.knots.size() - i];
  }
  std::stable_sort(out.knots.begin(), out.knots.end(), by_place);
  return out;
}

Result<ScanSurface> ScanSurface::read(LineSource& source) {
  ScanSurface out;
  PlayedLine line;
  for (;;) {
    SCANSION_TRY(more, source.next(line));
    if (!more) break;
    if (line.empty()) continue;
    if (out.lines_.empty()) out.is_along_y_ = lies_along_y(line);
    out.lines_.push_back(make_line(line, out.is_along_y_));
  }
  if (out.lines_.empty()) return fail(Errc::usage, "the scan has no point to probe");
  std::stable_sort(out.lines_.begin(), out.lines_.end(), [](const Line& a, const Line& b) { return a.across < b.across; });
  return out;
}

double ScanSurface::height(const Line& line, double along) noexcept {
  const auto& knots = line.knots;
  auto right =
      std::lower_bound(knots.begin(), knots.end(), along - kSame, [](const Knot& knot, double at) { return knot.along < at; });
  if (right == knots.end()) return kNothing;
  if (right->along <= along + kSame) return right->z;
  if (right == knots.begin() || right->starts_run) return kNothing;
  const Knot& left = *(right - 1);
  const double part = (along - left.along) / (right->along - left.along);
  return left.z + (right->z - left.z) * part;
}

double ScanSurface::height(double x, double y) const noexcept {
  const double along = is_along_y_ ? y : x, across = is_along_y_ ? x : y;
  if (lines_.size() == 1) return height(lines_.front(), along); // a profile without an end
  const auto right = std::lower_bound(lines_.begin(), lines_.end(), across - kSame,
                                      [](const Line& line, double at) { return line.across < at; });
  if (right == lines_.end()) return kNothing;
  if (right->across <= across + kSame) return height(*right, along);
  if (right == lines_.begin()) return kNothing;
  const Line& left = *(right - 1);
  const double low = height(left, along), high = height(*right, along);
  if (!std::isfinite(low) || !std::isfinite(high)) return kNothing;
  const double part = (across - left.across) / (right->across - left.across);
  return low + (high - low) * part;
}

} // namespace scansion::sim::grbl
