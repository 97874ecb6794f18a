// Parts made of a number: forms of random kind, size and place, none of which touches another one, or smooth surfaces without
// any. For judging feature lines on parts that nobody looked at while the rules were made.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/portable_math.hpp"
#include "sim/scene/random.hpp"
#include "sim/scene/scenes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace scansion {
namespace {

constexpr std::uint64_t kPartStream = 0x70617274; // apart from the streams of noise and faults

/// A disc in plan.
struct Cover {
  double x = 0.0, y = 0.0, radius = 0.0;
};

/// A form that is looking for its place: `covers` hold all of its footprint.
struct Candidate {
  Feature feature;
  std::vector<Cover> covers;
};

class PartMaker {
public:
  explicit PartMaker(std::uint64_t part) : random_(part, 0, kPartStream) {}

  Scene make(std::string name) {
    constexpr int kTries = 400;
    scene_.name = std::move(name);
    scene_.summary = "part of forms of random kind, size and place";
    scene_.length_x = between(34.0, 48.0);
    scene_.length_y = between(30.0, 40.0);
    scene_.points = static_cast<std::uint32_t>(round_half_up(scene_.length_x * 10.0));
    scene_.lines = static_cast<std::uint32_t>(round_half_up(scene_.length_y * 10.0));
    make_base();
    const std::size_t wanted = 5 + random_.below(6);
    for (int k = 0; k < kTries && scene_.features.size() < wanted; ++k) place(k < 2 ? endless() : bounded());
    return std::move(scene_);
  }

  /// 1,200 mm2 of bumps and waves; the radius of curvature of each is 12 mm and more.
  Scene make_smooth(std::string name) {
    constexpr double kCurvature = 1.0 / 12.0, kTurn = 6.283185307179586;
    scene_.name = std::move(name);
    scene_.summary = "smooth surface of random bumps and waves, 1,200 mm^2";
    scene_.length_x = 40.0;
    scene_.length_y = 30.0;
    scene_.points = 400;
    scene_.lines = 300;
    scene_.base.slope_x = between(-0.1, 0.1);
    scene_.base.slope_y = between(-0.1, 0.1);
    const std::uint32_t bumps = 2 + random_.below(3);
    for (std::uint32_t k = 0; k < bumps; ++k) {
      const double short_radius = between(6.0, 14.0), long_radius = short_radius * between(1.0, 2.0);
      // In the middle it bends by six times its height over the square of the radius.
      const double height = either_way(between(0.3, 1.0) * kCurvature * short_radius * short_radius / 6.0);
      scene_.base.add(Bump{between(2.0, 38.0), between(2.0, 28.0), long_radius, short_radius, between(0.0, 180.0), height});
      bound(height);
    }
    const std::uint32_t waves = random_.below(3);
    for (std::uint32_t k = 0; k < waves; ++k) {
      const double length = between(12.0, 40.0), height = between(0.2, 0.6) * kCurvature * (length / kTurn) * (length / kTurn);
      scene_.base.add(Wave{between(0.0, length), 0.0, between(0.0, 180.0), length, height});
      bound(height);
      bound(-height);
    }
    return std::move(scene_);
  }

private:
  double between(double low, double high) { return low + (high - low) * random_.uniform(); }
  bool chance(double share) { return random_.uniform() < share; }
  double either_way(double size) { return chance(0.5) ? size : -size; }

  void bound(double height) {
    scene_.relief_low += std::min(0.0, height);
    scene_.relief_high += std::max(0.0, height);
  }

  void make_base() {
    if (chance(0.5)) {
      scene_.base.slope_x = between(-0.1, 0.1);
      scene_.base.slope_y = between(-0.1, 0.1);
    }
    if (chance(0.4)) {
      const double height = between(1.5, 5.0);
      scene_.base.add(Bump{0.5 * scene_.length_x, 0.5 * scene_.length_y, between(26.0, 34.0), between(24.0, 32.0),
                           between(0.0, 180.0), height});
      bound(height);
    }
    if (chance(0.4)) {
      const double height = between(0.1, 0.35);
      scene_.base.add(Wave{0.0, 0.0, between(0.0, 180.0), between(30.0, 60.0), height});
      bound(height);
      bound(-height);
    }
  }

  /// A wall whose roundings leave it at least a third of its height; `half`: the footprint's half width.
  Profile wall(double height, double half) {
    const double room = std::min(std::fabs(height), half);
    const double draft = chance(0.6) ? between(0.0, 0.3) * room : 0.0;
    const double outer = chance(0.3) ? between(0.1, 0.35) * room : 0.0;
    const double inner = chance(0.3) ? between(0.1, 0.35) * room : 0.0;
    return Profile::wall(height, draft, outer, inner);
  }

  static Profile vee(double depth, double half) { return Profile{{-half, -depth}, {0.0, 0.0}}; }

  /// A step, a ramp, a groove or a rib from border to border.
  Candidate endless() {
    const bool along = chance(0.5);
    const double degrees = (along ? 0.0 : 90.0) + between(-20.0, 20.0);
    const double side = chance(0.5) ? between(0.1, 0.25) : between(0.75, 0.9);
    const double x = along ? 0.5 * scene_.length_x : side * scene_.length_x;
    const double y = along ? side * scene_.length_y : 0.5 * scene_.length_y;
    const SinCos turn = portable_sincos_degrees(degrees);
    const double half = between(1.0, 2.2);
    const double height = either_way(between(0.3, 2.5));
    Candidate candidate = [&]() -> Candidate {
      switch (random_.below(4)) {
        case 0: return {Feature(Footprint::half_plane(x, y, degrees), wall(height, 3.0)), {}};
        case 1: {
          const double run = std::fabs(height) * between(0.6, 3.0);
          return {Feature(Footprint::half_plane(x, y, degrees), Profile{{-run - 1.0, height}, {-run, height}, {0.0, 0.0}}), {}};
        }
        case 2: return {Feature(Footprint::strip(x, y, degrees, half), wall(height, half)), {}};
        default: return {Feature(Footprint::strip(x, y, degrees, half), vee(either_way(half * between(0.35, 1.2)), half)), {}};
      }
    }();
    const double reach = scene_.length_x + scene_.length_y;
    for (int k = 0; k * half <= 2.0 * reach; ++k) {
      const double t = k * half - reach;
      candidate.covers.push_back({x + t * turn.cos, y + t * turn.sin, 1.5 * half});
    }
    return candidate;
  }

  Candidate bounded() {
    const double x = between(4.0, scene_.length_x - 4.0), y = between(4.0, scene_.length_y - 4.0);
    if (chance(0.4)) {
      const double radius = between(1.8, 6.0);
      return {Feature(Footprint::disc(x, y, radius), round_form(radius)), {{x, y, radius}}};
    }
    const bool slender = chance(0.5);
    const double width = slender ? between(2.0, 3.6) : between(4.0, 11.0);
    const double length = slender ? width * between(4.0, 6.0) : width * between(1.0, 1.8);
    const double corner = chance(0.4) ? 0.0 : 0.5 * width * (chance(0.4) ? 1.0 : between(0.2, 0.8));
    const double degrees = chance(0.3) ? 90.0 * random_.below(2) : between(0.0, 180.0);
    Candidate candidate{Feature(Footprint::round_box(x, y, length, width, corner, degrees), box_form(0.5 * width, slender)),
                        {}};
    const SinCos turn = portable_sincos_degrees(degrees);
    constexpr double kCorner = 0.7071067811865476; // a square's half diagonal, of its side
    const double reach = 0.5 * (length - width);
    const int steps = static_cast<int>(2.0 * reach / (0.5 * width)) + 1;
    for (int k = 0; k <= steps; ++k) {
      const double t = reach * (2.0 * k / steps - 1.0);
      candidate.covers.push_back({x + t * turn.cos, y + t * turn.sin, width * kCorner});
    }
    return candidate;
  }

  Profile round_form(double radius) {
    const double height = either_way(between(0.4, 3.5));
    switch (random_.below(4)) {
      case 0: { // a cone's frustum, standing or sunk in
        const double top = radius * between(0.3, 0.6);
        return Profile{{-radius, height}, {-top, height}, {0.0, 0.0}};
      }
      case 1: { // a groove or ridge along the circle
        const double half = std::min(0.4 * radius, between(0.8, 1.5));
        return Profile{{-half, 0.0}, {0.0, either_way(half * between(0.4, 1.0))}, {half, 0.0}};
      }
      default: return wall(height, radius);
    }
  }

  Profile box_form(double half, bool slender) {
    const double height = either_way(between(0.4, slender ? 2.0 : 3.5));
    switch (random_.below(4)) {
      case 0:
        if (slender) return vee(either_way(half * between(0.4, 1.1)), half);
        return wall(height, half);
      case 1: { // a chamfer around the top, where there is room for one
        const double leg = between(0.5, 0.9), low = height > 0.0 ? height - leg : -leg;
        if (leg > 0.5 * std::min(std::fabs(height), half)) return wall(height, half);
        if (height > 0.0) return Profile{{-half, height}, {-leg, height}, {0.0, low}, {0.0, 0.0}};
        return Profile{{-half, height}, {-leg, height}, {-leg, low}, {0.0, 0.0}};
      }
      default: return wall(height, half);
    }
  }

  /// Whether a disc lies wholly outside a feature, or on the even ground in its middle, with room for windows in between.
  static bool clear(const Feature& feature, const Cover& cover) {
    constexpr double kRoom = 1.2; // mm
    const double d = feature.footprint().distance(cover.x, cover.y);
    const auto& bends = feature.profile().bends();
    const double inmost = bends.empty() ? 0.0 : bends.front().d - bends.front().radius;
    return d > cover.radius + feature.profile().reach() + kRoom || d < inmost - cover.radius - kRoom;
  }

  void place(Candidate candidate) {
    const double reach = candidate.feature.profile().reach();
    for (Cover& cover : candidate.covers) {
      cover.radius += reach;
      for (const Feature& feature : scene_.features)
        if (!clear(feature, cover)) return;
    }
    const bool bounded = candidate.feature.footprint().kind() == Footprint::Kind::round_box;
    for (const Cover& cover : candidate.covers) {
      const double x = std::min(cover.x, scene_.length_x - cover.x), y = std::min(cover.y, scene_.length_y - cover.y);
      if (bounded && std::min(x, y) < cover.radius + 1.0) return;
    }
    double low = 0.0, high = 0.0;
    for (const ProfileBend& bend : candidate.feature.profile().bends()) {
      low = std::min(low, bend.z);
      high = std::max(high, bend.z);
    }
    bound(low);
    bound(high);
    scene_.features.push_back(std::move(candidate.feature));
  }

  Random random_;
  Scene scene_;
};

} // namespace

Scene make_random(std::uint64_t part) {
  return PartMaker(part).make("random:" + std::to_string(part));
}

Scene make_random_smooth(std::uint64_t part) {
  return PartMaker(part).make_smooth("smooth:" + std::to_string(part));
}

} // namespace scansion
