// Making small recordings.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/record/synthetic.hpp"

#include "pipeline/record/layout.hpp"
#include "pipeline/record/metadata.hpp"

#include <filesystem>
#include <fstream>
#include <random>
#include <unistd.h>

namespace scansion::synthetic {

Folder::Folder() {
  const std::filesystem::path base =
      std::filesystem::is_directory("/dev/shm") ? std::filesystem::path("/dev/shm") : std::filesystem::temp_directory_path();
  std::string name = (base / "scansion-record-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) std::abort();
  path_ = name;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> Folder::names() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path_)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

Bytes read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const ByteView view = std::as_bytes(std::span(text));
  return {view.begin(), view.end()};
}

void write_file(const std::string& path, ByteView bytes) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.close();
  ASSERT_TRUE(out.good());
}

RecordingFacts facts(std::uint32_t levels) {
  RecordingFacts f;
  f.device = "table-1";
  f.stream = 0xC0FFEE;
  f.lattice.resolution = {1, 200};
  f.lattice.origin = {-5, 0, 12345678901};
  f.levels.count = levels;
  f.level_count = levels;
  f.stored_levels = levels + 1;
  f.gap_mm = 2.5;
  f.started_ns = 1'700'000'000'000'000'000;
  return f;
}

EncodedGroup group(const RecordingFacts& f, std::uint32_t number, std::uint64_t first, std::uint16_t lines, std::size_t size) {
  std::mt19937 random(number * 7919U + 17U);
  EncodedGroup g;
  g.number = number;
  g.first_line = first;
  g.line_count = lines;
  g.first_time_ns = first * 1'000'000;
  g.last_time_ns = (first + lines - 1) * 1'000'000;
  for (std::uint32_t i = 0; i <= f.stored_levels; ++i) {
    PayloadHeader h;
    h.kind = i == 0 ? PayloadKind::lines : i <= f.level_count ? PayloadKind::level : PayloadKind::rest;
    h.level = static_cast<std::uint8_t>(i == 0 ? 0 : i - 1);
    h.levels = static_cast<std::uint8_t>(f.level_count);
    h.stream = f.stream;
    h.group = number;
    h.line_count = lines;
    h.first_line = first;
    h.first_time_ns = g.first_time_ns;
    h.last_time_ns = g.last_time_ns;
    h.tolerance = h.kind == PayloadKind::level ? 1.0 / (i + 1.0) : 0.0;
    h.points = i == 0 ? 1000 + number : 10;
    Bytes body(size + std::size_t{3} * i + number % 5);
    for (std::byte& b : body) b = static_cast<std::byte>(random());
    Bytes payload;
    seal_payload(h, body, payload);
    g.payloads.push_back(std::move(payload));
  }
  return g;
}

std::uint64_t points(const EncodedGroup& g) {
  return 1000 + g.number;
}
GroupCounts counts(const EncodedGroup& g) {
  return {g.line_count, g.number % 3};
}

GroupInspector inspector() {
  return [](std::span<const ByteView> payloads) -> Result<GroupCounts> {
    SCANSION_TRY(lines, parse_payload_header(payloads.front()));
    return GroupCounts{lines.line_count, lines.group % 3};
  };
}

void append(RecordingWriter& writer, const EncodedGroup& g) {
  const GroupCounts c = counts(g);
  ASSERT_OK(writer.append(g, points(g), c.runs, c.invalid));
}

Made make(const std::string& path, const Plan& plan) {
  auto created = RecordingWriter::create(path, plan.facts, plan.rule);
  if (!created) {
    ADD_FAILURE() << created.error().context;
    return {};
  }
  RecordingWriter& writer = created.value();
  Made made;
  made.head = writer.bytes();
  const std::uint64_t copy = facts_record(plan.facts).size();
  const std::uint64_t indexes = mcap::message_index_size(1) * payloads_per_group(plan.facts);
  std::uint64_t line = 0;
  for (std::uint32_t i = 0; i < plan.groups; ++i) {
    if (i == 1 && plan.gap_after_first) {
      EXPECT_OK(writer.append(Gap{line, 6, "the \"device\" said: \xC3\xBC"}, line * 1'000'000));
      line += 6;
    }
    made.groups.push_back(group(plan.facts, i, line, plan.lines, plan.body));
    append(writer, made.groups.back());
    made.block_end.push_back(writer.bytes() - (facts_due(i + 1) ? copy : 0));
    made.payloads_end.push_back(made.block_end.back() - indexes);
    line += plan.lines;
  }
  made.data_end = writer.bytes();
  if (plan.finish) EXPECT_OK(writer.finish(1'700'000'001'000'000'000, 0.25));
  made.size = writer.bytes();
  return made;
}

} // namespace scansion::synthetic
