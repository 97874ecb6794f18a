// Recovers and finishes whatever the file holds. What comes out must be sound and hold as much as was reported.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/repair.hpp"
#include "tests/fuzz/recording_input.hpp"

#include <filesystem>

using namespace scansion;

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned seed) {
  return fuzz::mutate_recording(data, size, max_size, seed);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string output =
      (std::filesystem::is_directory("/dev/shm") ? std::string("/dev/shm") : std::filesystem::temp_directory_path().string()) +
      "/scansion-recover-fuzz-" + std::to_string(::getpid());
  const fuzz::MemoryFile file(data, size);
  const auto before = verify(file.path());
  ::unlink(output.c_str());
  const auto recovered = recover(file.path(), output);
  if (recovered) {
    const auto after = verify(output);
    if (!after || !after.value().sound || after.value().groups != recovered.value().groups) std::abort();
    if (before && before.value().groups > recovered.value().groups) std::abort(); // what verify counts as whole comes back
    if (before && before.value().sound && recovered.value().anything_lost()) std::abort();
  } else if (before && before.value().sound) {
    std::abort();
  }
  ::unlink(output.c_str());

  const auto finished = finish_in_place(file.path());
  if (finished) {
    const auto after = verify(file.path());
    if (!after || (before && after.value().groups < before.value().groups)) std::abort();
  }
  return 0;
}
