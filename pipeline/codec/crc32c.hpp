// CRC-32C (Castagnoli, reflected, as in RFC 3720): the checksum of payloads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace scansion {

/// Continues `crc` (0 at the start) over `bytes`. Uses the processor's instruction where there is one.
[[nodiscard]] std::uint32_t crc32c(std::uint32_t crc, std::span<const std::byte> bytes) noexcept;

/// The table version, for tests.
[[nodiscard]] std::uint32_t crc32c_portable(std::uint32_t crc, std::span<const std::byte> bytes) noexcept;

} // namespace scansion
