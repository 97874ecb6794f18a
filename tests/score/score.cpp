// How well found feature lines agree with the true ones.
// SPDX-License-Identifier: Apache-2.0
#include "tests/score/score.hpp"

#include "tests/score/point_grid.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace scansion::score {
namespace {

constexpr double kTolerance = 1.5;  // u
constexpr double kSampling = 0.25;  // u
constexpr double kShortCurve = 5.0; // u; shorter ones do not count for pieces
constexpr double kFragment = 0.05;  // of a curve
constexpr double kLeastWall = 0.09; // mm; a lower step need not be seen ...
constexpr double kWallSigmas = 8.0; // ... nor one lower than this many sigma of the noise
constexpr std::uint32_t kFree = 0xffffffffU;
constexpr double kDegrees = 57.295779513082320877;

bool convex(FeatureType type) noexcept {
  return type == FeatureType::convex || type == FeatureType::step_top || type == FeatureType::ridge;
}

struct Sample {
  Place at{};
  std::uint32_t line = 0;
  bool convex = false;
  bool optional = false;
  double angle = 0.0; // degrees to the scan lines
};

/// Samples of one kind of curve, `step` apart; those of one curve follow each other.
struct Samples {
  double step = 0.0;
  std::vector<Sample> all;
  std::vector<std::uint32_t> first; // of each curve; one more at the end

  void add(const std::vector<Place>& points, bool closed, Sample like) {
    like.line = static_cast<std::uint32_t>(first.size());
    first.push_back(static_cast<std::uint32_t>(all.size()));
    double left = 0.5 * step; // so that n samples stand for n steps of length
    const std::size_t sides = points.size() < 2 ? 0 : points.size() - (closed ? 0U : 1U);
    for (std::size_t k = 0; k < sides; ++k) {
      const Place& a = points[k];
      const Place& b = points[(k + 1) % points.size()];
      const double length = distance(a, b);
      for (; left <= length && length > 0.0; left += step) {
        Sample sample = like;
        for (std::size_t axis = 0; axis < 3; ++axis) sample.at[axis] = a[axis] + left / length * (b[axis] - a[axis]);
        sample.angle = kDegrees * std::atan2(b[1] - a[1], b[0] - a[0]);
        all.push_back(sample);
      }
      left -= length;
    }
  }
  void finish() { first.push_back(static_cast<std::uint32_t>(all.size())); }
  [[nodiscard]] std::size_t curves() const noexcept { return first.size() - 1; }
  [[nodiscard]] std::size_t size(std::size_t curve) const noexcept { return first[curve + 1] - first[curve]; }
};

double share(std::size_t part, std::size_t whole) noexcept {
  return whole == 0 ? 1.0 : static_cast<double>(part) / static_cast<double>(whole);
}

class LineJudge {
public:
  LineJudge(const Truth& truth, const Found& found)
      : u_(std::max(truth.pitch_mm, truth.spacing_mm)), direction_(truth.direction_deg), true_grid_(kTolerance * u_),
        found_grid_(kTolerance * u_) {
    true_.step = found_.step = kSampling * u_;
    const double least_wall = std::max(kLeastWall, kWallSigmas * truth.noise_um / 1000.0);
    for (const TrueCurve& curve : truth.curves) {
      Sample like;
      like.convex = convex(curve.type);
      like.optional = curve.optional || (curve.wall_mm > 0.0 && curve.wall_mm < least_wall);
      true_.add(curve.points, curve.closed, like);
    }
    for (const FoundLine& line : found.lines) {
      Sample like;
      like.convex = convex(line.type);
      found_.add(line.points, false, like);
    }
    true_.finish();
    found_.finish();
    for (std::uint32_t k = 0; k < true_.all.size(); ++k) true_grid_.add(true_.all[k].at, k);
    for (std::uint32_t k = 0; k < found_.all.size(); ++k) found_grid_.add(found_.all[k].at, k);
  }

  void judge(Score& score) {
    count_recall(score);
    count_precision(score);
    count_pieces(score);
    score.f1 = score.recall + score.strict_precision > 0.0
                   ? 2.0 * score.recall * score.strict_precision / (score.recall + score.strict_precision)
                   : 0.0;
  }

private:
  void count_recall(Score& score) {
    std::size_t total = 0;
    std::size_t seen = 0;
    std::size_t seen_right = 0;
    for (const Sample& sample : true_.all) {
      if (sample.optional) continue;
      bool any = false;
      bool right = false;
      found_grid_.near(sample.at, [&](std::uint32_t k, double) {
        any = true;
        right = right || found_.all[k].convex == sample.convex;
      });
      ++total;
      seen += any ? 1U : 0U;
      seen_right += right ? 1U : 0U;
      double angle = std::fabs(std::remainder(sample.angle - direction_, 180.0));
      angle = std::min(angle, 89.999);
      const auto k = static_cast<std::size_t>(angle / 20.0);
      score.angle_mm[k] += true_.step;
      if (any) score.angle_found_mm[k] += true_.step;
    }
    score.true_mm = static_cast<double>(total) * true_.step;
    score.recall = share(seen, total);
    score.polarity_recall = share(seen_right, total);
  }

  /// Long lines claim the stretches of true curves that they run along first; who finds a stretch claimed has doubled it.
  void count_precision(Score& score) {
    std::vector<std::uint32_t> order(found_.curves());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, [&](std::uint32_t a, std::uint32_t b) { return found_.size(a) > found_.size(b); });
    owner_.assign(true_.all.size(), kFree);
    right_.assign(found_.all.size(), false);
    std::vector<double> off;
    for (const bool same_side : {true, false}) {
      for (const std::uint32_t line : order) claim(line, same_side, off);
    }
    std::size_t near = 0;
    std::size_t right = 0;
    std::size_t judged = 0;
    for (std::size_t k = 0; k < found_.all.size(); ++k) {
      bool any = false;
      bool needed = false;
      true_grid_.near(found_.all[k].at, [&](std::uint32_t j, double) {
        any = true;
        needed = needed || !true_.all[j].optional;
      });
      if (any && !needed) continue; // neither right nor wrong
      ++judged;
      near += any ? 1U : 0U;
      right += right_[k] ? 1U : 0U;
    }
    score.found_mm = static_cast<double>(found_.all.size()) * found_.step;
    score.false_mm = static_cast<double>(judged - near) * found_.step;
    score.precision = share(near, judged);
    score.strict_precision = share(right, judged);
    if (off.empty()) return;
    score.position_mean = std::accumulate(off.begin(), off.end(), 0.0) / static_cast<double>(off.size()) / u_;
    const auto at = off.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(off.size() - 1));
    std::ranges::nth_element(off, at);
    score.position_95 = *at / u_;
  }

  void claim(std::uint32_t line, bool same_side, std::vector<double>& off) {
    std::vector<std::uint32_t> mine;
    for (std::uint32_t k = found_.first[line]; k < found_.first[line + 1]; ++k) {
      if (right_[k]) continue;
      std::uint32_t best = kFree;
      double best_distance = 0.0;
      true_grid_.near(found_.all[k].at, [&](std::uint32_t j, double d) {
        if ((owner_[j] != kFree && owner_[j] != line) || (same_side && true_.all[j].convex != found_.all[k].convex)) return;
        if (best != kFree && d >= best_distance) return;
        best = j;
        best_distance = d;
      });
      if (best == kFree) continue;
      right_[k] = true;
      mine.push_back(best);
      if (same_side && !true_.all[best].optional) off.push_back(distance_to_curve(found_.all[k].at, best));
    }
    own(line, mine);
  }

  /// Marks what `line` ran along, with the samples between, as its own.
  void own(std::uint32_t line, std::vector<std::uint32_t>& mine) {
    std::ranges::sort(mine);
    constexpr auto kHole = static_cast<std::uint32_t>(2.0 * kTolerance / kSampling);
    for (std::size_t k = 0; k < mine.size(); ++k) {
      owner_[mine[k]] = line;
      if (k == 0 || mine[k] - mine[k - 1] > kHole || true_.all[mine[k]].line != true_.all[mine[k - 1]].line) continue;
      for (std::uint32_t j = mine[k - 1] + 1; j < mine[k]; ++j) owner_[j] = owner_[j] == kFree ? line : owner_[j];
    }
  }

  [[nodiscard]] double distance_to_curve(const Place& at, std::uint32_t sample) const noexcept {
    double least = distance(at, true_.all[sample].at);
    for (const std::uint32_t from : {sample, sample + 1}) { // segments from - 1 .. from
      if (from == 0 || from >= true_.all.size() || true_.all[from - 1].line != true_.all[from].line) continue;
      const Place& a = true_.all[from - 1].at;
      const Place& b = true_.all[from].at;
      double dot = 0.0;
      double square = 0.0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        dot += (at[axis] - a[axis]) * (b[axis] - a[axis]);
        square += (b[axis] - a[axis]) * (b[axis] - a[axis]);
      }
      const double t = square > 0.0 ? std::clamp(dot / square, 0.0, 1.0) : 0.0;
      Place foot{};
      for (std::size_t axis = 0; axis < 3; ++axis) foot[axis] = a[axis] + t * (b[axis] - a[axis]);
      least = std::min(least, distance(at, foot));
    }
    return least;
  }

  void count_pieces(Score& score) {
    double longest = 0.0;
    double fragments = 0.0;
    std::size_t curves = 0;
    std::size_t found = 0;
    for (std::size_t c = 0; c < true_.curves(); ++c) {
      const std::size_t size = true_.size(c);
      if (static_cast<double>(size) * kSampling < kShortCurve || true_.all[true_.first[c]].optional) continue;
      std::map<std::uint32_t, std::size_t> covered; // by found line
      for (std::uint32_t j = true_.first[c]; j < true_.first[c + 1]; ++j) {
        std::vector<std::uint32_t> lines;
        found_grid_.near(true_.all[j].at, [&](std::uint32_t k, double) {
          if (found_.all[k].convex == true_.all[j].convex) lines.push_back(found_.all[k].line);
        });
        std::ranges::sort(lines);
        lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
        for (const std::uint32_t line : lines) ++covered[line];
      }
      ++curves;
      std::size_t most = 0;
      std::size_t pieces = 0;
      for (const auto& [line, count] : covered) {
        most = std::max(most, count);
        pieces += static_cast<double>(count) >= kFragment * static_cast<double>(size) ? 1U : 0U;
      }
      longest += share(most, size);
      fragments += static_cast<double>(pieces);
      found += pieces > 0 ? 1U : 0U;
    }
    score.longest = curves == 0 ? 1.0 : longest / static_cast<double>(curves);
    score.fragments = found == 0 ? 0.0 : fragments / static_cast<double>(found);
  }

  double u_, direction_;
  Samples true_, found_;
  PointGrid true_grid_, found_grid_;
  std::vector<std::uint32_t> owner_; // the found line that claims a true sample
  std::vector<bool> right_;          // found samples that claimed something
};

} // namespace

Score judge(const Truth& truth, const Found& found) {
  Score score;
  LineJudge(truth, found).judge(score);
  judge_patches(truth, found, score);
  return score;
}

} // namespace scansion::score
