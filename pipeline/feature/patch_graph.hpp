// Patches while they grow: what belongs together, what borders on what.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/cuts.hpp"
#include "pipeline/feature/patch_shape.hpp"

#include <array>
#include <map>
#include <vector>

namespace scansion {

/// The border of one patch with another, lengths in mm.
struct Border {
  std::array<double, 3> length{}; ///< by BorderKind: convex, concave, step
  double backed = 0.0;            ///< of these, backed by points of feature lines
  double contact = 0.0;           ///< where nothing cuts them apart
  double height = 0.0;            ///< integral of (this patch's height - the other's) over the border's length
  [[nodiscard]] double total() const noexcept { return length[0] + length[1] + length[2]; }
};

/// Thread-bound. Ids are handed out in order; patches that are done are forgotten.
class PatchGraph {
public:
  struct Node {
    std::uint32_t parent = 0; ///< itself for a patch of its own
    PatchSums sums;
    std::map<std::uint32_t, Border> borders; ///< by the other patch's id, which may be out of date: see find()
    double open = 0.0;                       ///< border on the end of the data, mm
    std::int64_t last_row = 0;
    double width_rows = 0.0, rows = 0.0; ///< sum of widths along the lines, rows seen
    double s_low = 0.0, s_high = 0.0, c_low = 0.0, c_high = 0.0;
    double slope = 0.0; ///< steepest of its planes met, degrees
    bool doubtful = false;
    std::uint32_t nearest = 0; ///< patch that stands nearest on a line, and how near
    double nearest_gap = 0.0;
    bool has_nearest = false;
    bool published = false;
  };

  [[nodiscard]] std::uint32_t create(std::int64_t row);
  [[nodiscard]] std::uint32_t find(std::uint32_t id);
  [[nodiscard]] Node& node(std::uint32_t id) { return nodes_.at(find(id)); }
  /// Both belong together from now on; the lower id stays. Returns it.
  std::uint32_t unite(std::uint32_t a, std::uint32_t b, std::vector<PatchMerge>& merges);
  /// Borders of one patch by the ids in force.
  [[nodiscard]] std::map<std::uint32_t, Border> borders_of(std::uint32_t id);
  void forget(std::uint32_t id) { nodes_.erase(id); }
  [[nodiscard]] std::map<std::uint32_t, Node>& nodes() noexcept { return nodes_; }
  [[nodiscard]] bool knows(std::uint32_t id) const { return nodes_.contains(id); }

private:
  std::map<std::uint32_t, Node> nodes_;
  std::uint32_t next_ = 0;
};

} // namespace scansion
