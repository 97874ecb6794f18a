// Opens, reads and verifies whatever the file holds. What verify calls sound must read to the last point and feature line.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/findings.hpp"
#include "pipeline/record/repair.hpp"
#include "tests/fuzz/recording_input.hpp"

using namespace scansion;

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed) {
  return fuzz::mutate_recording(data, size, max_size, seed);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file(data, size);
  const auto report = verify(file.path());
  const bool sound = report && report.value().sound;

  auto reader = RecordingReader::open(file.path());
  if (!reader) {
    if (sound) std::abort();
    return 0;
  }
  if (sound && (!reader.value().complete() || reader.value().groups().size() != report.value().groups)) std::abort();
  DecodedGroup group;
  Bytes payload;
  for (std::size_t i = 0; i < reader.value().groups().size(); ++i) {
    for (std::size_t k = 0; k < reader.value().groups()[i].payloads.size(); ++k) {
      const auto header = reader.value().read_header(i, k);
      const auto raw = reader.value().read_payload(i, k, payload);
      if (sound && !(header && raw)) std::abort();
    }
    const auto decoded = reader.value().read_group(i, kMaxLevels, group);
    if (sound && !decoded) std::abort();
  }
  const auto found = read_findings(reader.value());
  if (sound && !found) std::abort();
  return 0;
}
