// The Gocator decoder on any bytes, in pieces. First byte: lattice and size of the pieces.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/lmi-gocator/decoder.hpp"
#include "tests/fuzz/decoder_fuzz.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace scansion;
  if (size < 1) return 0;
  LinkCounters counters;
  OptionValues values;
  GocatorDecoder decoder(counters, {}, LineSpacing::create(values).assume_value());
  if ((data[0] & 1U) != 0) decoder.set_count_nm(1000, (data[0] & 2U) != 0);
  test::feed(decoder, counters, {data + 1, size - 1}, 1U + (data[0] >> 2U), GocatorDecoder::kMaxWidth, [&] {
    if (decoder.refusal().empty()) decoder.set_count_nm(1, false);
    return decoder.refusal().empty();
  });
  return 0;
}
