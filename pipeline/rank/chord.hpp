// Distances of the points of a run to one chord: planar and spatial kernels with equal results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/exact.hpp"
#include "pipeline/rank/rank.hpp"

#include <array>

namespace scansion {

/// Two coordinates of a run whose third one is constant.
struct Planar {
  const std::int32_t* u;
  const std::int32_t* v;

  struct Chord {
    std::int64_t au, av, bu, bv, eu, ev;
    std::uint64_t length; ///< squared, counts
  };
  using Cross = std::uint64_t; ///< |cross product|: orders points inside the ends of one chord

  [[nodiscard]] Chord chord(std::size_t a, std::size_t b) const noexcept {
    const std::int64_t eu = std::int64_t{u[b]} - u[a];
    const std::int64_t ev = std::int64_t{v[b]} - v[a];
    return {u[a], v[a], u[b], v[b], eu, ev, static_cast<std::uint64_t>(eu * eu + ev * ev)};
  }
  /// True inside the ends, with `cross`; false beyond them, with `beyond`, the squared distance to the nearer end.
  [[nodiscard]] bool measure(const Chord& c, std::size_t k, Cross& cross, std::uint64_t& beyond) const noexcept {
    const std::int64_t du = u[k] - c.au;
    const std::int64_t dv = v[k] - c.av;
    const std::int64_t dot = du * c.eu + dv * c.ev;
    if (dot > 0 && static_cast<std::uint64_t>(dot) < c.length) {
      const std::int64_t signed_cross = c.eu * dv - c.ev * du;
      cross = static_cast<std::uint64_t>(signed_cross < 0 ? -signed_cross : signed_cross);
      return true;
    }
    const std::int64_t fu = dot > 0 ? u[k] - c.bu : du;
    const std::int64_t fv = dot > 0 ? v[k] - c.bv : dv;
    beyond = static_cast<std::uint64_t>(fu * fu + fv * fv);
    return false;
  }
  [[nodiscard]] static exact::U128 squared(Cross cross) noexcept { return static_cast<exact::U128>(cross) * cross; }
};

/// Three coordinates.
struct Spatial {
  const std::int32_t* x;
  const std::int32_t* y;
  const std::int32_t* z;

  struct Chord {
    std::array<std::int64_t, 3> a, b, e;
    std::uint64_t length;
  };
  using Cross = exact::U128; ///< squared length of the cross product

  [[nodiscard]] std::array<std::int64_t, 3> at(std::size_t k) const noexcept { return {x[k], y[k], z[k]}; }
  [[nodiscard]] static std::array<std::int64_t, 3> minus(const std::array<std::int64_t, 3>& p,
                                                         const std::array<std::int64_t, 3>& q) noexcept {
    return {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
  }
  [[nodiscard]] static std::int64_t dot(const std::array<std::int64_t, 3>& p, const std::array<std::int64_t, 3>& q) noexcept {
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
  }
  [[nodiscard]] Chord chord(std::size_t a, std::size_t b) const noexcept {
    const auto e = minus(at(b), at(a));
    return {at(a), at(b), e, static_cast<std::uint64_t>(dot(e, e))};
  }
  [[nodiscard]] bool measure(const Chord& c, std::size_t k, Cross& cross, std::uint64_t& beyond) const noexcept {
    const auto d = minus(at(k), c.a);
    const std::int64_t along = dot(d, c.e);
    if (along > 0 && static_cast<std::uint64_t>(along) < c.length) {
      cross = square(c.e[1] * d[2] - c.e[2] * d[1]) + square(c.e[2] * d[0] - c.e[0] * d[2]) +
              square(c.e[0] * d[1] - c.e[1] * d[0]);
      return true;
    }
    const auto f = along > 0 ? minus(at(k), c.b) : d;
    beyond = static_cast<std::uint64_t>(dot(f, f));
    return false;
  }
  [[nodiscard]] static exact::U128 squared(Cross cross) noexcept { return cross; }

private:
  [[nodiscard]] static exact::U128 square(std::int64_t v) noexcept {
    const auto u = static_cast<exact::U128>(v < 0 ? -v : v);
    return u * u;
  }
};

/// Calls `visit` with the kernel that suits the run: planar when a coordinate is constant.
template <class Visit>
auto with_kernel(const RunPoints& run, Visit&& visit) {
  const auto constant = [](std::span<const std::int32_t> axis) {
    for (const std::int32_t value : axis)
      if (value != axis.front()) return false;
    return true;
  };
  if (constant(run.y)) return visit(Planar{run.x.data(), run.z.data()});
  if (constant(run.x)) return visit(Planar{run.y.data(), run.z.data()});
  if (constant(run.z)) return visit(Planar{run.x.data(), run.y.data()});
  return visit(Spatial{run.x.data(), run.y.data(), run.z.data()});
}

} // namespace scansion
