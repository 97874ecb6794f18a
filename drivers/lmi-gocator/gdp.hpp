// The bytes of LMI's Gocator Data Protocol (GDP) that carry profiles; README.md draws them. Driver and simulator share this
// page.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace scansion::gdp {

enum class Type : std::uint16_t {
  stamp = 1,
  range = 3,
  point_cloud_profile = 5, ///< pairs of x and z
  uniform_profile = 6,     ///< z at even x
  uniform_surface = 8,
  surface_point_cloud = 28
};
inline constexpr std::uint16_t kLastOfGroup = 0x8000; ///< in the control field; the rest is the type
inline constexpr std::uint16_t kTypes = 64;           ///< types are below this; the newest documented one is 31
inline constexpr std::int16_t kNull = -32768;         ///< a sample without a value

// Offsets from the first byte of a message.
inline constexpr std::size_t kHead = 6; ///< size u32, control u16
inline constexpr std::size_t kStampHead = 14;
inline constexpr std::size_t kOldStamp = 56, kStamp = 64; ///< bytes of a stamp: shortest, current (with PTP time)
inline constexpr std::size_t kProfileHead = 16;           ///< up to the width, with which the size is known
inline constexpr std::size_t kAttributes = 8;             ///< where the attributes begin, whose size stands before them
inline constexpr std::size_t kOldAttributes = 32, kCurrentAttributes = 48;
inline constexpr std::int32_t kToolStep = 8; ///< stream step of profiles that a measuring tool made

template <std::integral T>
[[nodiscard]] constexpr T get(const std::uint8_t* at) noexcept {
  std::make_unsigned_t<T> value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    value = static_cast<std::make_unsigned_t<T>>(value | (static_cast<std::make_unsigned_t<T>>(at[i]) << (8U * i)));
  }
  return static_cast<T>(value);
}

template <std::integral T>
void put(std::vector<std::uint8_t>& out, T value) {
  const auto bits = static_cast<std::make_unsigned_t<T>>(value);
  for (std::size_t i = 0; i < sizeof(T); ++i) out.push_back(static_cast<std::uint8_t>(bits >> (8U * i)));
}

struct Stamp {
  std::uint64_t frame = 0;
  std::uint64_t time_us = 0;
  std::int64_t encoder = 0;

  friend bool operator==(const Stamp&, const Stamp&) = default;
};

/// The attributes of a profile message that matter here.
struct Profile {
  Type type = Type::point_cloud_profile;
  std::uint32_t count = 0, width = 0; ///< profiles, samples in each
  std::uint32_t x_nm = 0, z_nm = 0;   ///< scales
  std::int32_t x_um = 0, z_um = 0;    ///< offsets
  std::uint8_t source = 0;            ///< 0 top, 1 bottom, 2 top left, 3 top right
  std::uint8_t camera = 0;            ///< always 0 in uniform profiles
  std::int32_t step = 0;              ///< stream step, 0 when it is not told
  std::size_t samples_at = 0;         ///< offset of the samples
  [[nodiscard]] std::size_t sample_bytes() const noexcept { return type == Type::point_cloud_profile ? 4 : 2; }
};

} // namespace scansion::gdp
