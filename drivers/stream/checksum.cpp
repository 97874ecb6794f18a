// Sums at the end of records.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/stream/checksum.hpp"

#include <boost/crc.hpp>
#include <utility>

namespace scansion::stream {
namespace {

using Modbus = boost::crc_optimal<16, 0x8005, 0xffff, 0, true, true>;
using Ccitt = boost::crc_optimal<16, 0x1021, 0xffff, 0, false, false>;

template <class Crc>
std::uint32_t crc(std::span<const std::uint8_t> bytes) {
  Crc sum;
  sum.process_bytes(bytes.data(), bytes.size());
  return static_cast<std::uint32_t>(sum.checksum());
}

} // namespace

std::optional<Checksum> parse_checksum(std::string_view name) noexcept {
  constexpr std::pair<std::string_view, Checksum> kKnown[] = {
      {"none", Checksum::none},
      {"xor", Checksum::xor8},
      {"sum", Checksum::sum8},
      {"crc16-modbus", Checksum::crc16_modbus},
      {"crc16-ccitt", Checksum::crc16_ccitt},
      {"crc32", Checksum::crc32},
  };
  for (const auto& [known, kind] : kKnown) {
    if (known == name) return kind;
  }
  return std::nullopt;
}

std::size_t bytes_of(Checksum kind) noexcept {
  switch (kind) {
    case Checksum::none: return 0;
    case Checksum::xor8:
    case Checksum::sum8: return 1;
    case Checksum::crc16_modbus:
    case Checksum::crc16_ccitt: return 2;
    case Checksum::crc32: return 4;
  }
  return 0;
}

std::uint32_t checksum(Checksum kind, std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t sum = 0;
  switch (kind) {
    case Checksum::none: break;
    case Checksum::xor8:
      for (const std::uint8_t byte : bytes) sum ^= byte;
      break;
    case Checksum::sum8:
      for (const std::uint8_t byte : bytes) sum = (sum + byte) & 0xffU;
      break;
    case Checksum::crc16_modbus: return crc<Modbus>(bytes);
    case Checksum::crc16_ccitt: return crc<Ccitt>(bytes);
    case Checksum::crc32: return crc<boost::crc_32_type>(bytes);
  }
  return sum;
}

} // namespace scansion::stream
