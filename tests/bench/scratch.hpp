// A folder for files that are gone afterwards.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace scansion::bench {

/// Made in TMPDIR; removed with everything in it.
class ScratchFolder {
public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }

private:
  std::string path_;
};

/// False when the file cannot be written whole.
[[nodiscard]] bool write_file(const std::string& path, const std::string& text);

} // namespace scansion::bench
