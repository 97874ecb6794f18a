// How well found feature lines and patches agree with the true ones.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_line.hpp"
#include "sim/truth/truth.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace scansion::score {

struct FoundLine {
  FeatureType type = FeatureType::convex;
  std::vector<std::array<double, 3>> points; ///< mm
};

/// What a program says about one scan.
struct Found {
  std::vector<FoundLine> lines;
  std::vector<std::vector<std::uint32_t>> patches; ///< of each point of each line as written; empty: not judged
  std::vector<Form> forms;
};

/// Form features of one kind: how many there are, how many of these were named, how many were said to be there, how many of
/// those rightly so. A form said in pieces is right in each of them: right / named tells how many.
struct FormCount {
  std::uint32_t there = 0, named = 0, said = 0, right = 0;
};
using FormCounts = std::array<FormCount, kFormKinds>; ///< by FormKind
[[nodiscard]] FormCount sum_of(const FormCounts& counts) noexcept;

inline constexpr std::uint32_t kNoPatch = 0xffffffffU;
inline constexpr std::size_t kAngleClasses = 5; ///< 0-20, 20-40, 40-60, 60-80, 80-90 degrees to the scan lines, in plan

/// Shares are by length unless said otherwise. Both sets of curves are sampled every quarter of u, the larger of pitch and
/// spacing; the tolerance is 1.5 u, in space.
struct Score {
  double true_mm = 0.0, found_mm = 0.0;
  double false_mm = 0.0;                         ///< of found lines that are near no true curve
  double precision = 1.0;                        ///< of found lines, near any true curve
  double strict_precision = 1.0;                 ///< where a stretch of a true curve found twice is right once
  double recall = 1.0;                           ///< of true curves, near any found line
  double polarity_recall = 1.0;                  ///< near a found line that bends to the same side
  double f1 = 1.0;                               ///< of strict precision and recall
  double position_mean = 0.0, position_95 = 0.0; ///< in units of u, of what was found with its polarity
  double longest = 1.0;                          ///< mean over curves: the share that the longest found line covers
  double fragments = 0.0;                        ///< mean over found curves: lines that cover 5 % and more
  std::array<double, kAngleClasses> angle_mm{}, angle_found_mm{};
  double rand_index = 0.0; ///< adjusted, of patches, by samples
  bool has_patches = false;
  FormCounts forms{};
};

[[nodiscard]] Score judge(const Truth& truth, const Found& found);

/// The part of judge() that is about patches and forms.
void judge_patches(const Truth& truth, const Found& found, Score& score);

/// Of two labellings of the same samples; 1 when they agree up to names.
[[nodiscard]] double adjusted_rand_index(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b);

} // namespace scansion::score
