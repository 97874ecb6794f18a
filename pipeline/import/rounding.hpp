// The nearest lattice point of a number.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/number.hpp"
#include "pipeline/model/lattice.hpp"

#include <optional>

namespace scansion {

struct Rounded {
  std::int64_t total = 0; ///< counts
  double error = 0.0;     ///< counts, 0 to 0.5
};

/// number / resolution, rounded to nearest, ties away from zero; nothing when that leaves 2^62 counts. Exact integer
/// arithmetic, save for decimals with more than 22 places and IEEE values below 2^-20 with bits below 2^-73: these go through
/// long double.
[[nodiscard]] std::optional<Rounded> round_to(const Number& number, Rational resolution) noexcept;

/// The count of a decimal lattice (resolution 10^-decimals) whose value has the very bits of `ieee`; nothing when there is
/// none.
[[nodiscard]] std::optional<std::int64_t> count_with_bits(const Number& ieee, const Lattice& lattice, int decimals) noexcept;

} // namespace scansion
