// What both import fuzz targets do with bytes: import them as a file, and check what every import must keep.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/import/import.hpp"

#include <cstdint>
#include <span>

namespace scansion::fuzz {

/// Imports `content` under a name without an ending and stops the program when a rule of Importer is broken.
void import_bytes(std::span<const std::uint8_t> content, const ImportOptions& options);

/// Options by the bits of one byte.
[[nodiscard]] ImportOptions options_of(std::uint8_t choice, ImportFormat format);

} // namespace scansion::fuzz
