// A disjoint-set forest whose lowest id is the patch.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch_graph.hpp"

#include <algorithm>

namespace scansion {

std::uint32_t PatchGraph::create(std::int64_t row) {
  const std::uint32_t id = next_++;
  Node& n = nodes_[id];
  n.parent = id;
  n.last_row = row;
  n.s_low = n.c_low = 1e300;
  n.s_high = n.c_high = -1e300;
  return id;
}

std::uint32_t PatchGraph::find(std::uint32_t id) {
  std::uint32_t root = id;
  while (true) {
    const auto it = nodes_.find(root);
    if (it == nodes_.end() || it->second.parent == root) break;
    root = it->second.parent;
  }
  while (id != root) {
    const auto it = nodes_.find(id);
    if (it == nodes_.end()) break;
    id = std::exchange(it->second.parent, root);
  }
  return root;
}

std::uint32_t PatchGraph::unite(std::uint32_t a, std::uint32_t b, std::vector<PatchMerge>& merges) {
  a = find(a);
  b = find(b);
  if (a == b) return a;
  const std::uint32_t into = std::min(a, b), from = std::max(a, b);
  Node& to = nodes_.at(into);
  Node& gone = nodes_.at(from);
  to.sums.add(gone.sums);
  for (const auto& [other, border] : gone.borders) {
    Border& mine = to.borders[other];
    for (std::size_t k = 0; k < 3; ++k) mine.length[k] += border.length[k];
    mine.backed += border.backed;
    mine.contact += border.contact;
    mine.height += border.height;
  }
  gone.borders.clear();
  to.open += gone.open;
  to.last_row = std::max(to.last_row, gone.last_row);
  to.width_rows += gone.width_rows;
  to.rows = std::max(to.rows, gone.rows);
  to.s_low = std::min(to.s_low, gone.s_low);
  to.s_high = std::max(to.s_high, gone.s_high);
  to.c_low = std::min(to.c_low, gone.c_low);
  to.c_high = std::max(to.c_high, gone.c_high);
  to.doubtful = to.doubtful || gone.doubtful;
  gone.parent = into;
  merges.push_back({from, into});
  return into;
}

std::map<std::uint32_t, Border> PatchGraph::borders_of(std::uint32_t id) {
  id = find(id);
  std::map<std::uint32_t, Border> out;
  for (const auto& [other, border] : nodes_.at(id).borders) {
    const std::uint32_t now = find(other);
    if (now == id) continue;
    Border& sum = out[now];
    for (std::size_t k = 0; k < 3; ++k) sum.length[k] += border.length[k];
    sum.backed += border.backed;
    sum.contact += border.contact;
    sum.height += border.height;
  }
  return out;
}

} // namespace scansion
