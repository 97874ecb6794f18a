// Distances of the points of a run to one chord: planar and spatial kernels with equal results.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/rank/exact.hpp"
#include "pipeline/rank/rank.hpp"
#include "pipeline/rank/vector_job.hpp"

#include <array>

namespace scansion {

// Every kernel has: Cross, which orders the points inside the ends of one chord; Beyond, the squared distance to an end; Number
// and Length, numerator and denominator of a squared distance; chord(a, b); measure(chord, k, cross, beyond), true inside the
// ends.

/// Two coordinates of a run whose third one is constant; spans below kNarrowSpan: cross < 2^61, squared distances < 2^61.
struct Planar {
  const std::int32_t* u;
  const std::int32_t* v;

  struct Chord {
    std::int64_t au, av, bu, bv, eu, ev;
    std::uint64_t length; ///< squared, counts
  };
  using Cross = std::uint64_t; ///< |cross product|
  using Beyond = std::uint64_t;
  using Number = exact::U128;
  using Length = std::uint64_t;

  [[nodiscard]] Chord chord(std::size_t a, std::size_t b) const noexcept {
    const std::int64_t eu = std::int64_t{u[b]} - u[a];
    const std::int64_t ev = std::int64_t{v[b]} - v[a];
    return {u[a], v[a], u[b], v[b], eu, ev, static_cast<std::uint64_t>(eu * eu + ev * ev)};
  }
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

/// Three coordinates; spans below kNarrowSpan: the squared cross product is below 2^124.
struct Spatial {
  const std::int32_t* x;
  const std::int32_t* y;
  const std::int32_t* z;

  struct Chord {
    std::array<std::int64_t, 3> a, b, e;
    std::uint64_t length;
  };
  using Cross = exact::U128; ///< squared length of the cross product
  using Beyond = std::uint64_t;
  using Number = exact::U128;
  using Length = std::uint64_t;

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
      cross =
          square(c.e[1] * d[2] - c.e[2] * d[1]) + square(c.e[2] * d[0] - c.e[0] * d[2]) + square(c.e[0] * d[1] - c.e[1] * d[0]);
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

/// Three coordinates of any 32 bit span. Slow and rare: text with more decimals than a scanner resolves.
struct Wide {
  const std::int32_t* x;
  const std::int32_t* y;
  const std::int32_t* z;

  using Vector = std::array<exact::I128, 3>;
  struct Chord {
    Vector a, b, e;
    exact::U128 length;
  };
  using Cross = exact::U256;
  using Beyond = exact::U128;
  using Number = exact::U256;
  using Length = exact::U128;

  [[nodiscard]] Vector at(std::size_t k) const noexcept { return {x[k], y[k], z[k]}; }
  [[nodiscard]] static Vector minus(const Vector& p, const Vector& q) noexcept {
    return {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
  }
  [[nodiscard]] static exact::I128 dot(const Vector& p, const Vector& q) noexcept {
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
  }
  [[nodiscard]] Chord chord(std::size_t a, std::size_t b) const noexcept {
    const Vector e = minus(at(b), at(a));
    return {at(a), at(b), e, static_cast<exact::U128>(dot(e, e))};
  }
  [[nodiscard]] bool measure(const Chord& c, std::size_t k, Cross& cross, Beyond& beyond) const {
    const Vector d = minus(at(k), c.a);
    const exact::I128 along = dot(d, c.e);
    if (along > 0 && static_cast<exact::U128>(along) < c.length) {
      cross =
          square(c.e[1] * d[2] - c.e[2] * d[1]) + square(c.e[2] * d[0] - c.e[0] * d[2]) + square(c.e[0] * d[1] - c.e[1] * d[0]);
      return true;
    }
    const Vector f = along > 0 ? minus(at(k), c.b) : d;
    beyond = static_cast<exact::U128>(dot(f, f));
    return false;
  }
  [[nodiscard]] static Number squared(const Cross& cross) { return cross; }

private:
  [[nodiscard]] static exact::U256 square(exact::I128 v) {
    const exact::U256 u(static_cast<exact::U128>(v < 0 ? -v : v));
    return u * u;
  }
};

/// Calls `visit` with the kernel that suits the run: planar when a coordinate is constant, wide when a span calls for it.
template <class Visit>
auto with_kernel(const RunPoints& run, Visit&& visit) {
  const auto span_of = [](std::span<const std::int32_t> axis) {
    std::int32_t low = axis.front();
    std::int32_t high = low;
    for (const std::int32_t value : axis) {
      low = value < low ? value : low;
      high = value > high ? value : high;
    }
    return std::int64_t{high} - low;
  };
  const std::int64_t x = span_of(run.x);
  const std::int64_t y = span_of(run.y);
  const std::int64_t z = span_of(run.z);
  if (x >= kNarrowSpan || y >= kNarrowSpan || z >= kNarrowSpan) return visit(Wide{run.x.data(), run.y.data(), run.z.data()});
  if (y == 0) return visit(Planar{run.x.data(), run.z.data()});
  if (x == 0) return visit(Planar{run.y.data(), run.z.data()});
  if (z == 0) return visit(Planar{run.x.data(), run.y.data()});
  return visit(Spatial{run.x.data(), run.y.data(), run.z.data()});
}

} // namespace scansion
