// PLY files. First byte: options.
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/import_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace scansion;
  if (size < 1) return 0;
  const std::span<const std::uint8_t> bytes(data, size);
  fuzz::import_bytes(bytes.subspan(1), fuzz::options_of(static_cast<std::uint8_t>(bytes[0] & 0x3FU), ImportFormat::ply));
  return 0;
}
