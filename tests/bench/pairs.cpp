// Two programs measured in alternation.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/pairs.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace scansion::bench {
namespace {

double clock_ns(clockid_t clock) noexcept {
  timespec now{};
  clock_gettime(clock, &now);
  return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

double time_of(const std::function<void()>& work, unsigned rounds) {
  const double start = thread_ns();
  for (unsigned k = 0; k < rounds; ++k) work();
  return (thread_ns() - start) / rounds;
}

unsigned rounds_for(const std::function<void()>& work, double least_ms) {
  work();
  const double once = std::max(1.0, time_of(work, 1));
  return static_cast<unsigned>(std::clamp(std::ceil(least_ms * 1e6 / once), 1.0, 1e5));
}

} // namespace

double thread_ns() noexcept {
  return clock_ns(CLOCK_THREAD_CPUTIME_ID);
}

double wall_ns() noexcept {
  return clock_ns(CLOCK_MONOTONIC);
}

Quartiles quartiles(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    const double place = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (values[above] - values[below]) * (place - static_cast<double>(below));
  };
  return {at(0.25), at(0.5), at(0.75)};
}

PairResult alternate(const std::function<double()>& ours, const std::function<double()>& peer, unsigned pairs) {
  std::vector<double> ratios;
  std::vector<double> a;
  std::vector<double> b;
  for (unsigned k = 0; k < pairs; ++k) {
    const bool ours_first = k % 2 == 0;
    const double first = ours_first ? ours() : peer();
    const double second = ours_first ? peer() : ours();
    a.push_back(ours_first ? first : second);
    b.push_back(ours_first ? second : first);
    ratios.push_back(a.back() / b.back());
  }
  return {quartiles(ratios), quartiles(a).median, quartiles(b).median};
}

PairResult run_pairs(const std::function<void()>& ours, const std::function<void()>& peer, const PairOptions& options) {
  const unsigned ours_rounds = rounds_for(ours, options.least_ms);
  const unsigned peer_rounds = rounds_for(peer, options.least_ms);
  return alternate([&] { return time_of(ours, ours_rounds); }, [&] { return time_of(peer, peer_rounds); }, options.pairs);
}

} // namespace scansion::bench
