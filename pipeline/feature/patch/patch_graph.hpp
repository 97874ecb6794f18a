// Patches while they grow: what belongs together, what borders on what.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/patch/borders.hpp"
#include "pipeline/feature/patch/cuts.hpp"
#include "pipeline/feature/patch/patch_shape.hpp"

#include <boost/container/flat_map.hpp>

#include <array>
#include <unordered_map>
#include <vector>

namespace scansion {

struct PatchNode {
  PatchSums sums;
  Borders borders;
  double open = 0.0;  ///< border on the end of the data, mm
  double holes = 0.0; ///< area of those in it, mm2
  std::int64_t last_row = 0;
  double s_low = 1e300, s_high = -1e300, c_low = 1e300, c_high = -1e300;
  bool doubtful = false;
  bool closed = false;                 ///< no further sample comes
  bool real = false;                   ///< large enough to be told of, and told of from then on
  bool settled = false;                ///< published, with its form, unless it is not real
  FormKind form = FormKind::face;      ///< of the form feature, already published, whose top, floor or flank it is
  Border past_inside, past_outside;    ///< borders with patches that are forgotten: enclosed by this one, and others
  std::vector<std::uint32_t> past;     ///< their ids, not more than kMostPast
  std::vector<std::uint32_t> steps_to; ///< patches with which it makes a step that is published
  static constexpr std::size_t kMostPast = 1024;

  /// A new patch in the same memory, with room for as many borders.
  void restart();
  [[nodiscard]] bool encloses(const PatchNode& other) const noexcept {
    return other.s_low > s_low && other.s_high < s_high && other.c_low > c_low && other.c_high < c_high;
  }
};

/// A disjoint-set forest whose lowest id is the patch. Borders always bear the ids in force. Thread-bound.
class PatchGraph {
public:
  [[nodiscard]] std::uint32_t create(std::int64_t row);
  /// The id in force; only of patches united since resolve().
  [[nodiscard]] std::uint32_t find(std::uint32_t id) const;
  /// Nobody but what calls find_past() holds an id from before any more.
  void resolve(std::int64_t row);
  /// The id in force of a patch that was united no further back than forget_aliases() says.
  [[nodiscard]] std::uint32_t find_past(std::uint32_t id) const;
  void forget_aliases(std::int64_t before_row);
  [[nodiscard]] PatchNode& node(std::uint32_t id) { return nodes_.at(id); }
  [[nodiscard]] const PatchNode& node(std::uint32_t id) const { return nodes_.at(id); }
  /// Null when it was forgotten, or went into another one.
  [[nodiscard]] PatchNode* known(std::uint32_t id) {
    const auto at = nodes_.find(id);
    return at != nodes_.end() ? &at->second : nullptr;
  }
  [[nodiscard]] bool knows(std::uint32_t id) const { return nodes_.contains(id); }
  /// In no order.
  [[nodiscard]] const std::unordered_map<std::uint32_t, PatchNode>& nodes() const noexcept { return nodes_; }
  /// Both, by the ids in force, belong together from now on; `merges` says so when the one that goes was told of. Returns the
  /// id that stays.
  std::uint32_t unite(std::uint32_t a, std::uint32_t b, std::vector<PatchMerge>& merges);
  /// A settled patch: its neighbours keep only sums of it.
  void forget(std::uint32_t id);

private:
  using Nodes = std::unordered_map<std::uint32_t, PatchNode>;
  void remove(Nodes::iterator at);

  Nodes nodes_;
  std::vector<Nodes::node_type> spare_; ///< of patches that are gone: most slivers live for a few rows
  struct Alias {
    std::uint32_t into = 0;
    std::int64_t row = 0;
  };
  boost::container::flat_map<std::uint32_t, std::uint32_t> aliases_;
  using Aliases = std::unordered_map<std::uint32_t, Alias>;
  Aliases past_aliases_;
  std::vector<Aliases::node_type> spare_aliases_;
  std::uint32_t next_ = 0;
};

/// A patch at hand: good until patches are united or forgotten.
struct PatchAtHand {
  std::uint32_t id = 0;
  PatchNode* node = nullptr;
};

/// What two patches share along successive samples; goes to them when others follow. Thread-bound.
class Edge {
public:
  /// `length` mm of a cut between a sample of `a` and one of `b`, as (s, c, w).
  void note(const PatchAtHand& a, const PatchAtHand& b, const Cut& cut, double length, const Vector3& at_a,
            const Vector3& at_b);
  void flush();

private:
  PatchAtHand a_, b_;
  bool empty_ = true;
  Border border_;               ///< as a has it
  std::array<double, 3> rim_{}; ///< of b
  double gap_ = 0.0;            ///< mm2, of the nearest two samples
};

} // namespace scansion
