// Bends to significant points.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/feature_point.hpp"
#include "pipeline/feature/fit/local_fit.hpp"

namespace scansion {

/// A point from what was measured at sample k, with its class and its uncertainty.
[[nodiscard]] FeaturePoint make_point(const Bend& bend, std::uint32_t k, const FitScale& scale) noexcept;

/// Whether a bend of the same polarity beside a coarser one, measured over this window, belongs to it: the end of its rounding.
[[nodiscard]] bool is_part(double tau, std::uint32_t window, const FeaturePoint& coarse) noexcept;

} // namespace scansion
