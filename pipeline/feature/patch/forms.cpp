// Forms from roles: floors and tops with their walls, pairs of flanks, levels with what joins them.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch/forms.hpp"

#include "pipeline/feature/patch/patch_role.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scansion {

namespace {

constexpr double kTilted = 20.0;      // degrees: a strip that leans so much against what is around it is no top and no floor
constexpr double kLevelled = 20.0;    // degrees: levels of one step lean no more against each other
constexpr double kBent = 15.0;        // degrees across a strip: it rounds the edge
constexpr double kWallTilt = 45.0;    // degrees
constexpr double kAllRound = 0.7;     // of the border that leads anywhere
constexpr double kSide = 0.25;        // of an outline: a side of a form
constexpr double kClosed = 0.02;      // of an outline: so much of it may be open in a form without open ends
constexpr double kNoWider = 1.1;      // against the smallest level beside it
constexpr double kCrease = 0.2;       // of a flank's outline: what two flanks of one groove share
constexpr double kOtherSide = 0.6;    // of the rest of its outline
constexpr double kLeastHeight = 0.03; // mm: a top stands so much above what is around it
constexpr double kNoise = 3.0;        // sigmas: and so much
constexpr double kRound = 1.6;        // length / width of a pyramid
constexpr double kStepBorder = 0.15;  // of the smaller level's outline
constexpr std::size_t kMostPartners = 64; // of steps: with more, those that are forgotten go
constexpr double kLeastSteps = 6.0;       // coarse steps: and no shorter than this

class Namer {
public:
  Namer(PatchGraph& graph, PatchLooks& looks, const Sampling& sampling, std::vector<Form>& forms)
      : graph_(graph), looks_(looks), sampling_(sampling), forms_(forms) {}

  FormKind name(std::uint32_t id) {
    if (graph_.node(id).form != FormKind::face) return graph_.node(id).form;
    const PatchLook& look = looks_.of(id);
    if (look.role == Role::flank) return name_flank(id, look);
    if (look.role == Role::strip) return kind_of_strip(id);
    FormKind kind = FormKind::face;
    if (look.role == Role::trough || look.role == Role::bulge)
      kind = kind_of(look.role == Role::bulge, look.is_long() || goes_on(id, look));
    if (look.role == Role::top || look.role == Role::floor) kind = kind_of_level(id, look);
    if (kind == FormKind::face) name_steps(id, look);
    if (kind == FormKind::face || kind == FormKind::chamfer || kind == FormKind::fillet) return kind;
    graph_.node(id).form = kind;
    emit(kind, with_walls(id), look.outline);
    return kind;
  }

private:
  [[nodiscard]] static FormKind kind_of(bool raised, bool is_long) noexcept {
    if (raised) return is_long ? FormKind::rib : FormKind::boss;
    return is_long ? FormKind::slot : FormKind::pocket;
  }

  [[nodiscard]] FormKind kind_of_strip(std::uint32_t id) const {
    return graph_.node(id).sums.turning(sampling_.noise) >= kBent ? FormKind::fillet : FormKind::chamfer;
  }

  void emit(FormKind kind, std::vector<std::uint32_t> patches, const Outline& outline) {
    Form form;
    form.kind = kind;
    form.patches = std::move(patches);
    form.confidence = outline.cut() > 0.0 ? std::min(1.0, outline.backed / outline.cut()) : 0.0;
    forms_.push_back(std::move(form));
  }

  /// Is it a piece of a groove or rib that another one crosses, so that flanks or pieces like it lie beside it?
  [[nodiscard]] bool goes_on(std::uint32_t id, const PatchLook& look) const {
    double beside = 0.0;
    for (const auto& [other, border] : graph_.node(id).borders) {
      if (other == id) continue;
      const Role role = looks_.of(other).role;
      if (role == Role::flank || role == look.role) beside += border.total();
    }
    return beside >= kSide * look.outline.cut();
  }

  /// The patch and the flanks around it that are smaller.
  std::vector<std::uint32_t> with_walls(std::uint32_t id) const {
    std::vector<std::uint32_t> patches{id};
    for (const auto& [other, border] : graph_.node(id).borders) {
      if (other == id || border.total() <= 0.0) continue;
      const PatchLook& look = looks_.of(other);
      if (look.role == Role::flank && border.total() >= kCrease * look.outline.all()) patches.push_back(other);
    }
    return patches;
  }

  /// What a top or floor makes of its patch. All that lies around must lie lower, or higher: a land between two grooves is as
  /// high as what is beyond them.
  [[nodiscard]] FormKind kind_of_level(std::uint32_t id, const PatchLook& look) const {
    const PatchNode& own = graph_.node(id);
    const bool raised = look.role == Role::top;
    const double least = std::max(kLeastHeight, kNoise * sampling_.noise);
    const PatchNode* largest = nullptr;
    double smallest = std::numeric_limits<double>::infinity();
    double border = 0.0, falls = 0.0;
    for (const Level& level : looks_.levels_around(id)) {
      const PatchNode& other = graph_.node(level.patch);
      if (own.encloses(other)) continue;
      border += level.border;
      if ((raised ? level.fall : -level.fall) >= least) falls += level.border;
      if (largest == nullptr || other.sums.count() > largest->sums.count()) largest = &other;
      if (level.border >= kSide * look.outline.cut()) smallest = std::min(smallest, other.sums.count());
    }
    if (look.is_long() && largest != nullptr && angle_between(look.plane, largest->sums.plane()) >= kTilted)
      return kind_of_strip(id);
    if (falls < kAllRound * border) return FormKind::face;
    // Between two steps the narrower part is the form.
    const bool open = look.outline.open > kClosed * look.outline.all();
    if (open && own.sums.count() > kNoWider * smallest) return FormKind::face;
    return kind_of(raised, look.is_long());
  }

  /// Is the patch a plain level, between which there may be a step?
  [[nodiscard]] bool is_plain(std::uint32_t id, const PatchLook& look) const {
    if (look.role == Role::face) return true;
    return (look.role == Role::top || look.role == Role::floor) && kind_of_level(id, look) == FormKind::face;
  }

  /// Do the two flanks meet in a crease that is long against both, `concave` or convex, with the other polarity around them?
  [[nodiscard]] bool is_pair(std::uint32_t a, std::uint32_t b, bool concave) const {
    const Border& border = graph_.node(a).borders.at(b);
    const double crease = border.length[concave ? 1 : 0];
    for (const std::uint32_t id : {a, b}) {
      const PatchLook& look = looks_.of(id);
      if (look.role != Role::flank || crease < kCrease * look.outline.all()) return false;
      const double other = concave ? look.outline.high : look.outline.low;
      const double same = (concave ? look.outline.low : look.outline.high) - crease;
      if (other < kOtherSide * (other + std::max(0.0, same)) || other < kCrease * look.outline.all()) return false;
    }
    return true;
  }

  /// Flanks that fall to one place from all sides, among faces: a pyramid and no groove.
  [[nodiscard]] bool is_pit(const std::vector<std::uint32_t>& flanks) const {
    if (flanks.size() < 3) return false;
    PatchSums sums;
    double faces = 0.0, all = 0.0;
    for (const std::uint32_t id : flanks) {
      sums.add(graph_.node(id).sums);
      for (const auto& [other, border] : graph_.node(id).borders) {
        if (std::find(flanks.begin(), flanks.end(), other) != flanks.end()) continue;
        all += border.total();
        if (looks_.of(other).role != Role::flank) faces += border.total();
      }
    }
    const auto [length, width] = sums.box();
    return length < kRound * width && faces > kOtherSide * all;
  }

  FormKind name_flank(std::uint32_t id, const PatchLook& look) {
    for (const bool concave : {true, false}) {
      std::vector<std::uint32_t> flanks{id};
      for (std::size_t k = 0; k < flanks.size(); ++k) {
        for (const auto& [other, border] : graph_.node(flanks[k]).borders) {
          if (border.total() <= 0.0 || std::find(flanks.begin(), flanks.end(), other) != flanks.end()) continue;
          if (graph_.node(other).form == FormKind::face && is_pair(flanks[k], other, concave)) flanks.push_back(other);
        }
      }
      if (flanks.size() < 2) continue;
      const FormKind kind = kind_of(!concave, !is_pit(flanks));
      for (const std::uint32_t flank : flanks) graph_.node(flank).form = kind;
      std::sort(flanks.begin(), flanks.end(),
                [&](std::uint32_t a, std::uint32_t b) { return graph_.node(a).sums.count() > graph_.node(b).sums.count(); });
      emit(kind, std::move(flanks), look.outline);
      return kind;
    }
    for (const Level& level : looks_.levels_around(id))
      if (angle_between(look.plane, graph_.node(level.patch).sums.plane()) >= kWallTilt) return FormKind::wall;
    return FormKind::face;
  }

  /// Steps from this level to those around it.
  void name_steps(std::uint32_t id, const PatchLook& look) {
    for (const Level& level : looks_.levels_around(id)) {
      PatchNode& own = graph_.node(id);
      const std::vector<std::uint32_t>& known = own.steps_to;
      if (std::find(known.begin(), known.end(), level.patch) != known.end()) continue;
      const PatchLook& other = looks_.of(level.patch);
      if (!is_large(look) || !is_large(other)) continue;
      if (!is_plain(level.patch, other) || angle_between(look.plane, other.plane) > kLevelled) continue;
      if (!is_step(id, level, std::min(look.outline.all(), other.outline.all()))) continue;
      std::vector<std::uint32_t> patches = level.over;
      patches.insert(patches.begin(), level.fall > 0.0 ? id : level.patch);
      patches.push_back(level.fall > 0.0 ? level.patch : id);
      if (own.steps_to.size() >= kMostPartners) std::erase_if(own.steps_to, [&](std::uint32_t p) { return !graph_.knows(p); });
      own.steps_to.push_back(level.patch);
      graph_.node(level.patch).steps_to.push_back(id);
      emit(FormKind::step, std::move(patches), look.outline);
    }
  }

  /// Wide enough to be one of the levels of a step.
  [[nodiscard]] bool is_large(const PatchLook& look) const { return look.width >= kLeastSteps * sampling_.coarse(); }

  [[nodiscard]] bool is_step(std::uint32_t id, const Level& level, double outline) const {
    if (std::abs(level.fall) < std::max(kLeastHeight, kNoise * sampling_.noise)) return false;
    const double least = std::max(kLeastSteps * sampling_.coarse(), kStepBorder * outline);
    if (level.over.empty()) return graph_.node(id).borders.at(level.patch).length[2] >= least;
    const Border& here = graph_.node(id).borders.at(level.over.front());
    const Border& there = graph_.node(level.patch).borders.at(level.over.back());
    const bool falls = high_of(here) > low_of(here);
    return here.total() >= least && there.total() >= least && falls != (high_of(there) > low_of(there)) &&
           falls == (level.fall > 0.0);
  }

  PatchGraph& graph_;
  PatchLooks& looks_;
  const Sampling& sampling_;
  std::vector<Form>& forms_;
};

} // namespace

FormKind name_forms(PatchGraph& graph, std::uint32_t id, PatchLooks& looks, const Sampling& sampling,
                    std::vector<Form>& forms) {
  return Namer(graph, looks, sampling, forms).name(id);
}

} // namespace scansion
