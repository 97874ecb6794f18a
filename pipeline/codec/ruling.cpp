// Ruled axes. The search computes in doubles and proves its result in integers: what is not exact is not ruled.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/ruling.hpp"

#include "pipeline/codec/group_state.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace scansion {
namespace {

constexpr unsigned kFractionBits = 32;
constexpr double kUnit = 0x1p32;
constexpr double kMargin = 1e-6; // of a step: more than doubles round
constexpr double kHopeless = 2;  // steps that no pitch between the bounds makes up for
constexpr std::size_t kFewPoints = 33;

enum Context : std::uint32_t { kFirst, kPitch, kFraction, kPhase, kSkips, kPlace, kMissing };

// Fractions of few bits are small numbers when turned round.
std::uint32_t turned(std::uint32_t fraction) noexcept {
  constexpr std::array<std::uint32_t, 5> kLower{0x5555'5555, 0x3333'3333, 0x0F0F'0F0F, 0x00FF'00FF, 0x0000'FFFF};
  for (unsigned k = 0; k < kLower.size(); ++k)
    fraction = (fraction >> (1U << k) & kLower[k]) | (fraction & kLower[k]) << (1U << k);
  return fraction;
}

std::int32_t floor_part(std::int64_t pitch) noexcept {
  return static_cast<std::int32_t>(pitch >> kFractionBits);
}
std::uint32_t fraction_part(std::int64_t pitch) noexcept {
  return static_cast<std::uint32_t>(pitch);
}

// The number of fewest bits behind the point in [low, high].
std::optional<double> shortest_between(double low, double high) noexcept {
  for (unsigned bits = 0; bits <= kFractionBits; ++bits) {
    const double unit = std::ldexp(1.0, static_cast<int>(bits));
    const double number = std::ceil(low * unit) / unit;
    if (number <= high) return number;
  }
  return std::nullopt;
}

// The mean of the usual differences of neighbours, 0 when most differ by more than rounding does.
double usual_step(std::span<const std::int32_t> u, std::vector<double>& steps) {
  steps.clear();
  for (std::size_t i = 1; i < u.size() && i < kFewPoints; ++i) steps.push_back(static_cast<double>(u[i]) - u[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  const double median = *middle;
  double sum = 0;
  std::size_t near = 0;
  for (const double step : steps) {
    if (std::abs(step - median) > 1) continue;
    sum += step;
    ++near;
  }
  return 2 * near > steps.size() ? sum / static_cast<double>(near) : 0;
}

} // namespace

bool Ruling::measure(const Run& run, std::span<const std::int32_t> u, double pitch, Spread& spread) {
  spread = {static_cast<double>(u[run.first]), pitch};
  const std::size_t most_skips = skips_.size() + run.count / 4 + 1;
  const std::uint32_t end = run.first + run.count;
  for (std::uint32_t i = run.first + 1;; ++i) {
    i += static_cast<std::uint32_t>(kernels::along_pitch(u.data() + i, end - i, spread));
    if (i == end) return true;
    const double samples = std::floor((static_cast<double>(u[i]) - u[i - 1]) / pitch + 0.5);
    if (samples < 2 || samples > 0x1p30 || skips_.size() >= most_skips) return false;
    skips_.push_back({i, static_cast<std::uint32_t>(samples) - 1});
    spread.last += samples;
    spread.take(u[i]);
  }
}

// Takes a pitch that leaves room for a phase, if it is a number of the format.
bool Ruling::adopt(double pitch, const Spread& spread, const Rule& before) {
  const double scaled = pitch * kUnit;
  if (scaled != std::floor(scaled) || std::abs(scaled) >= 0x1p62) return false;
  // Each point's value less its multiple must lie above phase - 1 and not above phase.
  const double low = spread.high + kMargin;
  const double high = spread.low + 1 - kMargin;
  if (low > high) return false;
  Rule rule{static_cast<std::int64_t>(scaled), before.phase, skips_.size()};
  const double phase_before = before.phase / kUnit;
  if (phase_before < low || phase_before > high) {
    const auto phase = shortest_between(low, high);
    if (!phase || *phase >= 1) return false;
    rule.phase = static_cast<std::uint32_t>(*phase * kUnit);
  }
  rules_.push_back(rule);
  return true;
}

bool Ruling::rule(const Run& run, std::span<const std::int32_t> u, const Rule& before) {
  if (run.count < 2) {
    rules_.push_back({before.pitch, before.phase, skips_.size()});
    return true;
  }
  const std::size_t skips = skips_.size();
  const double usual = static_cast<double>(before.pitch) / kUnit;
  Spread spread;
  if (usual != 0 && measure(run, u, usual, spread) && (adopt(usual, spread, before) || narrow(run, u, skips, spread, before)))
    return true;
  skips_.resize(skips);
  const double own = usual_step(u.subspan(run.first, run.count), steps_);
  return own != 0 && measure(run, u, own, spread) && narrow(run, u, skips, spread, before);
}

// The samples are counted. Looks for the pitch that makes values stray least from its multiples, between bounds that each try
// narrows: two points that lie too far apart say on which side a better one lies.
bool Ruling::narrow(const Run& run, std::span<const std::int32_t> u, std::size_t skips, Spread spread, const Rule& before) {
  const double samples = spread.last;
  const auto try_pitch = [&](double pitch) {
    skips_.resize(skips);
    return measure(run, u, pitch, spread) && spread.last == samples;
  };
  double pitch = (static_cast<double>(u[run.first + run.count - 1]) - u[run.first]) / samples;
  double low = pitch - 1 / samples;
  double high = pitch + 1 / samples;
  constexpr int kTries = 16;
  for (int turn = 0; turn < kTries && low <= high; ++turn) {
    if (!try_pitch(pitch)) return false;
    const double slack = 1 - (spread.high - spread.low) - 4 * kMargin;
    if (slack > 0) {
      // As few bits as the slack allows.
      const auto few = shortest_between(pitch - slack / (4 * samples), pitch + slack / (4 * samples));
      return few && try_pitch(*few) && adopt(*few, spread, before);
    }
    if (slack < -kHopeless || spread.high_at == spread.low_at) return false;
    const double way = -slack / (spread.high_at - spread.low_at);
    (way > 0 ? low : high) = pitch + way;
    pitch = low + (high - low) / 2;
  }
  return false;
}

void Ruling::lay_out(const Run& run, const Rule& rule, std::size_t skips_begin, std::span<std::int32_t> u) const noexcept {
  const auto first = static_cast<std::uint32_t>(u[run.first]);
  const auto pitch = static_cast<std::uint64_t>(rule.pitch);
  std::uint64_t at = rule.phase;
  std::uint32_t i = run.first + 1;
  const auto go_on = [&](std::uint32_t end) {
    kernels::ruled(first, at, pitch, u.data() + i, end - i);
    at += pitch * (end - i);
    i = end;
  };
  for (std::size_t s = skips_begin; s < rule.skips_end; ++s) {
    go_on(skips_[s].point);
    at += pitch * skips_[s].samples;
  }
  go_on(run.first + run.count);
}

bool Ruling::find(std::span<const Run> runs, std::span<const std::int32_t> u) {
  rules_.clear();
  skips_.clear();
  // A part of the longest run says it for most axes that are not.
  const auto longest = std::ranges::max_element(runs, {}, &Run::count);
  if (longest == runs.end() || longest->count < 3) return false;
  constexpr std::uint32_t kPart = 64;
  Run part = *longest;
  part.count = std::min(part.count, kPart);
  if (!rule(part, u, {})) return false;
  const Rule likely = rules_.front();
  rules_.clear();
  skips_.clear();
  for (const Run& run : runs)
    if (!rule(run, u, rules_.empty() ? likely : rules_.back())) return false;
  check_.assign(u.begin(), u.end());
  std::size_t skips = 0;
  for (std::size_t r = 0; r < runs.size(); skips = rules_[r++].skips_end) lay_out(runs[r], rules_[r], skips, check_);
  return std::ranges::equal(check_, u);
}

void Ruling::write(std::span<const Run> runs, std::span<const std::int32_t> u, std::int32_t first, std::int32_t advance,
                   SymbolWriter& to) const {
  Rule before;
  std::int32_t guess = first;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const Run& run = runs[r];
    const Rule& rule = rules_[r];
    to.put(wrap(std::int64_t{u[run.first]} - guess), kFirst);
    guess = wrap(std::int64_t{u[run.first]} + advance);
    if (run.count > 1) {
      to.put(wrap(std::int64_t{floor_part(rule.pitch)} - floor_part(before.pitch)), kPitch);
      to.put(unfold(turned(fraction_part(rule.pitch) ^ fraction_part(before.pitch))), kFraction);
      to.put(unfold(turned(rule.phase ^ before.phase)), kPhase);
      to.put(unfold(static_cast<std::uint32_t>(rule.skips_end - before.skips_end)), kSkips);
      std::uint32_t at = run.first;
      for (std::size_t s = before.skips_end; s < rule.skips_end; ++s) {
        to.put(unfold(skips_[s].point - at - 1), kPlace);
        to.put(unfold(skips_[s].samples - 1), kMissing);
        at = skips_[s].point;
      }
    }
    before = rule;
  }
}

Result<void> Ruling::read(std::span<const Run> runs, std::int32_t first, std::int32_t advance, SymbolReader& from,
                          std::span<std::int32_t> u) {
  rules_.clear();
  skips_.clear();
  Rule rule;
  std::int32_t guess = first;
  for (const Run& run : runs) {
    u[run.first] = wrap(std::int64_t{guess} + from.next(kFirst));
    guess = wrap(std::int64_t{u[run.first]} + advance);
    if (run.count < 2) continue;
    const std::int32_t whole = wrap(std::int64_t{floor_part(rule.pitch)} + from.next(kPitch));
    const std::uint32_t fraction = fraction_part(rule.pitch) ^ turned(fold(from.next(kFraction)));
    rule.pitch = static_cast<std::int64_t>(static_cast<std::uint64_t>(std::int64_t{whole}) << kFractionBits | fraction);
    rule.phase ^= turned(fold(from.next(kPhase)));
    const std::size_t skips_begin = skips_.size();
    const std::uint32_t skips = fold(from.next(kSkips));
    std::uint32_t at = run.first;
    const std::uint32_t end = run.first + run.count;
    for (std::uint32_t s = 0; s < skips; ++s) {
      const std::uint32_t place = fold(from.next(kPlace));
      if (place >= end - at - 1) return fail(Errc::damaged, "a ruled axis misses samples where its runs have no points");
      at += place + 1;
      skips_.push_back({at, fold(from.next(kMissing)) + 1});
    }
    rule.skips_end = skips_.size();
    lay_out(run, rule, skips_begin, u);
  }
  return success();
}

} // namespace scansion
