// Other programs' Douglas-Peucker, each answering one tolerance. They are plane: they get the two axes on which a line spans
// most.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/bench/plane_lines.hpp"

#include <memory>

namespace scansion::bench {

/// A set of polylines in a peer's own form; made before the clock runs.
class Simplifier {
public:
  virtual ~Simplifier() = default;
  /// Simplifies all lines; the number of points kept.
  [[nodiscard]] virtual std::size_t run(double tolerance_mm) = 0;
};

/// Empty when the peer was not there at build time.
[[nodiscard]] std::unique_ptr<Simplifier> boost_simplifier(const PlaneLines& lines);
[[nodiscard]] std::unique_ptr<Simplifier> geos_simplifier(const PlaneLines& lines);
inline constexpr const char* kBoostPackage = "libboost-dev";
inline constexpr const char* kGeosPackage = "libgeos-dev";

} // namespace scansion::bench
