// Attributes of feature lines.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/line/publisher.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

constexpr double kTolerance = 0.1; // coarse steps: how far a line may pass from its points; they are found to about 0.3

double length_of(const std::vector<FeatureVertex>& vertices) noexcept {
  double length = 0.0;
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    const auto &a = vertices[i - 1].position, &b = vertices[i].position;
    length += std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
  }
  return length;
}

class Spread {
public:
  void add(double value) noexcept {
    ++count_;
    const double off = value - mean_;
    mean_ += off / static_cast<double>(count_);
    squares_ += off * (value - mean_);
  }
  [[nodiscard]] MeanDeviation value() const noexcept {
    return {mean_, count_ > 1 ? std::sqrt(squares_ / static_cast<double>(count_ - 1)) : 0.0};
  }

private:
  std::size_t count_ = 0;
  double mean_ = 0.0, squares_ = 0.0;
};

FeatureType common_type(const Curve& curve) {
  std::array<std::size_t, kFeatureTypes> votes{};
  for (const CurvePoint& p : curve.points) ++votes[static_cast<std::size_t>(p.feature.type)];
  return static_cast<FeatureType>(std::max_element(votes.begin(), votes.end()) - votes.begin());
}

} // namespace

Vector3 Publisher::position(const Frame& frame, double s, double w, double c) const {
  Vector3 p = frame.position(s, w, c);
  for (std::size_t i = 0; i < 3; ++i) p[i] += origin_[i];
  return p;
}

FeatureLine Publisher::publish(const HoleOutline& hole, std::uint64_t id, const Frame& frame, const Sampling& sampling) {
  FeatureLine line;
  line.id = id;
  line.type = FeatureType::step_top;
  line.closed_loop = true;
  line.begins = line.ends = FeatureEnd::cap;
  rows_.clear();
  for (const RimPoint& p : hole.points) {
    FeatureVertex& v = line.vertices.emplace_back();
    v.position = position(frame, p.s, p.w, p.c);
    v.line = p.line;
    v.index = p.sample;
    rows_.push_back(p.line);
  }
  line.elements[static_cast<std::size_t>(ShapeElement::step_top)] = static_cast<std::uint32_t>(hole.points.size());
  std::sort(rows_.begin(), rows_.end());
  line.scan_lines = static_cast<std::uint64_t>(std::unique(rows_.begin(), rows_.end()) - rows_.begin());
  line.per_mm = thinner_.thin(line.vertices, kTolerance * sampling.coarse());
  line.length_mm = length_of(line.vertices);
  line.persistence = line.length_mm / (5.0 * sampling.coarse());
  line.across_mm = 0.5 * sampling.spacing;
  return line;
}

FeatureLine Publisher::publish(const Curve& curve, const Frame& frame, const Sampling& sampling, const AlphaSet& alpha) {
  FeatureLine line;
  line.id = curve.id;
  line.piece = curve.piece;
  line.begins_at = curve.begins_at;
  line.ends_at = curve.ends_at;
  line.type = common_type(curve);
  line.closed_loop = curve.loop;
  line.begins = curve.front.why;
  line.ends = curve.back.why;
  line.partner = curve.partner;
  line.junctions = curve.junctions;
  line.met_by = curve.met_by;
  Spread delta, beta, tau, width;
  double sharpness = 0.0;
  std::size_t guided = 0;
  rows_.clear();
  widths_.clear();
  line.vertices.reserve(curve.points.size());
  // The point at a seam is told of in the piece that went out before.
  const std::size_t first = curve.front.seam ? 1 : 0, last = curve.points.size() - (curve.back.seam ? 1 : 0);
  for (std::size_t k = 0; k < curve.points.size(); ++k) {
    const CurvePoint& p = curve.points[k];
    FeatureVertex v;
    v.position = position(frame, p.s, p.w, p.c);
    v.line = p.feature.line;
    v.index = p.feature.sample;
    line.vertices.push_back(v);
    if (k < first || k >= last) continue;
    delta.add(p.feature.inner_angle());
    beta.add(p.feature.orientation());
    tau.add(p.feature.tau);
    width.add(p.feature.width);
    widths_.push_back(p.feature.width);
    sharpness += p.feature.sharpness;
    guided += p.feature.guided ? 1 : 0;
    rows_.push_back(p.feature.line);
    ++line.elements[static_cast<std::size_t>(p.feature.element)];
  }
  const auto n = static_cast<double>(rows_.size());
  std::sort(rows_.begin(), rows_.end());
  line.scan_lines = static_cast<std::uint64_t>(std::unique(rows_.begin(), rows_.end()) - rows_.begin());
  const auto middle = widths_.begin() + static_cast<std::ptrdiff_t>(widths_.size() / 2);
  std::nth_element(widths_.begin(), middle, widths_.end());
  line.level = alpha.width(least_distance(sampling.noise) * std::exp2(*middle));
  line.per_mm = thinner_.thin(line.vertices, kTolerance * sampling.coarse());
  line.length_mm = length_of(line.vertices);
  line.inner_angle = delta.value();
  line.orientation = beta.value();
  line.turning = tau.value();
  line.width = width.value();
  line.sharpness = sharpness / n;
  line.guided_share = static_cast<double>(guided) / n;
  line.persistence = line.length_mm / (5.0 * sampling.coarse());
  const bool step =
      std::any_of(curve.points.begin(), curve.points.end(), [](const CurvePoint& p) { return p.feature.step && p.row < 0; });
  if (step) line.across_mm = 0.5 * sampling.spacing;
  return line;
}

} // namespace scansion
