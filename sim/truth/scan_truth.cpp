// The ground truth of one scan.
// SPDX-License-Identifier: Apache-2.0
#include "sim/truth/scan_truth.hpp"

#include "sim/scene/scan_command.hpp"
#include "sim/truth/curves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace scansion {

namespace {

double plan_length(const TrueCurve& curve) noexcept {
  const std::size_t n = curve.points.size();
  double length = 0.0;
  for (std::size_t k = curve.closed ? 0 : 1; k < n; ++k) {
    const auto &a = curve.points[(k + n - 1) % n], &b = curve.points[k];
    length += std::hypot(b[0] - a[0], b[1] - a[1]);
  }
  return length;
}

} // namespace

Result<ScanTruth> ScanTruth::create(Scene scene, const ScanPlan& plan) {
  ScanPlan clean = plan; // keeps the jitter: a sample's place is its true one
  clean.noise_um = 0.0;
  clean.correlated_mm = clean.outliers = clean.dropouts = clean.missing_lines = 0.0;
  SCANSION_TRY(scanner, SceneScanner::create(std::move(scene), clean));
  scanner.undeceive();
  return ScanTruth(plan, std::make_unique<SceneScanner>(std::move(scanner)));
}

ScanTruth::ScanTruth(const ScanPlan& plan, std::unique_ptr<SceneScanner> scanner)
    : plan_(plan), clean_(std::move(scanner)), cells_(clean_->scene()), steps_(clean_->scene().features.size()),
      rims_(clean_->scene().holes.size()) {}

std::uint32_t ScanTruth::root(std::uint32_t node) noexcept {
  while (parent_[node] != node) {
    parent_[node] = parent_[parent_[node]];
    node = parent_[node];
  }
  return node;
}

void ScanTruth::add(const SceneLine& line) {
  if (!clean_->next(line_)) return;
  before_.swap(now_);
  first_before_ = first_now_;
  split_line(line_);
  join_lines();
  write_runs(line);
}

void ScanTruth::split_line(const SceneLine& clean) {
  now_.clear();
  // Lines that follow a silhouette begin at different places.
  const ScanGeometry& geometry = clean_->geometry();
  first_now_ = -0.5 * static_cast<double>(clean.points.size());
  if (clean_->scene().span != nullptr && geometry.pitch > 0.0) {
    const double t = (static_cast<double>(clean.index) + 0.5) / static_cast<double>(geometry.lines);
    first_now_ += clean_->scene().span(t).centre * geometry.window / geometry.pitch;
  }
  if (clean.index % 2 == 1 && plan_.backlash_um != 0.0) first_now_ -= plan_.backlash_um / geometry.pitch;
  for (std::uint32_t k = 0; k < clean.points.size(); ++k) {
    const ScenePoint& point = clean.points[k];
    if (!point.is_there()) continue;
    const std::uint32_t cell = cells_.at(point.x / 1000.0, point.y / 1000.0, point.z / 1000.0);
    const bool beside = !now_.empty() && now_.back().first + now_.back().count == k;
    if (beside && now_.back().cell == cell) {
      ++now_.back().count;
      continue;
    }
    const auto node = static_cast<std::uint32_t>(parent_.size());
    parent_.push_back(node);
    node_cell_.push_back(cell);
    now_.push_back({k, 1, cell, node});
    if (beside) touch(now_[now_.size() - 2], now_.back());
    if (k > 0 && clean.points[k - 1].state == SampleState::hole) note_rim(clean.points[k - 1], node);
  }
}

/// `node` begins behind a point of a hole.
void ScanTruth::note_rim(const ScenePoint& inside, std::uint32_t node) {
  const Scene& scene = clean_->scene();
  const Hole* const hole = scene.hole_at(inside.x / 1000.0, inside.y / 1000.0);
  if (hole != nullptr) rims_[static_cast<std::size_t>(hole - scene.holes.data())].push_back(node);
}

/// Stretches of one cell that lie beside each other are one patch.
void ScanTruth::join_lines() {
  const double shift = first_now_ - first_before_;
  std::size_t b = 0;
  for (const Stretch& a : now_) {
    const double low = a.first + shift;
    const double high = low + a.count;
    while (b > 0 && before_[b].first + before_[b].count > low) --b;
    for (; b < before_.size() && before_[b].first < high - 0.5; ++b) {
      const Stretch& other = before_[b];
      if (other.first + other.count <= low + 0.5) continue;
      if (other.cell == a.cell) {
        const std::uint32_t p = root(a.node);
        const std::uint32_t q = root(other.node);
        parent_[std::max(p, q)] = std::min(p, q);
      } else {
        touch(a, other);
      }
    }
    if (b == before_.size() && b > 0) --b;
  }
}

void ScanTruth::touch(const Stretch& a, const Stretch& b) {
  for (std::size_t k = 0; k < steps_.size(); ++k) {
    if (cells_.form(k) != FormKind::step || !cells_.parted_by(k, a.cell, b.cell)) continue;
    steps_[k].push_back(a.node);
    steps_[k].push_back(b.node);
  }
}

void ScanTruth::write_runs(const SceneLine& line) {
  std::vector<TrueRun> runs;
  const auto size = static_cast<std::uint32_t>(line.points.size());
  const bool backwards = plan_.zigzag && line.index % 2 == 1;
  std::size_t at = backwards && !now_.empty() ? now_.size() - 1 : 0;
  for (std::uint32_t k = 0; k < size; ++k) {
    if (!line.points[k].is_there()) continue;
    const std::uint32_t sample = backwards ? size - 1 - k : k;
    while (sample >= now_[at].first + now_[at].count) ++at;
    while (sample < now_[at].first) --at;
    if (!runs.empty() && runs.back().patch == now_[at].node)
      ++runs.back().count;
    else
      runs.push_back({1, now_[at].node});
  }
  if (!runs.empty()) runs_.push_back(std::move(runs));
}

void ScanTruth::number_patches(Truth& truth) {
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number(parent_.size(), kNone);
  for (auto& line : runs_) {
    for (TrueRun& run : line) {
      const std::uint32_t node = root(run.patch);
      if (number[node] == kNone) {
        number[node] = static_cast<std::uint32_t>(truth.patches.size());
        truth.patches.push_back({cells_.kind(node_cell_[node]), 0});
      }
      run.patch = number[node];
      truth.patches[run.patch].samples += run.count;
    }
  }
  truth.lines = std::move(runs_);

  for (std::size_t k = 0; k < steps_.size(); ++k) {
    TrueForm form{cells_.form(k), static_cast<std::uint32_t>(k), {}, {}};
    if (form.kind == FormKind::face) continue;
    if (form.kind == FormKind::step) {
      for (const std::uint32_t node : steps_[k]) form.patches.push_back(number[root(node)]);
    } else {
      for (std::uint32_t node = 0; node < parent_.size(); ++node) {
        if (parent_[node] == node && cells_.inside(k, node_cell_[node])) form.patches.push_back(number[node]);
      }
    }
    std::ranges::sort(form.patches);
    form.patches.erase(std::unique(form.patches.begin(), form.patches.end()), form.patches.end());
    std::erase(form.patches, kNone);
    if (!form.patches.empty()) truth.forms.push_back(std::move(form));
  }
  for (std::size_t k = 0; k < rims_.size(); ++k) add_hole(k, number, truth);
}

/// Holes that the scan window cuts are none.
void ScanTruth::add_hole(std::size_t k, const std::vector<std::uint32_t>& number, Truth& truth) {
  const Scene& scene = clean_->scene();
  const auto feature = static_cast<std::uint32_t>(scene.features.size() + k);
  constexpr double kWhole = 0.98;
  const Footprint& outline = scene.holes[k].outline;
  double seen = 0.0; // mm of its outline, in plan
  for (const TrueCurve& curve : truth.curves)
    if (curve.feature == feature) seen += plan_length(curve);
  if (seen < kWhole * outline.perimeter() || rims_[k].empty()) return;
  std::map<std::uint32_t, std::size_t> votes;
  for (const std::uint32_t node : rims_[k]) ++votes[number[root(node)]];
  const auto most = std::ranges::max_element(votes, {}, [](const auto& entry) { return entry.second; });
  const PlanVector middle = outline.middle();
  TrueForm form{FormKind::hole, feature, {most->first}, {}};
  form.hole = TrueHole{{middle.x, middle.y, scene.height(middle.x, middle.y)}, outline.area()};
  truth.forms.push_back(std::move(form));
}

Truth ScanTruth::finish() {
  Truth truth;
  const ScanGeometry& geometry = clean_->geometry();
  truth.scene = clean_->scene().name;
  truth.command = scan_command(clean_->scene(), plan_);
  truth.pitch_mm = geometry.pitch / 1000.0;
  truth.spacing_mm = geometry.spacing / 1000.0;
  truth.noise_um = plan_.noise_um.value_or(clean_->scene().noise_um);
  truth.direction_deg = plan_.direction_deg;
  truth.tilt_deg = plan_.tilt_deg;
  truth.area_mm2 = static_cast<double>(geometry.samples) * truth.pitch_mm * truth.spacing_mm;
  truth.curves = true_curves(clean_->scene(), geometry);
  number_patches(truth);
  return truth;
}

} // namespace scansion
