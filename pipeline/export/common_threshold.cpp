// The last distance that a reduction over the whole scan keeps.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/export/common_threshold.hpp"

#include "pipeline/export/selection.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace scansion {

void CommonThreshold::add(std::span<const double> distance) {
  const unsigned low = kBits * (2 - pass_);
  const bool gather = pass_ == 0 && points_ <= kInMemory;
  for (const double d : distance) {
    if (pass_ == 0) {
      ++points_;
      if (std::isinf(d)) ++ends_;
    }
    if (std::isinf(d)) continue;
    const auto bits = std::bit_cast<std::uint64_t>(d);
    if (pass_ == 0 || bits >> (low + kBits) == prefix_) ++buckets_[(bits >> low) & (kBuckets - 1)];
    if (gather) all_.push_back(d);
  }
}

bool CommonThreshold::choose_bucket() {
  std::size_t b = kBuckets;
  while (b-- > 0) {
    if (wanted_ <= buckets_[b]) break;
    wanted_ -= buckets_[b];
  }
  prefix_ = prefix_ << kBits | b;
  std::ranges::fill(buckets_, 0);
  if (++pass_ < 3) return false;
  threshold_ = std::bit_cast<double>(prefix_);
  ties_ = wanted_;
  return true;
}

bool CommonThreshold::finish_pass(Rational kept_share) {
  if (pass_ > 0) return choose_bucket();
  const std::uint64_t inner = points_ - ends_;
  const std::uint64_t total = kept_of_scan(points_, kept_share);
  wanted_ = total > ends_ ? std::min(total - ends_, inner) : 0;
  if (wanted_ == 0) {
    threshold_ = std::numeric_limits<double>::max(); // end points only
    return true;
  }
  if (all_.size() != inner) {
    all_ = {};
    return choose_bucket();
  }
  const auto last = all_.begin() + static_cast<std::ptrdiff_t>(wanted_ - 1);
  std::nth_element(all_.begin(), last, all_.end(), std::greater<>());
  threshold_ = *last;
  ties_ = wanted_ - static_cast<std::uint64_t>(std::count_if(all_.begin(), last, [&](double d) { return d > threshold_; }));
  all_ = {};
  return true;
}

} // namespace scansion
