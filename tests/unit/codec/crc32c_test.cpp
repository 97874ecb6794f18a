// CRC-32C and the payload header.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/codec/crc32c.hpp"

#include "pipeline/codec/payload.hpp"

#include <gtest/gtest.h>
#include <random>
#include <string_view>

namespace scansion {
namespace {

std::uint32_t crc_of(std::string_view text) {
  return crc32c(0, std::as_bytes(std::span(text)));
}

TEST(Crc32c, KnownValues) {
  EXPECT_EQ(crc_of(""), 0U);
  EXPECT_EQ(crc_of("123456789"), 0xE3069283U);
  const std::vector<std::byte> zeros(32, std::byte{0});
  EXPECT_EQ(crc32c(0, zeros), 0x8A9136AAU); // RFC 3720, B.4
}

TEST(Crc32c, InstructionAndTablesAgreeInAnyPieces) {
  std::mt19937 random(1);
  std::vector<std::byte> bytes(1000);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  for (std::size_t n = 0; n < bytes.size(); n += 13) {
    const auto all = std::span(bytes).first(n);
    EXPECT_EQ(crc32c(0, all), crc32c_portable(0, all));
    EXPECT_EQ(crc32c(crc32c(0, all.first(n / 3)), all.subspan(n / 3)), crc32c(0, all));
  }
}

TEST(Payload, HeaderComesBackAndEveryFlippedBitIsFound) {
  const Bytes body(20, std::byte{0x5A});
  const PayloadHeader header{.kind = PayloadKind::level,
                             .level = 1,
                             .levels = 3,
                             .stream = 0x12345678,
                             .group = 9,
                             .line_count = 64,
                             .epoch = 2,
                             .first_line = 576,
                             .first_time_ns = 1,
                             .last_time_ns = 2,
                             .tolerance = 0.25,
                             .left_out = 0.125,
                             .points = 1000,
                             .body_size = 20};
  Bytes payload;
  seal_payload(header, body, payload);
  EXPECT_EQ(payload.size(), payload_size(header));
  const auto read = check_payload(payload);
  ASSERT_TRUE(read) << read.error().context;
  EXPECT_EQ(read.value(), header);
  for (std::size_t bit = 0; bit < payload.size() * 8; ++bit) {
    Bytes damaged = payload;
    damaged[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
    EXPECT_FALSE(check_payload(damaged)) << "bit " << bit;
  }
  for (std::size_t size = 0; size < payload.size(); ++size) EXPECT_FALSE(check_payload(ByteView(payload).first(size)));
}

} // namespace
} // namespace scansion
