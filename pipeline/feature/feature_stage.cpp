// Groups to profiles to curves to feature lines.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/feature_stage.hpp"

#include "pipeline/feature/line/junctions.hpp"
#include "pipeline/feature/line/publisher.hpp"
#include "pipeline/feature/line_finder.hpp"
#include "pipeline/feature/patch/patch_grower.hpp"
#include "pipeline/feature/profile/averaging.hpp"
#include "pipeline/feature/profile/backlash_correction.hpp"
#include "pipeline/feature/profile/rises.hpp"
#include "pipeline/feature/profile/spikes.hpp"
#include "pipeline/feature/rise_limit.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {

namespace {

Vector3 origin_mm(const std::array<std::int64_t, 3>& origin, double resolution) {
  return {static_cast<double>(origin[0]) * resolution, static_cast<double>(origin[1]) * resolution,
          static_cast<double>(origin[2]) * resolution};
}

/// A line with points and distances of its own.
class KeptLine {
public:
  explicit KeptLine(const RawLine& line) : line_(line), distance_(line.distance.begin(), line.distance.end()) {
    line_.distance = distance_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      xyz_[axis].assign(line.xyz[axis].begin(), line.xyz[axis].end());
      line_.xyz[axis] = xyz_[axis];
    }
  }
  KeptLine(const KeptLine&) = delete;
  KeptLine& operator=(const KeptLine&) = delete;
  KeptLine(KeptLine&&) = default;
  KeptLine& operator=(KeptLine&&) = default;
  ~KeptLine() = default;

  [[nodiscard]] const RawLine& raw() const noexcept { return line_; }

private:
  RawLine line_;
  std::array<std::vector<std::int32_t>, 3> xyz_;
  std::vector<double> distance_;
};

} // namespace

struct FeatureStage::Impl {
  Impl(Rational resolution_mm, const std::array<std::int64_t, 3>& counts, const FeatureSettings& settings)
      : resolution(resolution_mm.value()), estimator(settings, resolution_mm.value()),
        pair_estimator(averaged(settings), resolution_mm.value()), ranker(resolution_mm), finder(settings),
        publisher(origin_mm(counts, resolution)), origin(origin_mm(counts, resolution)), backlash(settings.backlash) {}

  static void take(const LineGroup& group, const ScanLine& line, std::span<const double> distance, RawLine& out);
  void begin(FeatureReport& report);
  void learn_backlash();
  void clean(const Sampling& sampling);
  /// False: the line is left out.
  [[nodiscard]] bool process(const RawLine& line, FeatureReport& report);
  void publish(FeatureReport& report);
  void publish_holes(const Sampling& sampling, FeatureReport& report);
  /// The sampling in which features are looked for.
  [[nodiscard]] Sampling looked_at() const { return averages ? pair_estimator.value() : estimator.value(); }

  double resolution;
  FrameFinder frame_finder;
  std::optional<Frame> frame;
  std::vector<KeptLine> waiting; ///< the first lines, until the frame is known
  RawLine raw;
  Profile profile, pairs;
  std::vector<std::uint32_t> scratch;
  std::optional<ColumnScale> scale, pair_scale; ///< fixed by the first line
  bool averages = false;                        ///< features are looked for in pairs of samples
  SamplingEstimator estimator, pair_estimator;  ///< noise that hangs together falls less in pairs than it should
  ProfileRanker ranker;
  LineFinder finder;
  Junctions junctions;
  Publisher publisher;
  Vector3 origin;
  std::optional<PatchGrower> patches;
  std::vector<Curve> curves;
  AlphaSet alpha;
  BacklashCorrection backlash;
  std::optional<double> last_c;
  std::uint64_t refused = 0; ///< lines at the place of the line before
};

// The points of a line stand one after the other in its group, run by run.
void FeatureStage::Impl::take(const LineGroup& group, const ScanLine& line, std::span<const double> distance, RawLine& out) {
  const std::span<const Run> runs = group.runs_of(line);
  out.index = line.index;
  out.ends.clear();
  std::uint32_t n = 0;
  for (const Run& run : runs) out.ends.push_back(n += run.count);
  const std::size_t first = runs.empty() ? 0 : runs.front().first;
  out.distance = distance.subspan(first, n);
  for (std::size_t axis = 0; axis < 3; ++axis) out.xyz[axis] = std::span(group.xyz[axis]).subspan(first, n);
}

void FeatureStage::Impl::begin(FeatureReport& report) {
  frame = frame_finder.frame();
  patches.emplace(*frame, origin);
  finder.set_lean(std::hypot(frame->up[0], frame->up[1]));
  // The sampling is wanted before the first line is searched.
  for (const KeptLine& line : waiting) {
    make_profile(line.raw(), resolution, *frame, profile);
    estimator.add(profile);
  }
  averages = wants_averaging(estimator.value());
  for (const KeptLine& line : waiting) {
    if (!averages) break;
    make_profile(line.raw(), resolution, *frame, profile);
    average_pairs(profile, estimator.value(), ranker, pairs);
    pair_estimator.add(pairs);
  }
  if (backlash.corrects()) learn_backlash();
  for (const KeptLine& line : waiting)
    if (process(line.raw(), report)) patches->hold(profile);
  waiting.clear();
}

// Before the first line is searched for good: a backlash of some pitches tears every line that would begin.
void FeatureStage::Impl::learn_backlash() {
  Detector detector;
  std::vector<FeaturePoint> points;
  for (const KeptLine& line : waiting) {
    make_profile(line.raw(), resolution, *frame, profile);
    if (profile.size() < 2) continue;
    clean(estimator.value());
    const Profile& searched = averages ? pairs : profile;
    detector.detect(searched, looked_at(), points);
    backlash.learn(searched, points, looked_at());
  }
  backlash.end_of_learning(looked_at());
}

// What is made of places and heights before anything is searched; the pairs too, where they are what is searched.
void FeatureStage::Impl::clean(const Sampling& sampling) {
  note_rises(profile, least_rise(sampling), scratch);
  clean_spikes(profile, sampling.noise, averages ? nullptr : &ranker);
  if (!scale) scale = {sampling.pitch, profile.w.front()};
  stand(profile, *scale);
  if (!averages) return;
  average_pairs(profile, sampling, ranker, pairs);
  note_rises(pairs, least_rise(looked_at()), scratch);
  if (!pair_scale) pair_scale = {looked_at().pitch, pairs.w.front()};
  stand(pairs, *pair_scale);
}

bool FeatureStage::Impl::process(const RawLine& line, FeatureReport& report) {
  constexpr double kSamePlace = 0.3; // spacings
  make_profile(line, resolution, *frame, profile);
  if (profile.size() < 2) return false;
  const Sampling sampling = estimator.value();
  if (last_c && profile.c < *last_c - kSamePlace * sampling.spacing) {
    finder.finish(looked_at(), FeatureEnd::gap, curves);
    publish(report);
    patches->finish(sampling, report);
    publish_holes(sampling, report);
    patches->restart();
    finder.cuts().restart();
    junctions.restart();
    backlash.restart();
  } else if (last_c && profile.c - *last_c < kSamePlace * sampling.spacing) {
    ++refused;
    return false;
  }
  last_c = profile.c;
  backlash.apply(profile);
  clean(sampling);
  const Profile& searched = averages ? pairs : profile;
  finder.add(searched, looked_at(), curves);
  backlash.add(searched, finder.points(), looked_at(), report);
  junctions.add_row(profile);
  // By lines and not by groups: what is found must not depend on how lines are grouped.
  if (finder.has_settled()) publish(report);
  return true;
}

void FeatureStage::Impl::publish(FeatureReport& report) {
  const Sampling sampling = estimator.value();
  for (Curve& curve : curves) {
    const bool piece = curve.front.seam || curve.back.seam;
    if (!piece && is_shorter(curve, sampling.limits.shortest_line)) continue;
    junctions.meet(curve, sampling);
    report.lines.push_back(publisher.publish(curve, *frame, sampling, alpha));
  }
  curves.clear();
  patches->advance(finder.cuts_complete(), finder.cuts(), sampling, report);
  publish_holes(sampling, report);
}

// Each with the feature line around it.
void FeatureStage::Impl::publish_holes(const Sampling& sampling, FeatureReport& report) {
  for (const FoundHole& hole : patches->holes()) {
    const HoleOutline& outline = hole.outline;
    FeatureLine& rim = report.lines.emplace_back(publisher.publish(outline, finder.new_id(), *frame, sampling));
    HoleSize size;
    size.middle = publisher.position(*frame, outline.s, outline.w, outline.c);
    size.along_mm = outline.s_high - outline.s_low;
    size.across_mm = outline.c_high - outline.c_low;
    size.area_mm2 = outline.area;
    size.rim = rim.id;
    report.forms.push_back({FormKind::hole, {hole.patch}, hole.confidence, size});
  }
  patches->holes().clear();
}

FeatureStage::FeatureStage(const Lattice& lattice, const FeatureSettings& settings)
    : impl_(std::make_unique<Impl>(resolution_mm(lattice).value(), lattice.origin, settings)) {}
FeatureStage::~FeatureStage() = default;
FeatureStage::FeatureStage(FeatureStage&&) noexcept = default;
FeatureStage& FeatureStage::operator=(FeatureStage&&) noexcept = default;

void FeatureStage::set_levels(const AlphaSet& alpha) {
  impl_->alpha = alpha;
}

void FeatureStage::add(const LineGroup& group, std::span<const double> distance, FeatureReport& report) {
  Impl& m = *impl_;
  for (const ScanLine& line : group.lines) {
    m.take(group, line, distance, m.raw);
    if (m.frame) {
      const bool taken = m.process(m.raw, report);
      m.estimator.add(m.profile);
      if (m.averages) m.pair_estimator.add(m.pairs);
      if (taken) m.patches->hold(m.profile);
      continue;
    }
    if (m.raw.distance.empty()) continue; // says nothing about the frame, and lines may stay empty for ever
    m.frame_finder.add(m.raw.xyz, m.resolution);
    m.waiting.emplace_back(m.raw);
    if (m.frame_finder.lines() >= FrameFinder::kLines) m.begin(report);
  }
}

void FeatureStage::skip(const Gap&) {}

void FeatureStage::finish(FeatureReport& report) {
  Impl& m = *impl_;
  if (!m.frame && m.frame_finder.lines() > 0) m.begin(report);
  if (!m.frame) return;
  m.finder.finish(m.looked_at(), FeatureEnd::open, m.curves);
  m.publish(report);
  m.patches->finish(m.estimator.value(), report);
  m.publish_holes(m.estimator.value(), report);
  m.backlash.finish(m.looked_at(), report);
}

} // namespace scansion
