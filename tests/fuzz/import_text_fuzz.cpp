// Text of points as xyz, CSV and by content. First byte: options; second: format.
// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/import_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace scansion;
  if (size < 2) return 0;
  constexpr std::array<ImportFormat, 3> kFormats{ImportFormat::xyz, ImportFormat::csv, ImportFormat::automatic};
  const std::span<const std::uint8_t> bytes(data, size);
  fuzz::import_bytes(bytes.subspan(2), fuzz::options_of(bytes[0], kFormats[bytes[1] % kFormats.size()]));
  return 0;
}
