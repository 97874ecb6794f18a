// Uniting and forgetting patches without leaving an old id behind.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch/patch_graph.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

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

void PatchNode::restart() {
  Borders room = std::move(borders);
  std::destroy_at(this);
  std::construct_at(this);
  room.clear();
  borders = std::move(room);
}

std::uint32_t PatchGraph::create(std::int64_t row) {
  const std::uint32_t id = next_++;
  if (spare_.empty()) {
    nodes_[id].last_row = row;
    return id;
  }
  Nodes::node_type node = std::move(spare_.back());
  spare_.pop_back();
  node.key() = id;
  node.mapped().restart();
  node.mapped().last_row = row;
  nodes_.insert(std::move(node));
  return id;
}

void PatchGraph::remove(Nodes::iterator at) {
  spare_.push_back(nodes_.extract(at));
}

std::uint32_t PatchGraph::find(std::uint32_t id) const {
  for (auto next = aliases_.find(id); next != aliases_.end(); next = aliases_.find(id)) id = next->second;
  return id;
}

void PatchGraph::resolve(std::int64_t row) {
  for (const auto& [from, into] : aliases_) {
    if (spare_aliases_.empty()) {
      past_aliases_[from] = {into, row};
      continue;
    }
    Aliases::node_type alias = std::move(spare_aliases_.back());
    spare_aliases_.pop_back();
    alias.key() = from;
    alias.mapped() = {into, row};
    past_aliases_.insert(std::move(alias));
  }
  aliases_.clear();
}

std::uint32_t PatchGraph::find_past(std::uint32_t id) const {
  for (auto next = past_aliases_.find(id); next != past_aliases_.end(); next = past_aliases_.find(id)) id = next->second.into;
  return find(id);
}

void PatchGraph::forget_aliases(std::int64_t before_row) {
  for (auto at = past_aliases_.begin(); at != past_aliases_.end();) {
    const auto alias = at++;
    if (alias->second.row < before_row) spare_aliases_.push_back(past_aliases_.extract(alias));
  }
}

std::uint32_t PatchGraph::unite(std::uint32_t a, std::uint32_t b, std::vector<PatchMerge>& merges) {
  if (a == b) return a;
  const std::uint32_t into = std::min(a, b), from = std::max(a, b);
  const auto at = nodes_.find(from);
  PatchNode& to = node(into);
  PatchNode& gone = at->second;
  to.borders.erase(from);
  for (const auto& [other, border] : gone.borders) {
    if (other == from || other == into) {
      if (border.total() > 0.0) to.borders[into].add(border);
      continue;
    }
    to.borders[other].add(border);
    PatchNode& neighbour = node(other);
    neighbour.borders[into].add(neighbour.borders.at(from));
    neighbour.borders.erase(from);
  }
  to.sums.add(gone.sums);
  to.open += gone.open;
  to.holes += gone.holes;
  to.last_row = std::max(to.last_row, gone.last_row);
  to.s_low = std::min(to.s_low, gone.s_low);
  to.s_high = std::max(to.s_high, gone.s_high);
  to.c_low = std::min(to.c_low, gone.c_low);
  to.c_high = std::max(to.c_high, gone.c_high);
  to.doubtful = to.doubtful || gone.doubtful;
  to.closed = to.closed && gone.closed;
  if (gone.real) merges.push_back({from, into});
  to.real = to.real || gone.real;
  to.past_inside.add(gone.past_inside);
  to.past_outside.add(gone.past_outside);
  for (const std::uint32_t id : gone.past) add_past(to.past, id);
  remove(at);
  aliases_[from] = into;
  return into;
}

void PatchGraph::forget(std::uint32_t id) {
  const auto at = nodes_.find(id);
  const PatchNode& gone = at->second;
  for (const auto& [other, border] : gone.borders) {
    if (other == id) continue;
    PatchNode& neighbour = node(other);
    const Border& mine = neighbour.borders.at(id);
    if (mine.total() > 0.0) {
      (neighbour.encloses(gone) ? neighbour.past_inside : neighbour.past_outside).add(mine);
      if (gone.real) add_past(neighbour.past, id);
    }
    neighbour.borders.erase(id);
  }
  remove(at);
}

void Edge::note(const PatchAtHand& a, const PatchAtHand& b, const Cut& cut, double length, const Vector3& at_a,
                const Vector3& at_b) {
  constexpr double kFar = 1e300;
  if (!empty_ && (a.id != a_.id || b.id != b_.id)) flush();
  if (empty_) {
    a_ = a;
    b_ = b;
    empty_ = false;
    border_ = Border();
    rim_ = {};
    gap_ = kFar;
  }
  border_.length[static_cast<std::size_t>(cut.kind)] += length;
  if (cut.backed) border_.backed += length;
  if (cut.kind == BorderKind::step) border_.height += (at_a[2] - at_b[2]) * length;
  double square = 0.0;
  for (std::size_t k = 0; k < rim_.size(); ++k) {
    border_.rim[k] += at_a[k] * length;
    rim_[k] += at_b[k] * length;
    square += (at_a[k] - at_b[k]) * (at_a[k] - at_b[k]);
  }
  gap_ = std::min(gap_, square);
}

void Edge::flush() {
  if (empty_) return;
  empty_ = true;
  border_.gap = std::sqrt(gap_);
  a_.node->borders[b_.id].add(border_);
  if (a_.id == b_.id) return; // a crease that ends inside a patch is one border, not two
  border_.rim = rim_;
  border_.height = -border_.height;
  b_.node->borders[a_.id].add(border_);
}

} // namespace scansion
