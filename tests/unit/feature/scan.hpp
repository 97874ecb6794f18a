// Scans of surfaces through the feature stage.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_stage.hpp"
#include "pipeline/pipeline.hpp"

#include <cmath>
#include <functional>
#include <optional>
#include <random>

namespace scansion {

/// Height in mm over x and y in mm; 0.1 mm from point to point and from line to line, counts of 1 um.
using Surface = std::function<double(double x, double y)>;

/// Is there nothing to measure?
using Nothing = std::function<bool(double x, double y)>;

/// Lines through ranking and the stage, in groups as the pipeline makes them; counts of 1 um.
class Feed {
public:
  explicit Feed(const FeatureSettings& settings = {}) : stage_(micrometres(), settings) {}

  void add(const LineBuffer& line, FeatureReport& report) {
    if (builder_.must_close_before(line)) close(report);
    builder_.add(line);
  }
  /// The lines so far are a group.
  void close(FeatureReport& report) {
    if (builder_.empty()) return;
    builder_.take(group_);
    rank_group(ranker_, group_, ranks_);
    stage_.add(group_, ranks_.distance, report);
  }
  void finish(FeatureReport& report) {
    close(report);
    stage_.finish(report);
  }

private:
  static Lattice micrometres() {
    Lattice lattice;
    lattice.resolution = Rational{1, 1000};
    return lattice;
  }

  FeatureStage stage_;
  Ranker ranker_{Rational{1, 1000}};
  GroupRanks ranks_;
  GroupBuilder builder_;
  LineGroup group_;
};

class Scan {
public:
  Scan(Surface surface, double noise_um, std::uint32_t lines, std::uint32_t points = 200)
      : surface_(std::move(surface)), noise_(0.0, noise_um), lines_(lines), points_(points) {}

  /// `share` of the points are missing.
  Scan& lose(double share) {
    missing_.emplace(share);
    return *this;
  }
  /// No points where there is nothing.
  Scan& open(Nothing nothing) {
    nothing_ = std::move(nothing);
    return *this;
  }
  /// Points of odd lines are told so far along the line from where they are.
  Scan& backlash(double mm) {
    backlash_ = mm;
    return *this;
  }
  Scan& seed(std::uint32_t value) {
    seed_ = value;
    return *this;
  }

  /// Runs it through the stage with `per_group` lines a group.
  FeatureReport run(std::uint32_t per_group, FeatureSettings settings = {}, bool zigzag = false) {
    FeatureReport report;
    run(per_group, settings, zigzag, report, [](std::uint32_t) {});
    return report;
  }
  /// `after(line)` follows each group; it may take from the report.
  void run(std::uint32_t per_group, FeatureSettings settings, bool zigzag, FeatureReport& report,
           const std::function<void(std::uint32_t)>& after) {
    std::mt19937 random(seed_);
    Feed feed(settings);
    for (std::uint32_t i = 0; i < lines_; ++i) {
      LineBuffer line;
      for (std::uint32_t k = 0; k < points_; ++k) {
        const std::uint32_t j = zigzag && i % 2 == 1 ? points_ - 1 - k : k;
        const double x = 0.1 * j, y = 0.1 * i, z = 1000 * surface_(i % 2 == 1 ? x - backlash_ : x, y) + noise_(random);
        if ((missing_ && (*missing_)(random)) || (nothing_ && nothing_(x, y))) continue;
        line.xyz[0].push_back(static_cast<std::int32_t>(std::lround(1000 * x)));
        line.xyz[1].push_back(static_cast<std::int32_t>(std::lround(1000 * y)));
        line.xyz[2].push_back(static_cast<std::int32_t>(std::lround(z)));
      }
      line.runs.push_back({0, static_cast<std::uint32_t>(line.points()), 0});
      feed.add(line, report);
      if ((i + 1) % per_group != 0) continue;
      feed.close(report);
      after(i);
    }
    feed.finish(report);
  }

private:
  Surface surface_;
  Nothing nothing_;
  std::normal_distribution<double> noise_;
  std::optional<std::bernoulli_distribution> missing_;
  std::uint32_t seed_ = 7;
  double backlash_ = 0.0;
  std::uint32_t lines_, points_;
};

} // namespace scansion
