// Which rises of a profile matter to anybody.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/profile/sampling.hpp"

namespace scansion {

/// mm: no spike, wall or jump is looked for at a rise of less.
[[nodiscard]] double least_rise(const Sampling& sampling) noexcept;

} // namespace scansion
