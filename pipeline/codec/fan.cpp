// Sensors that turn. Only square roots, divisions and sums of doubles: every machine finds the same fan.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/fan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace scansion {
namespace {

constexpr std::size_t kLeastPoints = 512;
constexpr std::size_t kLeastDirections = 8;
constexpr unsigned kMaxShift = 30;
constexpr unsigned kTurnBits = 30;
constexpr double kCounts = 4; // two points of one direction are never farther apart

double length(std::int32_t x, std::int32_t y) noexcept {
  return std::sqrt(static_cast<double>(x) * x + static_cast<double>(y) * y);
}

// Counts a range step, 0 for none: of the round numbers the largest that nearly all ranges are multiples of.
double range_step(std::span<const std::int32_t> x, std::span<const std::int32_t> y) noexcept {
  constexpr std::size_t kSample = 512;
  const std::size_t stride = std::max<std::size_t>(1, x.size() / kSample);
  for (int decade = 1'000'000; decade >= 10; decade /= 10)
    for (const int part : {1, 2, 4, 5}) {
      const double step = static_cast<double>(decade) / part;
      if (step < 10) break;
      std::size_t all = 0;
      std::size_t near = 0;
      for (std::size_t i = 0; i < x.size(); i += stride, ++all) {
        const double r = length(x[i], y[i]);
        // Rounding to whole counts moves a range by less than one; a range of a few steps says nothing.
        near += r >= 8 * step && std::abs(r - step * std::round(r / step)) <= 1.0 ? 1U : 0U;
        if (near + 32 < all - all / 16) break;
      }
      if (16 * near >= 15 * all) return step;
    }
  return 0;
}

std::int64_t predict(std::int64_t turn, std::int64_t one_before, std::int64_t two_before) noexcept {
  const auto product = static_cast<std::int64_t>(static_cast<std::uint64_t>(turn) * static_cast<std::uint64_t>(one_before));
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(product >> kTurnBits) - static_cast<std::uint64_t>(two_before));
}

} // namespace

// Points by angle: a radix sort by its upper bits, then whatever shares these by all of them.
void FanFinder::sort_by_angle() {
  constexpr unsigned kDigit = 11;
  constexpr unsigned kKeyBits = 31; // the angle goes from -2 to 2
  constexpr unsigned kFirst = 32 + kKeyBits + 1 - 2 * kDigit;
  keys_.clear();
  for (const Point& p : points_) keys_.push_back(static_cast<std::uint64_t>((p.turn + 2) * 0x1p29) << 32U | p.index);
  sorted_keys_.resize(keys_.size());
  for (const unsigned shift : {kFirst, kFirst + kDigit}) {
    std::array<std::uint32_t, (1U << kDigit) + 1> starts{};
    const auto digit = [&](std::uint64_t key) { return key >> shift & ((1U << kDigit) - 1); };
    for (const std::uint64_t key : keys_) ++starts[digit(key) + 1];
    std::partial_sum(starts.begin(), starts.end(), starts.begin());
    for (const std::uint64_t key : keys_) sorted_keys_[starts[digit(key)]++] = key;
    keys_.swap(sorted_keys_);
  }
  for (std::size_t from = 0, to = 0; from < keys_.size(); from = to) {
    while (to < keys_.size() && keys_[to] >> kFirst == keys_[from] >> kFirst) ++to;
    if (to - from > 1)
      std::sort(keys_.begin() + static_cast<std::ptrdiff_t>(from), keys_.begin() + static_cast<std::ptrdiff_t>(to));
  }
  by_index_.swap(points_);
  points_.clear();
  for (const std::uint64_t key : keys_) points_.push_back(by_index_[static_cast<std::uint32_t>(key)]);
}

bool FanFinder::are_apart(const End& a, const End& b) noexcept {
  return b.turn - a.turn > kCounts / std::min(a.size, b.size);
}

// Directions are narrow and lie far apart: then each has a bucket of angles to itself, or two next to each other, and nothing
// need be sorted. False when one bucket may hold two.
bool FanFinder::cut_by_buckets() {
  constexpr std::size_t kBucketsARight = 2048;  // right angle
  bucket_at_.assign(4 * kBucketsARight + 1, 0); // the angle goes from -2 to 2, both included
  buckets_.assign(1, {});                       // of angles that no point has
  for (const Point& p : points_) {
    std::uint32_t& b = bucket_at_[static_cast<std::size_t>((p.turn + 2) * kBucketsARight)];
    if (b == 0) {
      b = static_cast<std::uint32_t>(buckets_.size());
      buckets_.emplace_back();
    }
    directions[p.index] = static_cast<std::int32_t>(b);
    Bucket& bucket = buckets_[b];
    if (p.turn < bucket.low.turn) bucket.low = {p.turn, p.size};
    if (p.turn > bucket.high.turn) bucket.high = {p.turn, p.size};
    if (p.size > bucket.longest.size) bucket.longest = {p.turn, p.size};
  }
  // No point is farther from the longest one's direction than half of what would part them.
  const Bucket* const buckets = buckets_.data();
  for (const Point& p : points_)
    if (2 * std::abs(p.turn - buckets[directions[p.index]].longest.turn) * p.size > kCounts) return false;
  count_ = 0;
  const Bucket* before = nullptr;
  for (const std::uint32_t b : bucket_at_) {
    if (b == 0) continue;
    Bucket& here = buckets_[b];
    if (before == nullptr || are_apart(before->high, here.low)) ++count_;
    here.direction = static_cast<std::int32_t>(count_) - 1;
    before = &here;
  }
  for (std::int32_t& direction : directions) direction = buckets_[static_cast<std::size_t>(direction)].direction;
  return true;
}

void FanFinder::cut_sorted() {
  sort_by_angle();
  count_ = 1;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    if (p > 0 && are_apart({points_[p - 1].turn, points_[p - 1].size}, {points_[p].turn, points_[p].size})) ++count_;
    directions[points_[p].index] = static_cast<std::int32_t>(count_) - 1;
  }
}

// The direction of each point.
bool FanFinder::sort_out(std::span<const std::int32_t> x, std::span<const std::int32_t> y) {
  points_.resize(x.size());
  Point* const points = points_.data();
  for (std::uint32_t i = 0; i < x.size(); ++i) {
    const double size = std::abs(static_cast<double>(x[i])) + std::abs(static_cast<double>(y[i]));
    if (size == 0) return false;
    const double part = y[i] / size;
    points[i] = {x[i] >= 0 ? part : (y[i] >= 0 ? 2 - part : -2 - part), size, i};
  }
  directions.resize(x.size());
  if (!cut_by_buckets()) cut_sorted();
  return count_ >= kLeastDirections && count_ <= kMaxDirections && count_ * 8 <= points_.size();
}

// For each direction the vector of one range step that makes all its points come out right, if there is one.
bool FanFinder::fit(std::span<const std::int32_t> x, std::span<const std::int32_t> y, Fan& fan) {
  std::int32_t longest = 0;
  ranges.resize(x.size());
  vectors_.assign(count_, {});
  std::int32_t* const range_of = ranges.data();
  const std::int32_t* const direction_of = directions.data();
  Vector* const vectors = vectors_.data();
  const double step = step_;
  for (std::size_t i = 0; i < x.size(); ++i) {
    constexpr double kHalf = 0.5; // ranges are positive: what is cut off then rounds
    const auto n = static_cast<std::int32_t>(length(x[i], y[i]) / step + kHalf);
    range_of[i] = n;
    longest = std::max(longest, n);
    if (n <= 0) continue;
    Vector& vector = vectors[direction_of[i]];
    const double a_step = 1.0 / n;
    const bool best = n > vector.best_range;
    if (best) vector.best_range = n;
    const auto narrow = [&](Between& range, double v) {
      range.low = std::max(range.low, (v - kHalf) * a_step);
      range.high = std::min(range.high, (v + kHalf) * a_step);
      if (best) range.best = v * a_step;
    };
    narrow(vector.parts[0], x[i]);
    narrow(vector.parts[1], y[i]);
  }
  constexpr unsigned kSpareBits = 6;
  fan.shift =
      std::min<unsigned>(kMaxShift, static_cast<unsigned>(std::bit_width(static_cast<std::uint32_t>(longest))) + kSpareBits);
  fan.directions.resize(count_);
  const double unit = static_cast<double>(std::int64_t{1} << fan.shift);
  for (std::size_t d = 0; d < count_; ++d)
    for (const std::size_t part : {0U, 1U}) {
      const Between& range = vectors_[d].parts[part];
      fan.directions[d][part] =
          std::llround((range.low < range.high ? range.low + (range.high - range.low) / 2 : range.best) * unit);
    }
  for (const std::size_t part : {0U, 1U}) {
    const std::int32_t* const values = part == 0 ? x.data() : y.data();
    off[part].resize(x.size());
    std::int32_t* const to = off[part].data();
    std::uint32_t any = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::int32_t told = fan.coordinate(part, direction_of[i], range_of[i]);
      const std::uint32_t by = static_cast<std::uint32_t>(values[i]) - static_cast<std::uint32_t>(told);
      to[i] = static_cast<std::int32_t>(by);
      any |= by;
    }
    exact[part] = any == 0;
  }
  std::size_t right = 0;
  for (std::size_t i = 0; i < x.size(); ++i) right += (off[0][i] | off[1][i]) == 0 ? 1U : 0U;
  return 4 * right >= 3 * x.size();
}

// Directions that follow each other at equal angles satisfy next = 2 cos(angle) * this - before: the median says the angle.
void FanFinder::find_turn(Fan& fan) {
  turns_.clear();
  for (std::size_t d = 1; d + 1 < fan.directions.size(); ++d) {
    const auto part = [&](std::size_t k, std::size_t p) { return static_cast<double>(fan.directions[k][p]); };
    const double dot = part(d, 0) * (part(d - 1, 0) + part(d + 1, 0)) + part(d, 1) * (part(d - 1, 1) + part(d + 1, 1));
    const double square = part(d, 0) * part(d, 0) + part(d, 1) * part(d, 1);
    turns_.push_back(square > 0 ? dot / square : 2.0);
  }
  const auto middle = turns_.begin() + static_cast<std::ptrdiff_t>(turns_.size() / 2);
  std::ranges::nth_element(turns_, middle);
  fan.turn = std::llround(std::clamp(*middle, -2.0, 2.0) * static_cast<double>(1U << kTurnBits));
}

void FanFinder::find(std::span<const std::int32_t> x, std::span<const std::int32_t> y, Fan& fan) {
  fan.clear();
  if (x.size() < kLeastPoints) return;
  step_ = range_step(x, y);
  if (step_ == 0 || !sort_out(x, y) || !fit(x, y, fan))
    fan.clear();
  else
    find_turn(fan);
}

void write_fan(const Fan& fan, Bytes& to) {
  to.push_back(static_cast<std::byte>(fan.range_axis | fan.direction_axis << 2U));
  to.push_back(static_cast<std::byte>(fan.shift));
  put_varint(to, fan.directions.size());
  put_signed(to, fan.turn);
  std::array<std::int64_t, 2> before{};
  std::array<std::int64_t, 2> two_before{};
  for (const auto& d : fan.directions) {
    for (const std::size_t part : {0U, 1U})
      put_signed(to, static_cast<std::int64_t>(static_cast<std::uint64_t>(d[part]) -
                                               static_cast<std::uint64_t>(predict(fan.turn, before[part], two_before[part]))));
    two_before = before;
    before = d;
  }
}

Result<void> read_fan(ByteReader& from, std::size_t limit, Fan& fan) {
  const std::uint8_t axes = from.byte();
  fan.range_axis = axes & 3U;
  fan.direction_axis = axes >> 2U;
  fan.shift = from.byte();
  const std::uint64_t count = from.varint();
  fan.turn = from.signed_varint();
  if (!from.ok() || fan.range_axis > 2 || fan.direction_axis > 2 || fan.range_axis == fan.direction_axis ||
      fan.shift > kMaxShift || count == 0 || count > std::min(limit, kMaxDirections))
    return fail(Errc::damaged, "the line table has an impossible fan");
  fan.directions.resize(static_cast<std::size_t>(count));
  std::array<std::int64_t, 2> before{};
  std::array<std::int64_t, 2> two_before{};
  for (auto& d : fan.directions) {
    for (const std::size_t part : {0U, 1U})
      d[part] = static_cast<std::int64_t>(static_cast<std::uint64_t>(from.signed_varint()) +
                                          static_cast<std::uint64_t>(predict(fan.turn, before[part], two_before[part])));
    two_before = before;
    before = d;
  }
  if (!from.ok()) return fail(Errc::damaged, "the line table is cut short");
  return success();
}

} // namespace scansion
