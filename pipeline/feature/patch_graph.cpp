// Uniting and forgetting patches without leaving an old id behind.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch_graph.hpp"

#include <algorithm>

namespace scansion {

namespace {

void add_past(std::vector<std::uint32_t>& past, std::uint32_t id) {
  if (past.size() < PatchNode::kMostPast) past.push_back(id);
}

} // namespace

void Border::add(const Border& other) noexcept {
  for (std::size_t k = 0; k < length.size(); ++k) length[k] += other.length[k];
  for (std::size_t k = 0; k < rim.size(); ++k) rim[k] += other.rim[k];
  backed += other.backed;
  contact += other.contact;
  height += other.height;
  gap = std::min(gap, other.gap);
}

std::uint32_t PatchGraph::create(std::int64_t row) {
  const std::uint32_t id = next_++;
  nodes_[id].last_row = row;
  return id;
}

std::uint32_t PatchGraph::find(std::uint32_t id) const {
  for (auto next = aliases_.find(id); next != aliases_.end(); next = aliases_.find(id)) id = next->second;
  return id;
}

std::uint32_t PatchGraph::unite(std::uint32_t a, std::uint32_t b, std::vector<PatchMerge>& merges) {
  if (a == b) return a;
  const std::uint32_t into = std::min(a, b), from = std::max(a, b);
  const auto at = nodes_.find(from);
  PatchNode& to = nodes_.at(into);
  PatchNode& gone = at->second;
  to.borders.erase(from);
  for (const auto& [other, border] : gone.borders) {
    if (other == from || other == into) {
      if (border.total() > 0.0) to.borders[into].add(border);
      continue;
    }
    to.borders[other].add(border);
    PatchNode& neighbour = nodes_.at(other);
    neighbour.borders[into].add(neighbour.borders.at(from));
    neighbour.borders.erase(from);
  }
  to.sums.add(gone.sums);
  to.open += gone.open;
  to.last_row = std::max(to.last_row, gone.last_row);
  to.s_low = std::min(to.s_low, gone.s_low);
  to.s_high = std::max(to.s_high, gone.s_high);
  to.c_low = std::min(to.c_low, gone.c_low);
  to.c_high = std::max(to.c_high, gone.c_high);
  to.doubtful = to.doubtful || gone.doubtful;
  to.closed = to.closed && gone.closed;
  to.past_inside.add(gone.past_inside);
  to.past_outside.add(gone.past_outside);
  for (const std::uint32_t id : gone.past) add_past(to.past, id);
  nodes_.erase(at);
  aliases_[from] = into;
  merges.push_back({from, into});
  return into;
}

void PatchGraph::forget(std::uint32_t id) {
  const auto at = nodes_.find(id);
  for (const auto& [other, border] : at->second.borders) {
    if (other == id) continue;
    PatchNode& neighbour = nodes_.at(other);
    const auto mine = neighbour.borders.find(id);
    if (mine->second.total() > 0.0) {
      (neighbour.encloses(at->second) ? neighbour.past_inside : neighbour.past_outside).add(mine->second);
      add_past(neighbour.past, id);
    }
    neighbour.borders.erase(mine);
  }
  nodes_.erase(at);
}

} // namespace scansion
