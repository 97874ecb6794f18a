// Scans of scenes through the feature stage, judged against their ground truth.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/feature_cases.hpp"

#include "pipeline/feature/feature_stage.hpp"
#include "pipeline/feature/line/join_pieces.hpp"
#include "pipeline/pipeline.hpp"
#include "sim/scene/catalog.hpp"
#include "sim/truth/scan_truth.hpp"

#include <ctime>
#include <map>

namespace scansion::bench {
namespace {

/// A line as a driver would hand it over; false for a line without points.
bool fill(LineBuffer& buffer, const SceneLine& line) {
  buffer.clear();
  for (const ScenePoint& point : line.points) {
    if (!point.is_there()) continue;
    buffer.xyz[0].push_back(point.x);
    buffer.xyz[1].push_back(point.y);
    buffer.xyz[2].push_back(point.z);
  }
  if (buffer.points() == 0) return false;
  buffer.runs.push_back({0, static_cast<std::uint32_t>(buffer.points()), 0});
  return true;
}

double thread_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e9 + static_cast<double>(now.tv_nsec);
}

/// Feeds lines to the stage as the pipeline does and keeps what it reports.
class StageRun {
public:
  explicit StageRun(const FeatureSettings& settings) : ranker_(Rational{1, 1000}), stage_(lattice(), settings) {}

  void add(const LineBuffer& line) {
    if (builder_.must_close_before(line)) close();
    builder_.add(line);
    counts_.push_back(line.points());
    points_ += line.points();
  }
  void finish() {
    if (!builder_.empty()) close();
    const double begin = thread_ns();
    stage_.finish(report_);
    ns_ += thread_ns() - begin;
  }
  [[nodiscard]] const FeatureReport& report() const noexcept { return report_; }
  [[nodiscard]] std::uint64_t points() const noexcept { return points_; }
  [[nodiscard]] double ns_per_point() const noexcept { return points_ == 0 ? 0.0 : ns_ / static_cast<double>(points_); }

  [[nodiscard]] score::Found found() const {
    score::Found found;
    for (const FeatureLine& line : join_pieces(report_.lines)) {
      auto& entry = found.lines.emplace_back();
      entry.type = line.type;
      for (const FeatureVertex& vertex : line.vertices) entry.points.push_back(vertex.position);
      if (line.closed_loop && !entry.points.empty()) entry.points.push_back(entry.points.front());
    }
    for (const std::size_t count : counts_) found.patches.emplace_back(count, score::kNoPatch);
    std::map<std::uint32_t, std::uint32_t> into;
    for (const PatchMerge& merge : report_.merges) into[merge.from] = merge.into;
    const auto root = [&](std::uint32_t patch) {
      for (auto next = into.find(patch); next != into.end(); next = into.find(patch)) patch = next->second;
      return patch;
    };
    for (const PatchRun& run : report_.runs) {
      auto& labels = found.patches.at(run.line);
      for (std::uint32_t k = run.first; k < run.first + run.count; ++k) labels.at(k) = root(run.patch);
    }
    found.forms = report_.forms;
    for (Form& form : found.forms) {
      for (std::uint32_t& patch : form.patches) patch = root(patch);
    }
    return found;
  }

private:
  static Lattice lattice() {
    Lattice lattice;
    lattice.resolution = Rational{1, 1000};
    return lattice;
  }
  void close() {
    builder_.take(group_);
    rank_group(ranker_, group_, ranks_);
    const double begin = thread_ns();
    stage_.add(group_, ranks_.distance, report_);
    ns_ += thread_ns() - begin;
  }

  GroupBuilder builder_;
  LineGroup group_;
  Ranker ranker_;
  GroupRanks ranks_;
  FeatureStage stage_;
  FeatureReport report_;
  std::vector<std::size_t> counts_;
  std::uint64_t points_ = 0;
  double ns_ = 0.0;
};

} // namespace

const std::vector<std::string>& small_parts() {
  static const std::vector<std::string> parts{"terraces", "channels", "cavity", "posts", "rails",
                                              "grooves",  "edges",    "dome",   "star",  "bracket"};
  return parts;
}

Result<ScanPlan> plan_of(const FeatureCase& one) {
  ScanPlan plan;
  plan.pitch_mm = one.pitch_mm;
  plan.spacing_mm = one.pitch_mm;
  plan.noise_um = one.noise_um;
  plan.direction_deg = one.direction_deg;
  const auto is = [&](const char* fault) { return one.fault == fault || one.fault == "dirty"; };
  if (is("correlated")) plan.correlated_mm = 2.0 * one.pitch_mm;
  if (is("outliers")) plan.outliers = 0.002;
  if (is("dropouts")) plan.dropouts = 0.02;
  if (is("missing")) plan.missing_lines = 0.02;
  if (is("jitter")) plan.jitter = 0.5;
  if (is("zigzag")) plan.zigzag = true;
  plan.backlash_um = one.backlash_um;
  if (one.backlash_um != 0.0) plan.zigzag = true;
  if (one.fault == "tilt") plan.tilt_deg = 20.0;
  const bool known = one.fault == "clean" || one.fault == "tilt" || plan.zigzag || plan.jitter > 0.0 ||
                     plan.correlated_mm > 0.0 || plan.outliers > 0.0 || plan.dropouts > 0.0 || plan.missing_lines > 0.0;
  if (!known) return fail(Errc::usage, "there is no fault '", one.fault, "'");
  return plan;
}

Result<FeatureOutcome> run_case(const FeatureCase& one, const FeatureSettings& settings) {
  SCANSION_TRY(plan, plan_of(one));
  SCANSION_TRY(scene, make_scene(one.scene));
  SCANSION_TRY(truth, ScanTruth::create(scene, plan));
  SCANSION_TRY(scanner, SceneScanner::create(std::move(scene), plan));
  StageRun run(settings);
  LineBuffer buffer;
  for (SceneLine line; scanner.next(line);) {
    truth.add(line);
    if (fill(buffer, line)) run.add(buffer);
  }
  run.finish();
  const Truth there = truth.finish();
  FeatureOutcome outcome;
  outcome.score = score::judge(there, run.found());
  outcome.backlash = run.report().backlash;
  outcome.points = run.points();
  outcome.lines = run.report().lines.size();
  outcome.patches = run.report().patches.size();
  outcome.stage_ns = run.ns_per_point();
  return outcome;
}

} // namespace scansion::bench
