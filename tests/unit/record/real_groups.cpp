// Made-up scan lines, ranked and encoded.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/record/real_groups.hpp"

#include "pipeline/pipeline.hpp"
#include "pipeline/record/writer.hpp"

#include <random>

namespace scansion::synthetic {
namespace {

LineBuffer make_line(std::mt19937& random, std::uint64_t index, std::uint32_t points) {
  LineBuffer line;
  if (random() % 3 != 0)
    line.stamps.host_realtime_ns = static_cast<std::int64_t>(1'700'000'000'000'000'000U + index * 5'000'000U);
  if (random() % 2 != 0) line.stamps.encoder = static_cast<std::int64_t>(index) * 40;
  const std::uint32_t runs = points == 0 ? 0 : static_cast<std::uint32_t>(1 + random() % 3);
  std::int32_t z = 5000;
  for (std::uint32_t r = 0; r < runs; ++r) {
    const auto first = static_cast<std::uint32_t>(line.points());
    const std::uint32_t count = std::max<std::uint32_t>(1, points / runs);
    for (std::uint32_t k = 0; k < count; ++k) {
      if (random() % 20 == 0) z += static_cast<std::int32_t>(random() % 2001) - 1000;
      line.xyz[0].push_back(static_cast<std::int32_t>((first + k) * 10));
      line.xyz[1].push_back(static_cast<std::int32_t>(index * 25));
      line.xyz[2].push_back(z + static_cast<std::int32_t>(random() % 5));
    }
    line.runs.push_back({first, count, r == 0 ? 0 : 1 + static_cast<std::uint32_t>(random() % 4)});
  }
  line.invalid_after = static_cast<std::uint32_t>(random() % 4);
  return line;
}

} // namespace

std::vector<RealGroup> real_groups(const RecordingFacts& facts, std::uint32_t count, std::uint32_t lines,
                                   std::uint32_t points_per_line) {
  std::mt19937 random(facts.stream + 5);
  const auto resolution = resolution_mm(facts.lattice);
  if (!resolution) return {};
  Pipeline pipeline(facts.levels, resolution.value(), facts.stream);
  std::vector<RealGroup> groups(count);
  std::uint64_t index = 0;
  for (std::uint32_t g = 0; g < count; ++g) {
    RealGroup& group = groups[g];
    group.lines.number = g;
    if (g == 1) index += 3; // write_real tells of them
    for (std::uint32_t l = 0; l < lines; ++l, ++index) {
      const LineBuffer line = make_line(random, index, l % 7 == 6 ? 0 : points_per_line);
      for (const Run& run : line.runs) group.invalid += run.invalid_before;
      group.invalid += line.invalid_after;
      group.runs += line.runs.size();
      append_line(group.lines, index, line);
    }
    pipeline.process(group.lines, group.encoded);
  }
  return groups;
}

bool write_real(const std::string& path, const RecordingFacts& facts, const std::vector<RealGroup>& groups, bool finish) {
  auto writer = RecordingWriter::create(path, facts);
  if (!writer) return false;
  for (const RealGroup& group : groups) {
    if (group.encoded.number == 1 && !writer.value().append(Gap{group.encoded.first_line - 3, 3, "belt stopped"}, 1))
      return false;
    EncodedGroup stored = group.encoded;
    stored.payloads.resize(facts.stored_levels + 1);
    if (!writer.value().append(stored, group.lines.points(), group.runs, group.invalid)) return false;
  }
  return !finish || writer.value().finish(std::nullopt, 0.0).has_value();
}

} // namespace scansion::synthetic
