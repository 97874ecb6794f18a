// Brute-force reference of the ranking, written from the contract alone with numbers of unlimited size.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/lattice.hpp"
#include "tests/property/lines.hpp"

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>

namespace scansion::test {

using Big = boost::multiprecision::cpp_int;

/// An exact squared distance.
struct Fraction {
  Big numerator, denominator;
};
inline bool less(const Fraction& a, const Fraction& b) {
  return a.numerator * b.denominator < b.numerator * a.denominator;
}
inline bool equal(const Fraction& a, const Fraction& b) {
  return a.numerator * b.denominator == b.numerator * a.denominator;
}

inline Fraction squared_distance(const Coordinates& c, std::size_t p, std::size_t a, std::size_t b) {
  std::array<Big, 3> e, d, f;
  for (std::size_t k = 0; k < 3; ++k) {
    e[k] = Big(c[k][b]) - c[k][a];
    d[k] = Big(c[k][p]) - c[k][a];
    f[k] = Big(c[k][p]) - c[k][b];
  }
  const Big length = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
  const Big along = d[0] * e[0] + d[1] * e[1] + d[2] * e[2];
  const Big from_a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  if (along <= 0) return {from_a, 1};
  if (along >= length) return {f[0] * f[0] + f[1] * f[1] + f[2] * f[2], 1};
  // Pythagoras instead of the cross product: another way to the same number.
  return {from_a * length - along * along, length};
}

/// Nearest double, ties to even, by hand.
inline double nearest(const Big& value) {
  if (value == 0) return 0.0;
  const auto bits = static_cast<int>(msb(value)) + 1;
  if (bits <= 53) return value.convert_to<double>();
  const int cut = bits - 53;
  Big mantissa = value >> cut;
  const Big rest = value - (mantissa << cut);
  const Big half = Big(1) << (cut - 1);
  if (rest > half || (rest == half && mantissa % 2 == 1)) ++mantissa;
  return std::ldexp(mantissa.convert_to<double>(), cut);
}

inline double to_mm(const Fraction& d, Rational resolution) {
  return std::sqrt(nearest(d.numerator) / nearest(d.denominator)) * static_cast<double>(resolution.num) /
         static_cast<double>(resolution.den);
}

struct ReferenceRank {
  std::vector<double> distance;
  std::vector<std::uint32_t> depth;
};

inline ReferenceRank reference_rank(const Coordinates& c, Rational resolution) {
  const std::size_t n = c[0].size();
  ReferenceRank out{std::vector<double>(n, std::numeric_limits<double>::infinity()), std::vector<std::uint32_t>(n, 0)};
  struct Interval {
    std::size_t a, b;
    double parent;
    std::uint32_t depth;
  };
  std::vector<Interval> queue;
  if (n > 2) queue.push_back({0, n - 1, std::numeric_limits<double>::infinity(), 1});
  for (std::size_t q = 0; q < queue.size(); ++q) {
    const Interval i = queue[q];
    std::size_t best = 0;
    Fraction best_distance{-1, 1};
    const auto off = [&](std::size_t k) {
      return std::abs(2 * static_cast<std::int64_t>(k) - static_cast<std::int64_t>(i.a + i.b));
    };
    for (std::size_t k = i.a + 1; k < i.b; ++k) {
      const Fraction d = i.parent == 0.0 ? Fraction{0, 1} : squared_distance(c, k, i.a, i.b);
      if (less(best_distance, d) || (equal(best_distance, d) && off(k) < off(best))) {
        best = k;
        best_distance = d;
      }
    }
    const double d = std::min(i.parent, to_mm(best_distance, resolution));
    out.distance[best] = d;
    out.depth[best] = i.depth;
    if (best - i.a > 1) queue.push_back({i.a, best, d, i.depth + 1});
    if (i.b - best > 1) queue.push_back({best, i.b, d, i.depth + 1});
  }
  return out;
}

/// Textbook Douglas-Peucker: split while the distance is above `tolerance`.
inline std::vector<bool> textbook(const Coordinates& c, double tolerance, Rational resolution) {
  const std::size_t n = c[0].size();
  std::vector<bool> keep(n, false);
  if (n == 0) return keep;
  keep.front() = keep.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> stack{{0, n - 1}};
  while (!stack.empty()) {
    const auto [a, b] = stack.back();
    stack.pop_back();
    if (b - a < 2) continue;
    std::size_t best = a + 1;
    const auto off = [&, low = a, high = b](std::size_t k) {
      return std::abs(2 * static_cast<std::int64_t>(k) - static_cast<std::int64_t>(low + high));
    };
    for (std::size_t k = a + 2; k < b; ++k) {
      const Fraction d = squared_distance(c, k, a, b);
      const Fraction e = squared_distance(c, best, a, b);
      if (less(e, d) || (equal(e, d) && off(k) < off(best))) best = k;
    }
    if (!(to_mm(squared_distance(c, best, a, b), resolution) > tolerance)) continue;
    keep[best] = true;
    stack.emplace_back(a, best);
    stack.emplace_back(best, b);
  }
  return keep;
}

} // namespace scansion::test
