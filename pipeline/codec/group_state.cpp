// Shared state of encoder and decoder.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/group_state.hpp"

#include <algorithm>
#include <iterator>

namespace scansion {

void GroupState::merge_fresh() {
  merged_.clear();
  merged_.reserve(known.size() + fresh.size());
  std::ranges::merge(known, fresh, std::back_inserter(merged_));
  known.swap(merged_);
  fresh.clear();
}

void fill_chord(std::span<const PointIndex> vertices, std::span<const std::int32_t> u, std::span<std::int32_t> chord) noexcept {
  if (vertices.empty()) return;
  chord[vertices.front()] = u[vertices.front()];
  for (std::size_t v = 1; v < vertices.size(); ++v) {
    const PointIndex a = vertices[v - 1];
    const PointIndex b = vertices[v];
    const std::int64_t length = b - a;
    const std::int64_t rise = std::int64_t{u[b]} - u[a];
    std::int64_t step = rise / length;
    std::int64_t part = rise % length;
    if (part < 0) {
      part += length;
      --step;
    }
    // The same floor as between(), one addition a point.
    std::int64_t value = u[a];
    std::int64_t sum = 0;
    for (PointIndex i = a + 1; i < b; ++i) {
      value += step;
      sum += part;
      if (sum >= length) {
        sum -= length;
        ++value;
      }
      chord[i] = static_cast<std::int32_t>(value);
    }
    chord[b] = u[b];
  }
}

} // namespace scansion
