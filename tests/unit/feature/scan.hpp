// Scans of surfaces through the feature stage.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_stage.hpp"
#include "pipeline/pipeline.hpp"

#include <cmath>
#include <functional>
#include <random>

namespace scansion {

/// Height in mm over x and y in mm; 0.1 mm from point to point and from line to line, counts of 1 um.
using Surface = std::function<double(double x, double y)>;

class Scan {
public:
  Scan(Surface surface, double noise_um, std::uint32_t lines, std::uint32_t points = 200)
      : surface_(std::move(surface)), noise_(0.0, noise_um), lines_(lines), points_(points) {}

  /// Runs it through the stage with `per_group` lines a group.
  FeatureReport run(std::uint32_t per_group, FeatureSettings settings = {}, bool zigzag = false) {
    FeatureReport report;
    run(per_group, settings, zigzag, report, [](std::uint32_t) {});
    return report;
  }
  /// `after(line)` follows each group; it may take from the report.
  void run(std::uint32_t per_group, FeatureSettings settings, bool zigzag, FeatureReport& report,
           const std::function<void(std::uint32_t)>& after) {
    std::mt19937 random(7);
    Lattice lattice;
    lattice.resolution = Rational{1, 1000};
    FeatureStage stage(lattice, settings);
    Ranker ranker(Rational{1, 1000});
    GroupRanks ranks;
    GroupBuilder builder;
    LineGroup group;
    const auto close = [&] {
      builder.take(group);
      rank_group(ranker, group, ranks);
      stage.add(group, ranks.distance, report);
    };
    for (std::uint32_t i = 0; i < lines_; ++i) {
      LineBuffer line;
      for (std::uint32_t k = 0; k < points_; ++k) {
        const std::uint32_t j = zigzag && i % 2 == 1 ? points_ - 1 - k : k;
        const double x = 0.1 * j, y = 0.1 * i;
        line.xyz[0].push_back(static_cast<std::int32_t>(std::lround(1000 * x)));
        line.xyz[1].push_back(static_cast<std::int32_t>(std::lround(1000 * y)));
        line.xyz[2].push_back(static_cast<std::int32_t>(std::lround(1000 * surface_(x, y) + noise_(random))));
      }
      line.runs.push_back({0, points_, 0});
      builder.add(line);
      if ((i + 1) % per_group != 0) continue;
      close();
      after(i);
    }
    if (!builder.empty()) close();
    stage.finish(report);
  }

private:
  Surface surface_;
  std::normal_distribution<double> noise_;
  std::uint32_t lines_, points_;
};

} // namespace scansion
