// The lines of a device's newest run.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/journal/earlier_scan.hpp"

#include "pipeline/record/reader.hpp"

#include <algorithm>
#include <filesystem>

namespace scansion {
namespace {

/// One file's lines, from its first one as far as none is missing.
struct Part {
  Lattice lattice;
  std::uint64_t first = 0;
  std::vector<LineBuffer> lines;
};

LineBuffer copy_line(const LineGroup& group, const ScanLine& line) {
  LineBuffer out;
  out.stamps = line.stamps;
  out.plane = line.plane;
  out.invalid_after = line.invalid_after;
  for (Run run : group.runs_of(line)) {
    const std::uint32_t from = run.first;
    run.first = static_cast<std::uint32_t>(out.points());
    out.runs.push_back(run);
    for (std::size_t axis = 0; axis < out.xyz.size(); ++axis) {
      const auto begin = group.xyz[axis].begin() + from;
      out.xyz[axis].insert(out.xyz[axis].end(), begin, begin + run.count);
    }
  }
  return out;
}

Result<std::optional<Part>> read_part(const std::string& path, std::string_view device, std::size_t most) {
  SCANSION_TRY(reader, RecordingReader::open(path));
  const RecordingFacts& facts = reader.facts();
  if (facts.device != device || facts.stored_levels != facts.level_count + 1) return std::optional<Part>();
  Part part;
  part.lattice = facts.lattice;
  DecodedGroup decoded;
  for (std::size_t i = 0; i < reader.groups().size(); ++i) {
    SCANSION_TRY(reader.read_group(i, facts.level_count, decoded));
    for (const ScanLine& line : decoded.group.lines) {
      if (part.lines.empty()) part.first = line.index;
      if (line.index != part.first + part.lines.size() || part.lines.size() >= most) return std::optional(std::move(part));
      part.lines.push_back(copy_line(decoded.group, line));
    }
  }
  return part.lines.empty() ? std::optional<Part>() : std::optional(std::move(part));
}

/// <device>-<time>-<number>.mcap, newest first.
Result<std::vector<std::string>> files_of(const JournalDirectory& directory, std::string_view device) {
  constexpr std::size_t kStamp = std::string_view("-20240517T083000Z-001.mcap").size();
  std::vector<std::string> out;
  std::error_code error;
  for (auto at = std::filesystem::directory_iterator(directory.path(), error);
       !error && at != std::filesystem::directory_iterator(); at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (name.starts_with(device) && name.ends_with(".mcap") && name.size() >= device.size() + kStamp)
      out.push_back(at->path().string());
  }
  if (error) return system_error(directory.path() + ": cannot be listed", error.value());
  std::sort(out.rbegin(), out.rend());
  return out;
}

} // namespace

Result<std::optional<EarlierScan>> find_earlier_scan(const JournalDirectory& directory, std::string_view device,
                                                     std::size_t most) {
  SCANSION_TRY(files, files_of(directory, device));
  std::optional<EarlierScan> out;
  std::uint64_t first = 0; // of what was found so far
  for (const std::string& file : files) {
    SCANSION_TRY(part, read_part(file, device, most));
    if (!part) continue;
    if (!out) {
      out.emplace(EarlierScan{file, part->lattice, std::move(part->lines)});
    } else {
      const bool continues = part->lattice == out->lattice && part->first + part->lines.size() == first;
      if (!continues) return std::optional<EarlierScan>();
      part->lines.insert(part->lines.end(), std::make_move_iterator(out->lines.begin()),
                         std::make_move_iterator(out->lines.end()));
      out->lines = std::move(part->lines);
    }
    first = part->first;
    if (first == 0) break;
  }
  if (first != 0) return std::optional<EarlierScan>();
  return out;
}

} // namespace scansion
