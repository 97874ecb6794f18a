// Makes the checksums of a mutated recording right again, so that fuzzing reaches what stands behind them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace scansion::fuzz {

/// Payloads, metadata, chunks, data end and summary, as far as they can be found. Changes checksums only, never sizes.
void reseal(std::span<std::byte> recording);

} // namespace scansion::fuzz
