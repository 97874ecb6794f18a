// The scan plane from the scatter of points about the middle of their line.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/profile/frame.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

using Matrix3 = std::array<std::array<double, 3>, 3>;

struct Eigen {
  Vector3 values{};  // ascending
  Matrix3 vectors{}; // rows
};

// Jacobi rotations: exact enough in a handful of sweeps for a symmetric matrix of three rows.
Eigen eigen(Matrix3 a) {
  Matrix3 v{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (int sweep = 0; sweep < 32; ++sweep) {
    for (std::size_t p = 0; p < 2; ++p) {
      for (std::size_t q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0.0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
        const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
        const double c = 1.0 / std::sqrt(t * t + 1.0);
        const double s = t * c;
        for (std::size_t k = 0; k < 3; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const double vp = v[p][k], vq = v[q][k];
          v[p][k] = c * vp - s * vq;
          v[q][k] = s * vp + c * vq;
        }
      }
    }
  }
  std::array<std::size_t, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return a[i][i] < a[j][j]; });
  Eigen out;
  for (std::size_t i = 0; i < 3; ++i) {
    out.values[i] = a[order[i]][order[i]];
    out.vectors[i] = v[order[i]];
  }
  return out;
}

Vector3 scaled(const Vector3& v, double factor) {
  return {v[0] * factor, v[1] * factor, v[2] * factor};
}

} // namespace

void FrameFinder::add(const Counts& xyz, double resolution) {
  constexpr std::size_t kLooks = 256; // of a long line so many samples at least, of which a plane needs no more
  const std::size_t n = xyz[0].size(), stride = std::max<std::size_t>(1, n / kLooks);
  if (n == 0) return;
  Vector3 middle{};
  const std::size_t looks = (n - 1) / stride + 1;
  const double share = 1.0 / static_cast<double>(looks);
  const auto at = [&](std::size_t axis, std::size_t k) { return xyz[axis][k] * resolution; };
  for (std::size_t k = 0; k < n; k += stride)
    for (std::size_t i = 0; i < 3; ++i) middle[i] += at(i, k) * share;
  auto sums = scatter_; // one half; the other is the same
  for (std::size_t k = 0; k < n; k += stride) {
    const Vector3 d{at(0, k) - middle[0], at(1, k) - middle[1], at(2, k) - middle[2]};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = i; j < 3; ++j) sums[i][j] += d[i] * d[j] * share;
  }
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) scatter_[i][j] = sums[std::min(i, j)][std::max(i, j)];
  if (lines_ == 0) first_middle_ = middle;
  last_middle_ = middle;
  ++lines_;
}

Frame FrameFinder::frame() const {
  const Eigen e = eigen(scatter_);
  // Below this share of its length a line is straight, and its plane unknown.
  constexpr double kStraight = 1e-12;
  constexpr double kSteepest = 0.9; // of the normal's z: a plane that lies down has no height in it
  Vector3 normal = e.vectors[0];
  if (e.values[1] <= kStraight * e.values[2] || std::abs(normal[2]) > kSteepest) {
    const Vector3& direction = e.vectors[2];
    normal = {-direction[1], direction[0], 0.0};
  }
  const double flat = std::hypot(normal[0], normal[1]);
  Frame frame;
  if (flat < 1e-9) return frame;
  // Of a straight axis, sums leave a rounding error; without it such an axis need not be looked at on any line.
  constexpr double kRounding = 1e-12;
  for (double& part : normal)
    if (std::abs(part) < kRounding * flat) part = 0.0;
  normal = scaled(normal, 1.0 / std::sqrt(dot(normal, normal)));
  const Vector3 onward{last_middle_[0] - first_middle_[0], last_middle_[1] - first_middle_[1],
                       last_middle_[2] - first_middle_[2]};
  if (dot(normal, onward) < 0.0) normal = scaled(normal, -1.0);
  const double plan = std::hypot(normal[0], normal[1]);
  frame.normal = normal;
  frame.along = {normal[1] / plan, -normal[0] / plan, 0.0};
  // normal x along, which points up or down with the sign of normal's plan part: up by construction.
  frame.up = {normal[1] * frame.along[2] - normal[2] * frame.along[1], normal[2] * frame.along[0] - normal[0] * frame.along[2],
              normal[0] * frame.along[1] - normal[1] * frame.along[0]};
  if (frame.up[2] < 0.0) frame.up = scaled(frame.up, -1.0);
  return frame;
}

} // namespace scansion
