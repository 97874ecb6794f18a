// The lattice of one axis.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/axis_scale.hpp"

#include "pipeline/codec/kernels.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

namespace scansion {
namespace {

std::int64_t modulo(std::int64_t v, std::int64_t step) noexcept {
  const std::int64_t rest = v % step;
  return rest < 0 ? rest + step : rest;
}

// A step is only worth its name when the axis spans many of them.
constexpr std::int64_t kLeastSteps = 64;

struct Majority {
  std::uint32_t residue = 0; ///< of what lies above `low`
  bool clear = false;        ///< `share` of eight values have it
};

// Majority vote over a sample of the values. Divisions of 32 bits take half the time of wider ones.
Majority majority_residue(std::span<const std::int32_t> values, std::int32_t low, std::uint32_t step, std::size_t sample,
                          std::size_t share) noexcept {
  const std::size_t stride = std::max<std::size_t>(1, values.size() / sample);
  const auto residue = [&](std::size_t i) {
    return (static_cast<std::uint32_t>(values[i]) - static_cast<std::uint32_t>(low)) % step;
  };
  Majority m;
  std::size_t votes = 0;
  for (std::size_t i = 0; i < values.size(); i += stride) {
    const std::uint32_t r = residue(i);
    if (votes == 0) m.residue = r;
    votes = r == m.residue ? votes + 1 : votes - 1;
  }
  std::size_t have = 0;
  std::size_t all = 0;
  for (std::size_t i = 0; i < values.size(); i += stride, ++all) have += residue(i) == m.residue ? 1U : 0U;
  m.clear = 8 * have >= share * all;
  return m;
}

// What three quarters of the values have. Most axes have nothing like it, and a few values say so.
Majority majority_residue(std::span<const std::int32_t> values, std::int32_t low, std::uint32_t step) noexcept {
  const Majority few = majority_residue(values, low, step, 128, 4);
  return few.clear ? majority_residue(values, low, step, 1024, 6) : few;
}

// Exact division by one step, modulo 2^32: for multiples of an odd number a multiplication.
class Divider {
public:
  explicit Divider(std::uint32_t step) noexcept : shift_(std::countr_zero(step)), inverse_(1) {
    const std::uint32_t odd = step >> shift_;
    for (int i = 0; i < 5; ++i) inverse_ *= 2U - odd * inverse_; // each turn doubles the bits that are right
  }
  [[nodiscard]] std::int32_t divide(std::int32_t multiple) const noexcept {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(multiple >> shift_) * inverse_);
  }

private:
  int shift_;
  std::uint32_t inverse_;
};

// gcd of all differences from the first value: that of a few, made smaller where the others do not fit.
std::uint32_t shared_step(std::span<const std::int32_t> values) noexcept {
  const auto off = [&](std::size_t i) {
    return static_cast<std::uint32_t>(std::abs(std::int64_t{values[i]} - values.front()));
  };
  constexpr std::size_t kFew = 64;
  std::uint32_t step = 0;
  const std::size_t stride = std::max<std::size_t>(1, values.size() / kFew);
  for (std::size_t i = 0; i < values.size() && step != 1; i += stride) step = std::gcd(step, off(i));
  constexpr std::size_t kBlock = 512;
  for (std::size_t from = 0; from < values.size() && step != 1; from += kBlock) {
    const std::size_t count = std::min(kBlock, values.size() - from);
    const bool fits = step != 0 && off(from) % step == 0 && kernels::share_step(values.data() + from, step, count);
    for (std::size_t i = from; i < from + count && !fits; ++i) step = std::gcd(step, off(i));
  }
  return step;
}

AxisScale scale_of(std::span<const std::int32_t> values, bool may_split) noexcept {
  if (values.empty()) return {};
  std::int32_t low = values.front();
  std::int32_t high = low;
  kernels::bounds(values.data(), values.size(), low, high);
  if (low == high) return {low, 1, false, false, false};
  std::int64_t step = shared_step(values);
  const std::int64_t range = std::int64_t{high} - low;
  std::int64_t residue = values.front();
  bool split = false;
  for (std::int64_t wider = step * 10; may_split && wider <= range / kLeastSteps; wider *= 10) {
    const Majority m = majority_residue(values, low, static_cast<std::uint32_t>(wider));
    if (!m.clear) break;
    step = wider;
    residue = std::int64_t{low} + m.residue;
    split = true;
  }
  // Near the middle, so that the distance to both ends fits 32 bits even for step 1: the first base at or above it.
  const std::int64_t middle = low + (range + 1) / 2;
  const std::int64_t base = middle + modulo(residue - middle, step);
  if (base > std::numeric_limits<std::int32_t>::max())
    return {static_cast<std::int32_t>(base - step), static_cast<std::uint32_t>(step), split, false, false};
  return {static_cast<std::int32_t>(base), static_cast<std::uint32_t>(step), split, false, false};
}

// Steps of a run that is even, or nothing.
std::optional<std::int64_t> even_step(std::span<const std::int32_t> run) noexcept {
  if (run.size() < 2) return 0;
  const auto wrapped = [](std::int32_t a, std::int32_t b) {
    return static_cast<std::uint32_t>(a) - static_cast<std::uint32_t>(b);
  };
  const std::int64_t step = std::int64_t{run[1]} - run[0];
  constexpr std::size_t kBlock = 256; // leaves early, yet the inner loop has no exit
  for (std::size_t from = 1; from < run.size(); from += kBlock) {
    std::uint32_t differ = 0;
    const std::size_t to = std::min(run.size(), from + kBlock);
    for (std::size_t i = from; i < to; ++i) differ |= wrapped(run[i], run[i - 1]) ^ static_cast<std::uint32_t>(step);
    if (differ != 0) return std::nullopt;
  }
  // What wraps around is not even.
  const std::int64_t rise = std::int64_t{run.back()} - run.front();
  if (rise != step * static_cast<std::int64_t>(run.size() - 1)) return std::nullopt;
  return step;
}

} // namespace

AxisScale find_scale(std::span<const std::int32_t> values) noexcept {
  return scale_of(values, true);
}

AxisScale find_scale(std::span<const std::int32_t> values, std::span<const Run> runs, std::vector<std::int32_t>& scratch) {
  scratch.clear();
  for (const Run& run : runs) {
    const auto points = values.subspan(run.first, run.count);
    if (!even_step(points)) return scale_of(values, true);
    // All other points are sums of these: they share the step that these share.
    scratch.push_back(points.front());
    if (points.size() > 1) scratch.push_back(points[1]);
    scratch.push_back(points.back());
  }
  AxisScale scale = scale_of(scratch, false);
  scale.even = true;
  return scale;
}

void to_steps(std::span<const std::int32_t> values, const AxisScale& scale, std::span<std::int32_t> u) noexcept {
  const std::size_t n = values.size();
  if (scale.split) {
    for (std::size_t i = 0; i < n; ++i) u[i] = static_cast<std::int32_t>(scale.steps(values[i]));
    return;
  }
  const auto base = static_cast<std::uint32_t>(scale.base);
  if (scale.step == 1) {
    for (std::size_t i = 0; i < n; ++i) u[i] = static_cast<std::int32_t>(static_cast<std::uint32_t>(values[i]) - base);
    return;
  }
  // The base lies in the middle of the values, so their differences from it fit 32 bits.
  const Divider by(scale.step);
  for (std::size_t i = 0; i < n; ++i) u[i] = by.divide(static_cast<std::int32_t>(static_cast<std::uint32_t>(values[i]) - base));
}

void ends_to_steps(std::span<const std::int32_t> values, const AxisScale& scale, std::span<const Run> runs,
                   std::span<std::int32_t> u) noexcept {
  for (const Run& run : runs)
    for (const std::uint32_t i : {run.first, run.first + run.count - 1})
      u[i] = static_cast<std::int32_t>(scale.steps(values[i]));
}

} // namespace scansion
