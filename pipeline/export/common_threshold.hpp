// The last distance that a reduction over the whole scan keeps, found in bounded memory.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/lattice.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace scansion {

/// Radix selection over the bits of D (a double of at least 0 orders like its bits): each pass over the scan fixes 21 bits, so
/// three passes find the exact value with one table of 16 MiB. A scan whose distances fit memory needs one pass.
class CommonThreshold {
public:
  CommonThreshold() : buckets_(kBuckets, 0) {}

  /// Distances of one run; end points are infinite.
  void add(std::span<const double> distance);
  /// Ends a pass over all runs; false: the same distances must be added again.
  [[nodiscard]] bool finish_pass(Rational kept_share);

  [[nodiscard]] double threshold() const noexcept { return threshold_; } ///< keep every D above it ...
  [[nodiscard]] std::uint64_t ties() const noexcept { return ties_; }    ///< ... and so many of those equal to it

private:
  static constexpr unsigned kBits = 21; // 3 * 21 = 63: the sign bit is never set
  static constexpr std::size_t kBuckets = std::size_t{1} << kBits;
  static constexpr std::size_t kInMemory = std::size_t{1} << 22;

  [[nodiscard]] bool choose_bucket();

  std::vector<std::uint64_t> buckets_;
  std::vector<double> all_; ///< every inner distance, while they are few
  std::uint64_t points_ = 0, ends_ = 0;
  std::uint64_t wanted_ = 0; ///< inner points still to take below the buckets already taken
  std::uint64_t prefix_ = 0;
  unsigned pass_ = 0;
  double threshold_ = 0.0;
  std::uint64_t ties_ = 0;
};

} // namespace scansion
