// Sums at the end of records.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace scansion::stream {

enum class Checksum : std::uint8_t {
  none,
  xor8,         ///< exclusive or of the bytes
  sum8,         ///< their sum modulo 256
  crc16_modbus, ///< polynomial 0x8005 reflected, from 0xffff
  crc16_ccitt,  ///< polynomial 0x1021, from 0xffff
  crc32         ///< that of Ethernet and zip
};

[[nodiscard]] std::optional<Checksum> parse_checksum(std::string_view name) noexcept;
[[nodiscard]] std::size_t bytes_of(Checksum kind) noexcept;
[[nodiscard]] std::uint32_t checksum(Checksum kind, std::span<const std::uint8_t> bytes) noexcept;

} // namespace scansion::stream
