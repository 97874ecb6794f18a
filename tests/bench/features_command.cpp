// scansion_bench features: feature lines and patches against the ground truth, of files or of a sweep over scenes.
// SPDX-License-Identifier: Apache-2.0
#include "sim/truth/truth_json.hpp"
#include "tests/bench/commands.hpp"
#include "tests/bench/feature_cases.hpp"
#include "tests/score/found_file.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <map>

namespace scansion::bench {
namespace {

using score::Score;

/// Means over scans; angle classes by length.
struct Mean {
  double count = 0.0, with_patches = 0.0;
  Score sum;
  double stage_ns = 0.0;

  Mean() {
    for (const auto member : kMembers) sum.*member = 0.0;
  }
  void add(const Score& s, double ns) {
    count += 1.0;
    stage_ns += ns;
    for (const auto member : kMembers) sum.*member += s.*member;
    for (std::size_t k = 0; k < score::kAngleClasses; ++k) {
      sum.angle_mm[k] += s.angle_mm[k];
      sum.angle_found_mm[k] += s.angle_found_mm[k];
    }
    for (std::size_t k = 0; k < kFormKinds; ++k) {
      sum.forms[k].there += s.forms[k].there;
      sum.forms[k].named += s.forms[k].named;
      sum.forms[k].said += s.forms[k].said;
      sum.forms[k].right += s.forms[k].right;
    }
    if (!s.has_patches) return;
    with_patches += 1.0;
    sum.rand_index += s.rand_index;
  }
  [[nodiscard]] double of(double Score::*member) const noexcept { return count > 0.0 ? sum.*member / count : 0.0; }
  [[nodiscard]] double rand_index() const noexcept { return with_patches > 0.0 ? sum.rand_index / with_patches : 0.0; }
  [[nodiscard]] double angle(std::size_t k) const noexcept {
    return sum.angle_mm[k] > 0.0 ? sum.angle_found_mm[k] / sum.angle_mm[k] : 1.0;
  }

  static constexpr std::array kMembers{
      &Score::true_mm,          &Score::found_mm,    &Score::false_mm,        &Score::precision,
      &Score::strict_precision, &Score::recall,      &Score::polarity_recall, &Score::f1,
      &Score::position_mean,    &Score::position_95, &Score::longest,         &Score::fragments};
};

const std::vector<std::string> kColumns{"scans", "F1",      "strict", "precision", "recall", "polarity",    "pos",
                                        "pos95", "longest", "pieces", "rand",      "forms",  "false forms", "false mm",
                                        "0-20",  "20-40",   "40-60",  "60-80",     "80-90",  "ns/pt"};

std::vector<Cell> row_of(const std::string& name, const Mean& m) {
  std::vector<Cell> cells{name};
  for (const auto member : {&Score::f1, &Score::strict_precision, &Score::precision, &Score::recall, &Score::polarity_recall,
                            &Score::position_mean, &Score::position_95, &Score::longest}) {
    cells.emplace_back(Figure{m.of(member), 3});
  }
  cells.emplace_back(Figure{m.of(&Score::fragments), 2});
  cells.push_back(m.with_patches > 0.0 ? Cell(Figure{m.rand_index(), 3}) : Cell());
  const score::FormCount forms = score::sum_of(m.sum.forms);
  cells.emplace_back(std::to_string(forms.named) + "/" + std::to_string(forms.there));
  cells.emplace_back(std::to_string(forms.said - forms.right));
  cells.emplace_back(Figure{m.of(&Score::false_mm), 1});
  for (std::size_t k = 0; k < score::kAngleClasses; ++k) {
    cells.push_back(m.sum.angle_mm[k] > 0.0 ? Cell(Figure{m.angle(k), 2}) : Cell());
  }
  cells.emplace_back(Figure{m.stage_ns / std::max(1.0, m.count), 1});
  return cells;
}

Result<std::string> content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return fail(Errc::usage, path, ": cannot be read");
  return std::string(std::istreambuf_iterator<char>(in), {});
}

Result<void> judge_files(const FeatureOptions& o, Report& report) {
  SCANSION_TRY(truth_text, content(o.truth));
  SCANSION_TRY(truth, parse_truth(truth_text));
  score::Found found;
  SCANSION_TRY(lines_text, content(o.lines));
  SCANSION_TRY(lines, score::parse_lines_text(lines_text));
  found.lines = std::move(lines);
  if (!o.patches.empty()) {
    SCANSION_TRY(patches_text, content(o.patches));
    SCANSION_TRY(patches, score::parse_patches_text(patches_text, truth));
    found.patches = std::move(patches);
  }
  Mean mean;
  mean.add(score::judge(truth, found), 0.0);
  Table table("Feature lines of " + o.lines, kColumns);
  table.add(row_of(truth.scene, mean));
  report.print(table);
  return success();
}

std::string name_of(const FeatureCase& one) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%s %.2g mm %.0f um %.0f deg %s", one.scene.c_str(), one.pitch_mm, one.noise_um,
                one.direction_deg, one.fault.c_str());
  return text.data();
}

/// Means by one property of the scans, each under its value.
using Means = std::map<std::string, Mean>;

/// Estimates of backlash against the truth, in um and in pitches.
struct BacklashError {
  double scans = 0.0, stated = 0.0, taken_off = 0.0;
  double sum_um = 0.0, worst_um = 0.0, worst_pitches = 0.0, worst_sigmas = 0.0, worst_left = 0.0;

  void add(const FeatureCase& one, const std::optional<Backlash>& found) {
    scans += 1.0;
    const double um = one.backlash_um;
    worst_left = std::max(worst_left, std::abs((found ? 1e3 * found->taken_off_mm : 0.0) - um) / (1e3 * one.pitch_mm));
    if (!found) return;
    stated += 1.0;
    if (found->taken_off_mm != 0.0) taken_off += 1.0;
    const double error = std::abs(1e3 * found->mm - um);
    sum_um += error;
    worst_um = std::max(worst_um, error);
    worst_pitches = std::max(worst_pitches, error / (1e3 * one.pitch_mm));
    worst_sigmas = std::max(worst_sigmas, error / (1e3 * found->deviation_mm));
  }
};

struct Sweep {
  Means by_scene, by_sampling, by_fault;
  std::map<std::string, BacklashError> backlash;
  Mean all;
};

/// Of scans of the part without a feature.
struct Smooth {
  double worst_mm = 0.0, forms = 0.0, scans = 0.0;
};

Result<void> run_one(const FeatureCase& one, const FeatureSettings& settings, Sweep& sweep, Table& rows) {
  SCANSION_TRY(outcome, run_case(one, settings));
  std::array<char, 48> sampling{};
  std::snprintf(sampling.data(), sampling.size(), "%.2g mm, %2.0f um", one.pitch_mm, one.noise_um);
  for (Mean* mean : {&sweep.by_scene[one.scene], &sweep.by_sampling[sampling.data()], &sweep.by_fault[one.fault], &sweep.all}) {
    mean->add(outcome.score, outcome.stage_ns);
  }
  for (const std::string& of : {std::string(sampling.data()), std::string("all")})
    sweep.backlash[of].add(one, outcome.backlash);
  Mean alone;
  alone.add(outcome.score, outcome.stage_ns);
  rows.add(row_of(name_of(one), alone));
  return success();
}

void print_means(const Sweep& sweep, Report& report) {
  Table table("Feature lines and patches against the truth, means", kColumns,
              "Shares by length; pos in units of the larger of pitch and spacing; strict: lines found twice are wrong once.");
  for (const Means* means : {&sweep.by_scene, &sweep.by_sampling, &sweep.by_fault}) {
    for (const auto& [name, mean] : *means) table.add(row_of(name, mean));
  }
  table.add(row_of("all", sweep.all));
  report.print(table);
}

void print_backlash(const Sweep& sweep, Report& report) {
  Table table("Backlash against the truth",
              {"scans", "of", "stated", "taken off", "error um", "worst um", "worst pitches", "worst sigmas", "left pitches"},
              "Of the estimates when scans end; left: the most that is not taken off, or too much.");
  for (const auto& [name, e] : sweep.backlash) {
    table.add({name, Figure{e.scans, 0}, Figure{e.stated, 0}, Figure{e.taken_off, 0},
               Figure{e.stated > 0.0 ? e.sum_um / e.stated : 0.0, 1}, Figure{e.worst_um, 1}, Figure{e.worst_pitches, 2},
               Figure{e.worst_sigmas, 1}, Figure{e.worst_left, 2}});
  }
  report.print(table);
}

double share(std::uint32_t part, std::uint32_t whole) noexcept {
  return whole == 0 ? 1.0 : static_cast<double>(part) / whole;
}

void print_forms(const Sweep& sweep, Report& report) {
  Table table("Form features against the truth", {"kind", "there", "named", "share", "said", "right", "share right"},
              "Named: with its kind and on its largest patch; right: of those said to be there; in pieces: right / named.");
  const auto add = [&](const std::string& kind, const score::FormCount& count) {
    if (count.there + count.said == 0) return;
    table.add({kind, std::to_string(count.there), std::to_string(count.named), Figure{share(count.named, count.there), 3},
               std::to_string(count.said), std::to_string(count.right), Figure{share(count.right, count.said), 3}});
  };
  for (std::size_t k = 0; k < kFormKinds; ++k) add(std::string(name(static_cast<FormKind>(k))), sweep.all.sum.forms[k]);
  add("all", score::sum_of(sweep.all.sum.forms));
  report.print(table);
}

void print_judgement(const Sweep& sweep, const Smooth& smooth, Report& report) {
  Table table("What it must reach", {"figure", "value", "must", "good", "mark"});
  const auto high = [&](const std::string& name, double value, Bar bar) {
    std::vector<Cell> cells{name, Figure{value, 3}};
    report.judge_high(cells, value, bar);
    table.add(std::move(cells));
  };
  const auto low = [&](const std::string& name, double value, Bar bar) {
    std::vector<Cell> cells{name, Figure{value, 3}};
    report.judge(cells, value, bar);
    table.add(std::move(cells));
  };
  high("F1", sweep.all.of(&Score::f1), {0.92, 0.96});
  high("recall", sweep.all.of(&Score::recall), {0.94, 0.96});
  high("strict precision", sweep.all.of(&Score::strict_precision), {0.91, 0.96});
  high("polarity recall", sweep.all.of(&Score::polarity_recall), {0.93, 0.95});
  low("position, mean", sweep.all.of(&Score::position_mean), {0.45, 0.3});
  high("longest piece", sweep.all.of(&Score::longest), {0.65, 0.8});
  const char* classes[] = {"0-20", "20-40", "40-60", "60-80", "80-90"};
  for (std::size_t k = 0; k < score::kAngleClasses; ++k) {
    high(std::string("recall at ") + classes[k] + " degrees", sweep.all.angle(k), {0.90, 0.95});
  }
  if (sweep.all.with_patches > 0.0) high("adjusted Rand index", sweep.all.rand_index(), {0.78, 0.90});
  const score::FormCount forms = score::sum_of(sweep.all.sum.forms);
  high("forms named", share(forms.named, forms.there), {0.75, 0.90});
  high("forms rightly named", share(forms.right, forms.said), {0.80, 0.90});
  low("false mm on the smooth part, worst", smooth.worst_mm, {40.0, 5.0});
  low("forms a scan of the smooth part", smooth.forms / std::max(1.0, smooth.scans), {0.2, 0.05});
  const auto clean = sweep.by_fault.find("clean");
  if (clean != sweep.by_fault.end()) {
    for (const auto& [fault, mean] : sweep.by_fault) {
      if (fault != "clean") low("F1 lost by " + fault, clean->second.of(&Score::f1) - mean.of(&Score::f1), {0.05, 0.03});
    }
  }
  report.print(table);
}

FeatureOptions completed(FeatureOptions o) {
  if (o.scenes.empty()) o.scenes = small_parts();
  if (std::ranges::find(o.faults, "all") != o.faults.end()) {
    o.faults = {"clean", "dirty", "tilt", "zigzag", "correlated", "outliers", "dropouts", "missing", "jitter"};
  }
  if (o.shorter) {
    o.scenes.resize(std::min<std::size_t>(o.scenes.size(), 2));
    o.pitches = {0.5};
    o.noises.resize(1);
    o.directions.resize(1);
  }
  return o;
}

} // namespace

Result<void> run_features(const FeatureOptions& asked, Report& report) {
  if (!asked.truth.empty() || !asked.lines.empty()) {
    if (asked.truth.empty() || asked.lines.empty()) return fail(Errc::usage, "features: --truth and --found belong together");
    return judge_files(asked, report);
  }
  const FeatureOptions o = completed(asked);
  FeatureSettings settings;
  if (o.paper) settings.linking = Linking::paper;
  if (o.correct) settings.backlash = BacklashUse::correct;
  Sweep sweep;
  Table rows("Feature lines and patches against the truth, every scan", kColumns);
  Smooth smooth;
  for (const double pitch : o.pitches) {
    for (const double noise : o.noises) {
      for (const double direction : o.directions) {
        for (const std::string& fault : o.faults) {
          for (const std::string& scene : o.scenes) {
            SCANSION_TRY(run_one({scene, pitch, noise, direction, fault, o.backlash_um}, settings, sweep, rows));
          }
          SCANSION_TRY(featureless, run_case({"smooth", pitch, noise, direction, fault, o.backlash_um}, settings));
          smooth.worst_mm = std::max(smooth.worst_mm, featureless.score.false_mm);
          smooth.forms += score::sum_of(featureless.score.forms).said;
          smooth.scans += 1.0;
        }
      }
    }
  }
  if (o.rows) report.print(rows);
  print_means(sweep, report);
  print_forms(sweep, report);
  if (o.correct || o.backlash_um != 0.0) print_backlash(sweep, report);
  print_judgement(sweep, smooth, report);
  return success();
}

} // namespace scansion::bench
