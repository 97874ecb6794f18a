// Stretches between cuts, joined with those of the line before over columns that nothing cuts.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/patch/patch_grower.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace scansion {

namespace {

constexpr double kWide = 6.0;       // columns
constexpr double kMostlyCut = 0.4;  // share of open columns below which a wide stretch begins a patch
constexpr double kLarge = 100.0;    // samples: a patch that is not given up for a narrow contact
constexpr double kNarrow = 0.25;    // of a border: a contact below this joins nothing
constexpr double kOneSurface = 2.0; // misfit up to which patches lie on one surface
constexpr double kFar = 3.6;        // spacings between rows that have nothing to do with each other

} // namespace

void PatchGrower::hold(Profile& profile) {
  if (profile.size() == 0) return;
  pitch_ = profile.scale.pitch;
  PatchRow row;
  if (!spare_.empty()) {
    row = std::move(spare_.back());
    spare_.pop_back();
  }
  if (row.take(profile))
    rows_.push_back(std::move(row));
  else
    spare_.push_back(std::move(row));
}

// Stretches of the row: ends of runs, dropouts and cuts part them.
void PatchGrower::split(const PatchRow& row) {
  now_.clear();
  auto hole = row.holes.begin();
  auto cut = in_line_.begin();
  std::uint32_t after = 0; // the first sample beyond the cut
  Stretch open;
  std::uint32_t begin = 0;
  const auto close = [&](std::uint32_t last) {
    open.first = begin;
    open.last = last;
    open.s_low = row.s[begin];
    open.s_high = row.s[last];
    now_.push_back(open);
    open = Stretch();
    begin = last + 1;
  };
  for (const std::uint32_t end : row.ends) {
    while (begin < end) {
      std::uint32_t last = end - 1;
      while (hole != row.holes.end() && *hole < begin) ++hole;
      if (hole != row.holes.end() && *hole < last) last = *hole;
      while (cut != in_line_.end() && cut->s < row.s[begin]) ++cut;
      if (cut != in_line_.end() && cut->s < row.s[last]) {
        after = row.s.beyond(std::max(after, begin), last, cut->s);
        close(after - 1);
        open.cut_before = true;
        open.cut = *cut;
        continue;
      }
      close(last);
    }
  }
}

// Whether the stretch above goes on in this one with nearly all it has, and has enough to tell.
bool PatchGrower::goes_on(const Contact& contact) const {
  constexpr double kMost = 0.75;
  const Stretch& t = above_[contact.above];
  return contact.open >= 2.0 * kWide && contact.open >= kMost * ((t.s_high - t.s_low) / pitch_ + 1.0);
}

// Where stretches of this row lie beside those of the row before: columns that nothing cuts, and columns that are cut.
void PatchGrower::find_contacts() {
  contacts_.clear();
  std::size_t first = 0;
  for (std::size_t i = 0; i < now_.size(); ++i) {
    const Stretch& b = now_[i];
    while (first < above_.size() && above_[first].s_high < b.s_low - pitch_) ++first;
    const auto known = static_cast<std::ptrdiff_t>(contacts_.size());
    double all_open = 0.0, all_cut = 0.0;
    for (std::size_t j = first; j < above_.size() && above_[j].s_low <= b.s_high; ++j) {
      const Stretch& a = above_[j];
      const auto from = static_cast<std::int64_t>(std::ceil(std::max(a.s_low, b.s_low) / pitch_));
      const auto to = static_cast<std::int64_t>(std::floor(std::min(a.s_high, b.s_high) / pitch_));
      if (to < from) continue;
      const auto low =
          std::lower_bound(across_.begin(), across_.end(), from, [](const Cut& c, std::int64_t k) { return c.column < k; });
      const auto high = std::upper_bound(low, across_.end(), to, [](std::int64_t k, const Cut& c) { return k < c.column; });
      const auto cut = static_cast<double>(high - low);
      const double open = static_cast<double>(to - from + 1) - cut;
      const double least = to - from + 1 <= 2 ? 1.0 : 2.0;
      all_open += open;
      all_cut += cut;
      if (open >= least && open >= kNarrow * (open + cut)) contacts_.push_back({i, j, a.patch, open, cut});
    }
    // A wall stands along most of it: where it lies beside the wall's ends, it touches nothing but what goes on there as a
    // whole.
    if (all_open + all_cut >= kWide && all_open < kMostlyCut * (all_open + all_cut))
      contacts_.erase(std::remove_if(contacts_.begin() + known, contacts_.end(), [&](const Contact& c) { return !goes_on(c); }),
                      contacts_.end());
  }
}

// Would the two be joined over a contact that is short against the border that parts them?
bool PatchGrower::is_leak(std::uint32_t a, std::uint32_t b, const Sampling& sampling) {
  const PatchNode& node = graph_.node(a);
  const Border* const border = node.borders.find(b);
  if (border == nullptr || border->total() <= 0.0) return false;
  if (node.sums.count() < kLarge || graph_.node(b).sums.count() < kLarge) return false;
  if (border->contact >= std::max(4.0 * sampling.coarse(), kNarrow * border->total())) return false;
  // What lies on one surface belongs together, however the border between both came about.
  return node.sums.misfit_with(graph_.node(b).sums, sampling.noise) > kOneSurface;
}

// A stretch below two patches that a border parts shows that the border was missed here: it is held where it was, for a while.
bool PatchGrower::hold_borders(const PatchRow& row, const Sampling& sampling) {
  bool any = false;
  std::vector<Stretch>& held = held_;
  held.clear();
  auto contact = contacts_.begin();
  for (std::size_t i = 0; i < now_.size(); ++i) {
    Stretch rest = now_[i];
    for (; contact != contacts_.end() && contact->stretch == i; ++contact) {
      const auto next = std::next(contact);
      if (next == contacts_.end() || next->stretch != i || next->above != contact->above + 1) continue;
      const Stretch& border = above_[next->above];
      if (!border.cut_before || contact->patch == next->patch || !is_leak(contact->patch, next->patch, sampling)) continue;
      const double s = border.cut.s + border.drift;
      const std::uint32_t after = row.s.at_or_beyond(rest.first, rest.last + 1, s);
      if (after == rest.first || after > rest.last) continue;
      Stretch left = rest;
      left.last = after - 1;
      left.s_high = row.s[after - 1];
      held.push_back(left);
      rest.first = after;
      rest.s_low = row.s[after];
      rest.cut_before = rest.held = true;
      rest.cut = border.cut;
      rest.cut.s = s;
      rest.cut.backed = false;
      rest.drift = border.drift;
      for (const auto& [own, other] : {std::pair{contact->patch, next->patch}, std::pair{next->patch, contact->patch}}) {
        graph_.node(own).borders[other].contact += sampling.spacing;
        graph_.node(own).doubtful = true;
      }
      any = true;
    }
    held.push_back(rest);
  }
  std::swap(now_, held);
  return any;
}

// How cuts move from row to row.
void PatchGrower::follow_cuts() {
  constexpr double kGain = 0.3;
  std::size_t j = 1;
  for (std::size_t i = 1; i < now_.size(); ++i) {
    if (!now_[i].cut_before || now_[i].held) continue;
    while (j < above_.size() && above_[j].s_high < now_[i].s_low) ++j;
    for (const std::size_t k : {j, j + 1}) {
      if (k >= above_.size() || !above_[k].cut_before || above_[k].patch != now_[i].patch) continue;
      if (above_[k - 1].patch != now_[i - 1].patch) continue;
      now_[i].drift = above_[k].drift + kGain * (now_[i].cut.s - above_[k].cut.s - above_[k].drift);
      break;
    }
  }
}

// Patches that go on side by side touch along most of the smaller stretch; what stands askew on a wall touches with a corner.
bool PatchGrower::touches_askew(const Contact& contact) const {
  constexpr double kMost = 0.5;
  const auto columns = [&](const Stretch& t) { return (t.s_high - t.s_low) / pitch_ + 1.0; };
  return contact.open < kMost * std::min(columns(now_[contact.stretch]), columns(above_[contact.above]));
}

// A wide stretch that touches the one before by less than half lies behind a border: where rows begin to cut it on both sides,
// the curve that bounds it may pass a row later at its ends.
bool PatchGrower::begins_anew(const Contact& best) const {
  const Stretch& t = now_[best.stretch];
  return (t.s_high - t.s_low) / pitch_ + 1.0 >= kWide && touches_askew(best);
}

// Unites the stretches of this row with those of the row before.
void PatchGrower::link(const Sampling& sampling, FeatureReport& report) {
  // The widest open contact gives a stretch its patch.
  auto contact = contacts_.begin();
  for (std::size_t i = 0; i < now_.size(); ++i) {
    const Contact* best = nullptr;
    for (; contact != contacts_.end() && contact->stretch == i; ++contact)
      if (best == nullptr || contact->open > best->open) best = &*contact;
    now_[i].patch = best != nullptr && !begins_anew(*best) ? best->patch : graph_.create(row_number_);
  }
  for (const Contact& c : contacts_) {
    const std::uint32_t own = graph_.find(now_[c.stretch].patch), other = graph_.find(c.patch);
    if (own == other || touches_askew(c)) continue;
    if (is_leak(own, other, sampling)) {
      for (const auto& [a, b] : {std::pair{own, other}, std::pair{other, own}}) {
        graph_.node(a).borders[b].contact += sampling.spacing;
        graph_.node(a).doubtful = true;
      }
      continue;
    }
    graph_.unite(own, other, report.merges);
  }
}

// Sums and borders of the stretches of the row.
void PatchGrower::measure(const PatchRow& row, const Sampling& sampling) {
  for (std::size_t i = 0; i < now_.size(); ++i) {
    Stretch& t = now_[i];
    t.patch = graph_.find(t.patch);
    t.node = &graph_.node(t.patch);
    PatchNode& n = *t.node;
    n.sums.add({row.s, row.w, t.first, t.last - t.first + 1}, row.c);
    n.last_row = row_number_;
    n.s_low = std::min(n.s_low, t.s_low);
    n.s_high = std::max(n.s_high, t.s_high);
    n.c_low = std::min(n.c_low, row.c);
    n.c_high = std::max(n.c_high, row.c);
    if (i + 1 == now_.size()) n.open += sampling.spacing;
    if (i == 0) {
      n.open += sampling.spacing;
      continue;
    }
    const std::uint32_t left = now_[i - 1].patch;
    if (!t.cut_before) {
      if (left == t.patch) continue; // samples that are missing inside a patch
      n.open += sampling.spacing;
      now_[i - 1].node->open += sampling.spacing;
      continue;
    }
    if (t.held) continue;
    const std::uint32_t before = now_[i - 1].last;
    edge_.note(t.at_hand(), now_[i - 1].at_hand(), t.cut, sampling.spacing, {row.s[t.first], row.c, row.w[t.first]},
               {row.s[before], row.c, row.w[before]});
  }
  edge_.flush();
}

// Borders across the lines: columns that are cut, with the patch on either side.
void PatchGrower::measure_across(const PatchRow& row) {
  std::size_t a = 0, b = 0;
  for (const Cut& cut : across_) {
    const std::uint32_t before = last_row_.at(cut.column), now = row.at(cut.column);
    if (before == PatchRow::kNoSample || now == PatchRow::kNoSample) continue;
    while (above_[a].last < before) ++a;
    while (now_[b].last < now) ++b;
    edge_.note(now_[b].at_hand(), above_[a].at_hand(), cut, pitch_, {row.s[now], row.c, row.w[now]},
               {last_row_.s[before], last_row_.c, last_row_.w[before]});
  }
  edge_.flush();
}

// Columns beyond the ends of one of two rows, where the other goes on. Samples that are missing inside a row are no end.
void PatchGrower::measure_ends(const PatchRow& row) {
  const auto patch_of = [](const std::vector<Stretch>& stretches, std::uint32_t sample) {
    return std::lower_bound(stretches.begin(), stretches.end(), sample,
                            [](const Stretch& t, std::uint32_t k) { return t.last < k; })
        ->patch;
  };
  const auto look = [&](std::int64_t column) {
    const std::uint32_t before = last_row_.at(column), now = row.at(column);
    if ((before == PatchRow::kNoSample) == (now == PatchRow::kNoSample)) return;
    graph_.node(now != PatchRow::kNoSample ? patch_of(now_, now) : patch_of(above_, before)).open += pitch_;
  };
  const double left = std::max(row.s.front(), last_row_.s.front()), right = std::min(row.s.back(), last_row_.s.back());
  const auto inner = static_cast<std::int64_t>(std::ceil(left / pitch_));
  const std::int64_t end = std::max(row.end_column(), last_row_.end_column());
  for (std::int64_t j = std::min(row.first_column, last_row_.first_column); j < std::min(inner, end); ++j) look(j);
  for (auto j = std::max(inner, static_cast<std::int64_t>(std::floor(right / pitch_)) + 1); j < end; ++j) look(j);
}

void PatchGrower::queue_runs(const PatchRow& row) {
  const bool turned = row.number(0) > row.number(row.s.size() - 1); // scanned backwards
  for (std::size_t i = 0; i < now_.size(); ++i) {
    const Stretch& t = now_[turned ? now_.size() - 1 - i : i];
    PatchRun run;
    run.line = row.line;
    const std::uint32_t x = row.number(t.first), y = row.number(t.last);
    run.first = std::min(x, y);
    run.count = std::max(x, y) - run.first + 1;
    run.patch = t.patch;
    closer_.add(run, row_number_);
  }
}

void PatchGrower::assign(const PatchRow& row, const PatchRow* next, Cuts& cuts, const Sampling& sampling,
                         FeatureReport& report) {
  cuts.at(last_c_, row.c, pitch_, in_line_, across_);
  if (!above_.empty() && row.c - last_c_ > kFar * sampling.spacing) end_rows();
  const bool begins = above_.empty();
  jumps_.in_line(row, sampling, in_line_);
  if (!begins) jumps_.across(last_row_, row, next, pitch_, sampling, across_);
  split(row);
  find_contacts();
  if (hold_borders(row, sampling)) find_contacts();
  link(sampling, report);
  for (Stretch& t : above_) {
    t.patch = graph_.find(t.patch);
    t.node = &graph_.node(t.patch);
  }
  follow_cuts();
  measure(row, sampling);
  if (begins) {
    for (const Stretch& t : now_) graph_.node(t.patch).open += t.s_high - t.s_low;
  } else {
    measure_across(row);
    measure_ends(row);
  }
  queue_runs(row);
  find_holes(row, sampling);
  holes_.follow(graph_);
  graph_.resolve(row_number_);
  std::swap(above_, now_);
  last_c_ = row.c;
  ++row_number_;
}

// Beside samples that are missing; ids of both rows are those in force.
void PatchGrower::find_holes(const PatchRow& row, const Sampling& sampling) {
  if (!holes_.wants(row)) return;
  const auto fill = [](const std::vector<Stretch>& stretches, std::vector<PatchSpan>& spans) {
    spans.clear();
    for (const Stretch& t : stretches) spans.push_back({t.last, t.patch});
  };
  fill(above_, spans_above_);
  fill(now_, spans_now_);
  holes_.add({above_.empty() ? nullptr : &last_row_, spans_above_}, {&row, spans_now_}, row_number_, pitch_, sampling);
}

// Nothing follows the last row.
void PatchGrower::end_rows() {
  for (const Stretch& t : above_) graph_.node(t.patch).open += t.s_high - t.s_low;
  above_.clear();
  jumps_.restart();
  holes_.end_rows();
}

void PatchGrower::close(bool is_complete, const Sampling& sampling, FeatureReport& report) {
  const PatchProgress progress{row_number_, last_row_.s.size(), is_complete};
  closer_.shut(graph_, progress, report);
  for (Stretch& t : above_) t.patch = graph_.find(t.patch);
  holes_.follow(graph_);
  graph_.resolve(row_number_);
  closer_.tell_runs(graph_, progress, report);
  holes_.tell(graph_, progress.rows, is_complete, sampling, found_holes_);
  closer_.publish(graph_, progress, sampling, report);
}

void PatchGrower::advance(double complete, Cuts& cuts, const Sampling& sampling, FeatureReport& report) {
  auto row = rows_.begin();
  for (; row != rows_.end() && row->c <= complete; ++row) {
    assign(*row, std::next(row) != rows_.end() ? &*std::next(row) : nullptr, cuts, sampling, report);
    spare_.push_back(std::move(last_row_));
    last_row_ = std::move(*row);
  }
  rows_.erase(rows_.begin(), row);
  close(false, sampling, report);
}

void PatchGrower::finish(const Sampling& sampling, FeatureReport& report) {
  end_rows();
  close(true, sampling, report);
}

void PatchGrower::restart() {
  last_c_ = -1e300;
}

} // namespace scansion
