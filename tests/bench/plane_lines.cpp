// Lines in space to lines in the plane.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/plane_lines.hpp"

#include <algorithm>
#include <array>

namespace scansion::bench {

PlaneLines plane_lines(const std::vector<RunView>& runs, Rational resolution_mm) {
  const double mm = resolution_mm.value();
  PlaneLines lines;
  for (const RunView& run : runs) {
    const std::array axes{run.x, run.y, run.z};
    std::array<std::int64_t, 3> span{};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto [low, high] = std::ranges::minmax(axes[a]);
      span[a] = std::int64_t{high} - low;
    }
    const auto narrowest = static_cast<std::size_t>(std::ranges::min_element(span) - span.begin());
    const auto& u = axes[narrowest == 0 ? 1 : 0];
    const auto& v = axes[narrowest == 2 ? 1 : 2];
    auto& line = lines.emplace_back();
    line.reserve(run.size());
    for (std::size_t k = 0; k < run.size(); ++k) line.push_back({u[k] * mm, v[k] * mm});
  }
  return lines;
}

} // namespace scansion::bench
