// Little-endian reads and writes on byte buffers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <boost/endian/conversion.hpp>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace scansion {

template <class T>
[[nodiscard]] T load_le(const std::byte* from) noexcept {
  return boost::endian::endian_load<T, sizeof(T), boost::endian::order::little>(reinterpret_cast<const unsigned char*>(from));
}
template <class T>
void store_le(std::byte* to, T value) noexcept {
  boost::endian::endian_store<T, sizeof(T), boost::endian::order::little>(reinterpret_cast<unsigned char*>(to), value);
}
template <class T>
void append_le(std::vector<std::byte>& to, T value) {
  const std::size_t at = to.size();
  to.resize(at + sizeof(T));
  store_le(to.data() + at, value);
}

} // namespace scansion
