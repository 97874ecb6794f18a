// Stretches between cuts, joined with those of the line before over columns that nothing cuts.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch_grower.hpp"

#include "pipeline/feature/forms.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

constexpr double kDropout = 3.5;        // pitches between samples that still belong together
constexpr std::int64_t kCloseAfter = 2; // rows without a sample
constexpr double kSmall = 25.0;         // samples: fewer are no patch
constexpr double kLarge = 100.0;        // samples: a patch that is not given up for a narrow contact
constexpr double kNarrow = 0.25;        // of a border: a contact below this joins nothing

} // namespace

void PatchGrower::hold(const Profile& profile) {
  Row row;
  if (!spare_.empty()) {
    row = std::move(spare_.back());
    spare_.pop_back();
  }
  row.line = profile.line;
  row.c = profile.c;
  row.turned = profile.turned;
  row.s.assign(profile.s.begin(), profile.s.end());
  row.w.assign(profile.w.begin(), profile.w.end());
  row.source.assign(profile.source.begin(), profile.source.end());
  row.ends.assign(profile.ends.begin(), profile.ends.end());
  rows_.push_back(std::move(row));
}

// Stretches of the row: ends of runs, dropouts and cuts part them.
void PatchGrower::split(const Row& row, const Sampling& sampling) {
  now_.clear();
  std::uint32_t begin = 0;
  std::size_t cut = 0;
  for (const std::uint32_t end : row.ends) {
    Stretch open;
    open.first = begin;
    for (std::uint32_t k = begin; k < end; ++k) {
      const bool last = k + 1 == end;
      const bool hole = !last && row.s[k + 1] - row.s[k] > kDropout * sampling.pitch;
      while (cut < in_line_.size() && in_line_[cut].s < row.s[k]) ++cut;
      const bool parted = !last && !hole && cut < in_line_.size() && in_line_[cut].s < row.s[k + 1];
      if (!last && !hole && !parted) continue;
      open.last = k;
      open.s_low = row.s[open.first];
      open.s_high = row.s[k];
      now_.push_back(open);
      open = Stretch();
      open.first = k + 1;
      open.cut_before = parted;
      if (parted) open.cut = in_line_[cut];
    }
    begin = end;
  }
}

// Unites the stretches of this row with those of the row before. Two patches that are already large are not united by a stretch
// that merely touches both: one missing point of a feature line would do that.
void PatchGrower::link(const Sampling& sampling, double pitch, FeatureReport& report) {
  struct Contact {
    std::size_t stretch = 0;
    std::uint32_t patch = 0;
    double open = 0.0, cut = 0.0;
  };
  std::vector<Contact> contacts;
  std::vector<bool> has(now_.size(), false);
  std::size_t first = 0;
  for (std::size_t i = 0; i < now_.size(); ++i) {
    const Stretch& b = now_[i];
    while (first < above_.size() && above_[first].s_high < b.s_low - pitch) ++first;
    for (std::size_t j = first; j < above_.size() && above_[j].s_low <= b.s_high; ++j) {
      const Stretch& a = above_[j];
      const auto from = static_cast<std::int64_t>(std::ceil(std::max(a.s_low, b.s_low) / pitch));
      const auto to = static_cast<std::int64_t>(std::floor(std::min(a.s_high, b.s_high) / pitch));
      if (to < from) continue;
      const auto low =
          std::lower_bound(across_.begin(), across_.end(), from, [](const Cut& c, std::int64_t k) { return c.column < k; });
      const auto high = std::upper_bound(low, across_.end(), to, [](std::int64_t k, const Cut& c) { return k < c.column; });
      const auto cut = static_cast<double>(high - low);
      const double open = static_cast<double>(to - from + 1) - cut;
      const double least = to - from + 1 <= 2 ? 1.0 : 2.0;
      contacts.push_back({i, graph_.find(a.patch), open >= least ? open : 0.0, cut});
    }
  }
  // The widest open contact gives a stretch its patch.
  for (std::size_t i = 0; i < now_.size(); ++i) {
    const Contact* best = nullptr;
    for (const Contact& c : contacts)
      if (c.stretch == i && c.open > 0.0 && c.open >= kNarrow * (c.open + c.cut) && (best == nullptr || c.open > best->open))
        best = &c;
    now_[i].patch = best != nullptr ? best->patch : graph_.create(row_number_);
  }
  for (const Contact& c : contacts) {
    const std::uint32_t own = graph_.find(now_[c.stretch].patch), other = graph_.find(c.patch);
    if (own == other || c.open <= 0.0) continue;
    if (c.open < kNarrow * (c.open + c.cut)) continue;
    const Border known = graph_.node(own).borders[other];
    const bool both_large = graph_.node(own).sums.count() >= kLarge && graph_.node(other).sums.count() >= kLarge;
    const double contact = known.contact + sampling.spacing;
    graph_.node(own).borders[other].contact = contact;
    graph_.node(other).borders[own].contact = contact;
    // Rows that touch both, against the border that parts them.
    const double limit = std::max(4.0 * sampling.coarse(), kNarrow * known.total());
    if (both_large && known.total() > 0.0 && contact < limit) {
      graph_.node(own).doubtful = true;
      continue;
    }
    graph_.unite(own, other, report.merges);
  }
}

// Sums and borders of the stretches of the row.
void PatchGrower::measure(const Row& row, const Sampling& sampling) {
  const auto note = [&](std::uint32_t a, std::uint32_t b, const Cut& cut, double length, double height) {
    const auto kind = static_cast<std::size_t>(cut.kind);
    for (const bool turned : {false, true}) {
      Border& border = graph_.node(turned ? b : a).borders[turned ? a : b];
      border.length[kind] += length;
      if (cut.backed) border.backed += length;
      border.height += (turned ? -height : height) * length;
    }
  };
  for (std::size_t i = 0; i < now_.size(); ++i) {
    Stretch& t = now_[i];
    t.patch = graph_.find(t.patch);
    PatchGraph::Node& n = graph_.node(t.patch);
    const std::size_t count = t.last - t.first + 1;
    n.sums.add({row.s.data() + t.first, count}, {row.w.data() + t.first, count}, row.c);
    n.last_row = row_number_;
    n.s_low = std::min(n.s_low, t.s_low);
    n.s_high = std::max(n.s_high, t.s_high);
    n.c_low = std::min(n.c_low, row.c);
    n.c_high = std::max(n.c_high, row.c);
    if (i > 0 && t.cut_before) {
      const std::uint32_t left = graph_.find(now_[i - 1].patch);
      const double step = row.w[t.first] - row.w[now_[i - 1].last];
      if (left != t.patch) note(t.patch, left, t.cut, sampling.spacing, t.cut.kind == BorderKind::step ? step : 0.0);
      const double gap = std::hypot(row.s[t.first] - row.s[now_[i - 1].last], step);
      for (const auto& [own, other] : {std::pair{t.patch, left}, std::pair{left, t.patch}}) {
        PatchGraph::Node& node = graph_.node(own);
        if (own == other || (node.has_nearest && node.nearest_gap <= gap)) continue;
        node.nearest = other;
        node.nearest_gap = gap;
        node.has_nearest = true;
      }
    } else {
      n.open += sampling.spacing;
      if (i > 0) graph_.node(now_[i - 1].patch).open += sampling.spacing;
    }
    if (i + 1 == now_.size()) n.open += sampling.spacing;
  }
  // Borders across the lines: columns that are cut, with the patch on either side.
  std::size_t a = 0, b = 0;
  for (const Cut& cut : across_) {
    while (a < above_.size() && above_[a].s_high < cut.s) ++a;
    while (b < now_.size() && now_[b].s_high < cut.s) ++b;
    if (a == above_.size() || b == now_.size() || above_[a].s_low > cut.s || now_[b].s_low > cut.s) continue;
    const std::uint32_t upper = graph_.find(above_[a].patch), lower = graph_.find(now_[b].patch);
    if (upper == lower) continue;
    const auto height_at = [&](const Row& r, const Stretch& t) {
      const auto begin = r.s.begin() + t.first, end = r.s.begin() + t.last + 1;
      auto it = std::lower_bound(begin, end, cut.s);
      if (it == end) --it;
      return r.w[static_cast<std::size_t>(it - r.s.begin())];
    };
    const double step = cut.kind == BorderKind::step ? height_at(row, now_[b]) - height_at(last_row_, above_[a]) : 0.0;
    note(lower, upper, cut, pitch_, step);
  }
}

void PatchGrower::emit(const Row& row, FeatureReport& report) const {
  for (const Stretch& t : now_) {
    PatchRun run;
    run.line = row.line;
    const std::uint32_t x = row.source[t.first], y = row.source[t.last];
    run.first = std::min(x, y);
    run.count = std::max(x, y) - run.first + 1;
    run.patch = t.patch;
    report.runs.push_back(run);
  }
}

void PatchGrower::dissolve(std::uint32_t id, FeatureReport& report) {
  PatchGraph::Node& n = graph_.node(id);
  if (!n.has_nearest || !graph_.knows(n.nearest)) return;
  graph_.unite(id, n.nearest, report.merges);
}

void PatchGrower::publish(std::uint32_t id, const Sampling& sampling, FeatureReport& report) {
  Patch patch;
  patch.id = id;
  PatchGraph::Node& n = graph_.node(id);
  n.sums.describe(frame_, sampling, origin_, patch);
  patch.doubtful = n.doubtful;
  for (const auto& [other, border] : graph_.borders_of(id))
    if (border.total() > 0.0) patch.neighbours.push_back(other);
  const Labelled label = label_patch(graph_, id, patch, sampling);
  patch.label = label.kind;
  n.published = true;
  report.patches.push_back(patch);
  const bool carries = label.kind == FormKind::rib || label.kind == FormKind::boss || label.kind == FormKind::slot ||
                       label.kind == FormKind::pocket;
  if (!carries) return;
  Form form;
  form.kind = label.kind;
  form.confidence = label.confidence;
  form.patches.push_back(id);
  report.forms.push_back(std::move(form));
}

// Patches that the last rows did not touch are done.
void PatchGrower::close(std::int64_t row, const Sampling& sampling, FeatureReport& report) {
  std::vector<std::uint32_t> done;
  for (auto& [id, node] : graph_.nodes())
    if (node.parent == id && !node.published && row - node.last_row >= kCloseAfter) done.push_back(id);
  for (const std::uint32_t id : done)
    if (graph_.find(id) == id && graph_.node(id).sums.count() < kSmall) dissolve(id, report);
  for (const std::uint32_t id : done)
    if (graph_.find(id) == id && row - graph_.node(id).last_row >= kCloseAfter) publish(id, sampling, report);
}

void PatchGrower::assign(const Row& row, Cuts& cuts, const Sampling& sampling, FeatureReport& report) {
  if (pitch_ == 0.0) pitch_ = sampling.pitch;
  cuts.at(last_c_, row.c, pitch_, in_line_, across_);
  const bool far = row_number_ > 0 && row.c - last_c_ > 3.6 * sampling.spacing;
  if (far) above_.clear();
  split(row, sampling);
  link(sampling, pitch_, report);
  measure(row, sampling);
  emit(row, report);
  std::swap(above_, now_);
  last_c_ = row.c;
  ++row_number_;
}

void PatchGrower::advance(double complete, Cuts& cuts, const Sampling& sampling, FeatureReport& report) {
  while (!rows_.empty() && rows_.front().c <= complete) {
    assign(rows_.front(), cuts, sampling, report);
    spare_.push_back(std::move(last_row_));
    last_row_ = std::move(rows_.front());
    rows_.pop_front();
  }
  close(row_number_ - 1, sampling, report);
}

void PatchGrower::finish(const Sampling& sampling, FeatureReport& report) {
  // Two passes: small patches go first, and what they go to is then complete.
  close(row_number_ + kCloseAfter, sampling, report);
}

void PatchGrower::restart() {
  above_.clear();
  last_c_ = -1e300;
}

} // namespace scansion
