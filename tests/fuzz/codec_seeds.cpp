// Writes seed inputs for codec_fuzz: groups of random lines and of those that have a way of coding for themselves. codec_seeds
// FOLDER
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/pipeline.hpp"
#include "tests/property/lines.hpp"

#include <fstream>

int main(int argc, char** argv) {
  using namespace scansion;
  if (argc != 2) return 2;
  test::Random random(1);
  for (int i = 0; i < 52; ++i) {
    LineGroup group;
    if (i < 40)
      for (std::uint64_t l = 0; l < 4; ++l) append_line(group, l, test::make_line(random, 2, 40, i % 3 == 0));
    else
      group = test::make_special(random, static_cast<test::Special>(i % static_cast<int>(test::Special::specials)), 12, 60);
    Pipeline pipeline(LevelSpec{}, Rational{1, 1000}, 5);
    EncodedGroup encoded;
    pipeline.process(group, encoded);
    std::ofstream file(std::string(argv[1]) + "/" + std::to_string(i), std::ios::binary);
    for (const Bytes& payload : encoded.payloads) {
      file.put(static_cast<char>(payload.size() & 0xFFU));
      file.put(static_cast<char>(payload.size() >> 8U));
      file.write(reinterpret_cast<const char*>(payload.data()), static_cast<std::streamsize>(payload.size()));
    }
  }
  return 0;
}
