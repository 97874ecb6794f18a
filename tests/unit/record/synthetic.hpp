// Small recordings of sealed payloads with made-up bodies: the container is tested without the codec.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/group_check.hpp"
#include "pipeline/record/reader.hpp"
#include "pipeline/record/repair_steps.hpp"
#include "pipeline/record/writer.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace scansion::synthetic {

/// Without optimisation the sweeps over every byte would take minutes: there they leave out what is like its neighbours.
#ifdef __OPTIMIZE__
inline constexpr bool kThorough = true;
#else
inline constexpr bool kThorough = false;
#endif

/// A folder that is removed with everything in it. In memory where the machine has a place for that.
class Folder {
public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string operator/(std::string_view name) const { return path_ + "/" + std::string(name); }
  [[nodiscard]] std::vector<std::string> names() const;

private:
  std::string path_;
};

[[nodiscard]] Bytes read_file(const std::string& path);
void write_file(const std::string& path, ByteView bytes);

[[nodiscard]] RecordingFacts facts(std::uint32_t levels = 3);

/// `lines` lines from `first`; bodies of about `size` bytes that differ from group to group.
[[nodiscard]] EncodedGroup group(const RecordingFacts& f, std::uint32_t number, std::uint64_t first, std::uint16_t lines,
                                 std::size_t size = 120);
[[nodiscard]] std::uint64_t points(const EncodedGroup& g);
/// What the made-up bodies are taken to hold: as many runs as lines, and the group's number modulo 3 invalid samples.
[[nodiscard]] GroupCounts counts(const EncodedGroup& g);
[[nodiscard]] GroupInspector inspector();

void append(RecordingWriter& writer, const EncodedGroup& g);

struct Plan {
  std::uint32_t groups = 3;
  std::uint16_t lines = 64;
  std::size_t body = 120;
  bool gap_after_first = false; ///< lines between group 0 and 1 are missing, and a gap message says so
  bool finish = true;
  ChunkRule rule = ChunkRule::each_group; ///< with many_groups Made knows no places in the file
  RecordingFacts facts = synthetic::facts();
};

/// Where things stand in a recording that was made; ends are exclusive.
struct Made {
  std::vector<EncodedGroup> groups;
  std::uint64_t head = 0;
  std::vector<std::uint64_t> payloads_end; ///< of group i: its last payload byte
  std::vector<std::uint64_t> block_end;    ///< of group i: its message indexes
  std::uint64_t data_end = 0;              ///< last block or copy of the facts
  std::uint64_t size = 0;
};
Made make(const std::string& path, const Plan& plan);

#define ASSERT_OK(expression)                                                                                                  \
  do {                                                                                                                         \
    const auto& ok_result = (expression);                                                                                      \
    ASSERT_TRUE(ok_result.has_value()) << ok_result.error().context;                                                           \
  } while (false)
#define EXPECT_OK(expression)                                                                                                  \
  do {                                                                                                                         \
    const auto& ok_result = (expression);                                                                                      \
    EXPECT_TRUE(ok_result.has_value()) << ok_result.error().context;                                                           \
  } while (false)

} // namespace scansion::synthetic
