// A folder for files that are gone afterwards.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/scratch.hpp"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace scansion::bench {

ScratchFolder::ScratchFolder() {
  const char* temporary = std::getenv("TMPDIR");
  path_ = std::string(temporary != nullptr && *temporary != '\0' ? temporary : "/tmp") + "/scansion-bench-XXXXXX";
  if (::mkdtemp(path_.data()) == nullptr) {
    std::perror("scansion_bench: cannot make a folder for temporary files");
    std::_Exit(73);
  }
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

bool write_file(const std::string& path, const std::string& text) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return false;
  const bool whole = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  return std::fclose(file) == 0 && whole;
}

} // namespace scansion::bench
