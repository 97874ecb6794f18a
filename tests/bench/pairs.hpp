// Two programs measured in alternation: a ratio that a busy machine can hardly bend.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

namespace scansion::bench {

/// Processor time of this thread so far, ns.
[[nodiscard]] double thread_ns() noexcept;
/// Wall time, ns.
[[nodiscard]] double wall_ns() noexcept;

struct Quartiles {
  double low = 0.0, median = 0.0, high = 0.0;
};
[[nodiscard]] Quartiles quartiles(std::vector<double> values);

struct PairOptions {
  unsigned pairs = 30;
  double least_ms = 2.0; ///< one measurement repeats its work until it lasts this long
};

struct PairResult {
  Quartiles ratio;                     ///< ours / peer, pair by pair
  double ours_ns = 0.0, peer_ns = 0.0; ///< medians, one round of work
};

/// Thread processor time of both, one after the other, first one then the other first. Both run once before for warmth.
[[nodiscard]] PairResult run_pairs(const std::function<void()>& ours, const std::function<void()>& peer,
                                   const PairOptions& options);

/// The same with a clock of the caller's: `measure` returns what one round took.
[[nodiscard]] PairResult alternate(const std::function<double()>& ours, const std::function<double()>& peer, unsigned pairs);

} // namespace scansion::bench
