// The true feature curves of a scene within a scan.
// SPDX-License-Identifier: Apache-2.0
#include "sim/truth/curves.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {
namespace {

constexpr double kStep = 0.05;                      // mm from point to point of a curve
constexpr double kShortest = 0.3;                   // mm; shorter pieces are left out
constexpr double kJump = 0.03;                      // mm of height between points: a wall of another feature
constexpr double kSmoothCrest = 0.5;                // mm of radius; a rounder crest between two slopes is a ridge or valley
constexpr double kCrestSlope = 0.24932800284318068; // tan 14 degrees, of both sides of a ridge
constexpr double kDegrees = 57.295779513082320877;

struct Gradient {
  double x = 0.0, y = 0.0;
};

/// Of everything but feature `without`.
Gradient slope_of_others(const Scene& scene, std::size_t without, double x, double y) noexcept {
  constexpr double h = 1e-4;
  const auto z = [&](double u, double v) {
    double sum = scene.base.incline(u, v) + scene.base.relief(u, v);
    for (std::size_t k = 0; k < scene.features.size(); ++k) {
      if (k != without) sum += scene.features[k].height(u, v);
    }
    return sum;
  };
  return {(z(x + h, y) - z(x - h, y)) / (2.0 * h), (z(x, y + h) - z(x, y - h)) / (2.0 * h)};
}

/// Degrees between the surfaces of two sides: slopes `m1` along `n1` and `m2` along `n2`, on top of what else slopes there.
double turning(Gradient g, double m1, PlanVector n1, double m2, PlanVector n2) noexcept {
  struct Normal {
    double x, y, z;
  };
  const auto normal = [&](double m, PlanVector n) {
    if (std::isinf(m)) return Normal{m > 0.0 ? -n.x : n.x, m > 0.0 ? -n.y : n.y, 0.0};
    const Normal raw{-g.x - m * n.x, -g.y - m * n.y, 1.0};
    const double length = std::sqrt(raw.x * raw.x + raw.y * raw.y + 1.0);
    return Normal{raw.x / length, raw.y / length, 1.0 / length};
  };
  const Normal a = normal(m1, n1);
  const Normal b = normal(m2, n2);
  return kDegrees * std::acos(std::clamp(a.x * b.x + a.y * b.y + a.z * b.z, -1.0, 1.0));
}

FeatureType type_of(const ProfileBend& bend) noexcept {
  const bool concave = bend.slope_outside > bend.slope_inside;
  if (bend.wall > 0.0) return concave ? FeatureType::step_bottom : FeatureType::step_top;
  const bool crest = bend.radius >= kSmoothCrest && bend.slope_inside * bend.slope_outside < 0.0 &&
                     std::min(std::fabs(bend.slope_inside), std::fabs(bend.slope_outside)) >= kCrestSlope;
  if (concave) return crest ? FeatureType::valley : FeatureType::concave;
  return crest ? FeatureType::ridge : FeatureType::convex;
}

/// Looks at places of one scene in one scan.
class Looker {
public:
  Looker(const Scene& scene, const ScanGeometry& geometry) : scene_(scene), geometry_(geometry) {
    // Half the window in plan; a leaning sheet reaches farther by the part's height.
    const double reach = 0.001 * (geometry.window + geometry.spacing * geometry.lines) +
                         std::max(std::fabs(scene.relief_low), std::fabs(scene.relief_high)) + 1.0;
    const double x = geometry.centre_x / 1000.0;
    const double y = geometry.centre_y / 1000.0;
    window_ = {x - reach, x + reach, y - reach, y + reach};
  }

  [[nodiscard]] const Box& window() const noexcept { return window_; }

  /// Does the scan see the place? A leaning plane looks from above along its own slope.
  [[nodiscard]] bool sees(const std::array<double, 3>& p) const noexcept {
    const SinCos& turn = geometry_.direction;
    const SinCos& tilt = geometry_.tilt;
    const double h = p[2] / tilt.cos;
    const double x = (p[0] + h * tilt.sin * turn.sin) * 1000.0 - geometry_.centre_x;
    const double y = (p[1] - h * tilt.sin * turn.cos) * 1000.0 - geometry_.centre_y;
    return in_window(x * turn.cos + y * turn.sin, y * turn.cos - x * turn.sin) && !hidden(p);
  }

private:
  [[nodiscard]] bool in_window(double s, double t) const noexcept {
    const double line = t / geometry_.spacing + 0.5 * (geometry_.lines - 1.0);
    if (line < 0.0 || line > geometry_.lines - 1.0) return false;
    double middle = 0.0;
    double points = geometry_.points;
    if (scene_.span != nullptr) {
      const auto index = static_cast<std::uint32_t>(std::lround(line));
      middle = scene_.span((index + 0.5) / geometry_.lines).centre * geometry_.window;
      points = static_cast<double>(geometry_.samples) * static_cast<double>(line_weight(scene_, index, geometry_.lines)) /
               static_cast<double>(geometry_.weight);
    }
    return std::fabs(s - middle) <= 0.5 * (points - 1.0) * geometry_.pitch;
  }

  [[nodiscard]] bool hidden(const std::array<double, 3>& p) const noexcept {
    const SinCos& tilt = geometry_.tilt;
    if (tilt.sin == 0.0) return false;
    const double dx = -tilt.sin * geometry_.direction.sin;
    const double dy = tilt.sin * geometry_.direction.cos;
    const double step = 0.05 / std::fabs(tilt.sin); // mm along the ray: 0.05 in plan
    for (double h = step; scene_.base.incline(p[0] + h * dx, p[1] + h * dy) + scene_.relief_high > p[2] + h * tilt.cos;
         h += step) {
      if (scene_.height(p[0] + h * dx, p[1] + h * dy) > p[2] + h * tilt.cos) return true;
    }
    return false;
  }

  const Scene& scene_;
  const ScanGeometry& geometry_;
  Box window_;
};

/// Collects the points of one outline curve and breaks it where it cannot be seen.
class Pieces {
public:
  explicit Pieces(const TrueCurve& like) : like_(like) {}

  void add(const std::array<double, 3>& point) {
    if (!open_.empty() && std::fabs(open_.back()[2] - point[2]) >
                              kJump + 3.0 * std::hypot(point[0] - open_.back()[0], point[1] - open_.back()[1])) {
      cut();
    }
    open_.push_back(point);
  }
  void cut() {
    if (!open_.empty()) pieces_.push_back(std::move(open_));
    open_.clear();
    whole_ = false;
  }
  void finish(bool closed, std::vector<TrueCurve>& curves) {
    const bool whole = whole_ && closed;
    const bool reaches_end = !open_.empty();
    if (reaches_end) pieces_.push_back(std::move(open_));
    if (closed && !whole && begins_ && reaches_end && pieces_.size() > 1) { // the last piece goes on as the first one
      auto& last = pieces_.back();
      last.insert(last.end(), pieces_.front().begin(), pieces_.front().end());
      pieces_.front() = std::move(last);
      pieces_.pop_back();
    }
    for (auto& piece : pieces_) {
      if (kStep * static_cast<double>(piece.size()) < kShortest) continue;
      TrueCurve& curve = curves.emplace_back(like_);
      curve.closed = whole;
      curve.points = std::move(piece);
    }
  }
  void first_point_seen(bool seen) noexcept { begins_ = seen; }

private:
  TrueCurve like_;
  std::vector<std::array<double, 3>> open_;
  std::vector<std::vector<std::array<double, 3>>> pieces_;
  bool whole_ = true, begins_ = false;
};

class CurveMaker {
public:
  CurveMaker(const Scene& scene, const ScanGeometry& geometry) : scene_(scene), looker_(scene, geometry) {}

  std::vector<TrueCurve> make() {
    for (std::size_t k = 0; k < scene_.features.size(); ++k) {
      const Feature& feature = scene_.features[k];
      for (const ProfileBend& bend : feature.profile().bends()) add_bend(k, bend);
      add_crests(k);
    }
    for (std::size_t k = 0; k < scene_.holes.size(); ++k) add_rim(k);
    return std::move(curves_);
  }

private:
  template <class Height, class Turning>
  void add(const TrueCurve& like, const std::vector<OutlineCurve>& outlines, Height height_at, Turning turning_at) {
    for (const OutlineCurve& outline : outlines) {
      Pieces pieces(like);
      for (std::size_t k = 0; k < outline.points.size(); ++k) {
        const OutlinePoint& at = outline.points[k];
        const std::array<double, 3> point{at.x, at.y, height_at(at)};
        const bool seen = turning_at(at) >= kLeastTurning && looker_.sees(on_surface(point, like.radius_mm));
        if (k == 0) pieces.first_point_seen(seen);
        if (seen)
          pieces.add(point);
        else
          pieces.cut();
      }
      pieces.finish(outline.closed, curves_);
    }
  }

  /// Of everything but a feature.
  [[nodiscard]] double height_of_others(std::size_t without, const OutlinePoint& at) const noexcept {
    return scene_.height(at.x, at.y) - scene_.features[without].height(at.x, at.y);
  }

  /// The edge of a fillet lies inside the material: what a scan sees is the rounding above it.
  [[nodiscard]] std::array<double, 3> on_surface(std::array<double, 3> point, double radius) const noexcept {
    constexpr double kMostFilled = 0.5; // of the radius, at a right angle
    const double surface = scene_.height(point[0], point[1]);
    if (radius > 0.0 && surface > point[2]) point[2] = std::min(surface, point[2] + kMostFilled * radius);
    return point;
  }

  void add_bend(std::size_t k, const ProfileBend& bend) {
    TrueCurve like;
    like.type = type_of(bend);
    like.optional = bend.radius > kLargestFillet;
    like.feature = static_cast<std::uint32_t>(k);
    like.radius_mm = bend.radius;
    like.wall_mm = bend.wall;
    add(
        like, scene_.features[k].footprint().level_curves(bend.d, kStep, looker_.window()),
        [&](const OutlinePoint& at) { return height_of_others(k, at) + bend.z; },
        [&](const OutlinePoint& at) {
          return turning(slope_of_others(scene_, k, at.x, at.y), bend.slope_inside, at.out, bend.slope_outside, at.out);
        });
  }

  void add_crests(std::size_t k) {
    const Profile& profile = scene_.features[k].profile();
    const auto slope = [&](const OutlinePoint& at) { return profile.slope(at.distance + 1e-6); };
    for (OutlineCurve& crest : scene_.features[k].footprint().crests(kStep, looker_.window())) {
      double steepest = 0.0;
      for (const OutlinePoint& at : crest.points) {
        if (std::fabs(slope(at)) > std::fabs(steepest)) steepest = slope(at);
      }
      if (steepest == 0.0) continue;
      TrueCurve like;
      like.type = steepest > 0.0 ? FeatureType::concave : FeatureType::convex;
      like.feature = static_cast<std::uint32_t>(k);
      add(
          like, {std::move(crest)},
          [&](const OutlinePoint& at) { return height_of_others(k, at) + profile.height(at.distance); },
          [&](const OutlinePoint& at) {
            const double m = slope(at);
            return turning(slope_of_others(scene_, k, at.x, at.y), m, at.out, m, at.other);
          });
    }
  }

  void add_rim(std::size_t k) {
    const Hole& hole = scene_.holes[k];
    TrueCurve like;
    like.type = FeatureType::step_top;
    like.feature = static_cast<std::uint32_t>(scene_.features.size() + k);
    like.wall_mm = hole.depth;
    constexpr double kRight = 90.0;
    add(
        like, hole.outline.level_curves(0.0, kStep, looker_.window()),
        [&](const OutlinePoint& at) { return scene_.height(at.x, at.y); }, [](const OutlinePoint&) { return kRight; });
  }

  const Scene& scene_;
  Looker looker_;
  std::vector<TrueCurve> curves_;
};

} // namespace

bool bends_enough(const ProfileBend& bend) noexcept {
  return bend.radius <= kLargestFillet &&
         kDegrees * std::fabs(std::atan(bend.slope_outside) - std::atan(bend.slope_inside)) >= kLeastTurning;
}

std::vector<TrueCurve> true_curves(const Scene& scene, const ScanGeometry& geometry) {
  return CurveMaker(scene, geometry).make();
}

} // namespace scansion
