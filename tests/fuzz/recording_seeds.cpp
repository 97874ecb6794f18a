// Writes small recordings of every kind into a folder, as seeds for fuzzing and samples for other readers.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/record/real_groups.hpp"

#include <cstdio>
#include <filesystem>

using namespace scansion;

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: recording_seeds FOLDER\n");
    return 2;
  }
  std::error_code error;
  std::filesystem::create_directories(argv[1], error);
  int written = 0;
  for (const std::uint32_t levels : {1U, 3U})
    for (const std::uint32_t groups : {0U, 1U, 3U})
      for (const bool finish : {false, true}) {
        RecordingFacts facts;
        facts.device = "seed";
        facts.stream = 7;
        facts.levels.count = levels;
        facts.level_count = levels;
        facts.stored_levels = groups == 3 && levels == 3 && !finish ? 2 : levels + 1;
        facts.lattice.resolution = {1, 200};
        const std::string path = std::string(argv[1]) + "/seed" + std::to_string(written++) + ".mcap";
        std::filesystem::remove(path, error);
        if (!synthetic::write_real(path, facts, synthetic::real_groups(facts, groups, 5, 12), finish)) {
          std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
          return 1;
        }
      }
  return 0;
}
