// Seeded random numbers that are the same on every machine.
// SPDX-License-Identifier: Apache-2.0
#include "sim/scene/random.hpp"

#include "sim/scene/portable_math.hpp"

#include <bit>
#include <cmath>

namespace scansion {
namespace {

std::uint64_t splitmix64(std::uint64_t& state) noexcept {
  state += 0x9e3779b97f4a7c15ULL;
  std::uint64_t z = state;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31U);
}

} // namespace

Random::Random(std::uint64_t seed, std::uint64_t line, std::uint64_t purpose) noexcept {
  std::uint64_t mixed = seed;
  mixed = splitmix64(mixed) ^ line;
  mixed = splitmix64(mixed) ^ purpose;
  for (auto& word : state_) word = splitmix64(mixed);
}

std::uint64_t Random::next() noexcept {
  const std::uint64_t result = std::rotl(state_[1] * 5U, 7) * 9U;
  const std::uint64_t t = state_[1] << 17U;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Random::uniform() noexcept {
  return static_cast<double>(next() >> 11U) * 0x1.0p-53;
}

std::uint32_t Random::below(std::uint32_t bound) noexcept {
  // The bias of the plain product is below bound / 2^32: no matter for a simulator.
  return static_cast<std::uint32_t>(((next() >> 32U) * bound) >> 32U);
}

double Random::normal() noexcept {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  double a = 0.0;
  double b = 0.0;
  double r = 0.0;
  do {
    a = 2.0 * uniform() - 1.0;
    b = 2.0 * uniform() - 1.0;
    r = a * a + b * b;
  } while (r >= 1.0 || r < 1e-300);
  const double factor = std::sqrt(-2.0 * portable_log(r) / r);
  spare_ = b * factor;
  has_spare_ = true;
  return a * factor;
}

} // namespace scansion
