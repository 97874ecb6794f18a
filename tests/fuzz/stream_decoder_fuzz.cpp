// The stream decoder on any bytes, in pieces. First byte: description of the stream and size of the pieces.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/stream/decoder.hpp"
#include "tests/fuzz/decoder_fuzz.hpp"

namespace {

using namespace scansion;

stream::Plan plan_of(unsigned kind) {
  OptionValues values;
  for (const Option& row : stream::rows()) {
    if (const auto* text = std::get_if<std::string_view>(&row.standard)) values.set(row.key, std::string(*text));
    if (const auto* whole = std::get_if<std::int64_t>(&row.standard)) values.set(row.key, *whole);
    if (const auto* real = std::get_if<double>(&row.standard)) values.set(row.key, *real);
  }
  const auto set = [&](const char* key, const char* text) { values.set(key, std::string(text)); };
  if (kind == 0) set("fields", "line x z"), set("checksum", "xor"), values.set("pause_ms", std::int64_t{3});
  if (kind == 2) set("break", "reversal"), set("null", "-1");
  if (kind >= 3) set("format", "binary");
  if (kind == 3)
    set("fields", "line:u16le x:i32le*0.05 z:i16le*0.0005 bad:u8"), set("sync", "AA 55"), set("checksum", "sum"),
        values.set("checksum_from", std::int64_t{2});
  if (kind == 4) set("fields", "x:f32le z:f64le"), set("break", "points"), values.set("points", std::int64_t{1});
  return stream::make_plan(values).assume_value();
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 1) return 0;
  LinkCounters counters;
  const stream::Plan plan = plan_of((data[0] & 7U) % 5U);
  stream::StreamDecoder decoder(counters, plan, stream::RecordReader::create(plan).assume_value());
  test::feed(decoder, counters, {data + 1, size - 1}, 1U + (data[0] >> 3U), size, [] { return true; });
  return 0;
}
