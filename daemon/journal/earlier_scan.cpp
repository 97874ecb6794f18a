// The lines of the run of a device that came farthest.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/journal/earlier_scan.hpp"

#include "pipeline/record/reader.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <tuple>

namespace scansion {
namespace {

/// A recording file by its name, <device>-<time>-<number>.mcap.
struct FileName {
  std::string path;
  std::string time; ///< of its first line; sorts as it rises
  std::uint32_t number = 0;
};

/// One file's lines, from its first one as far as none is missing.
struct Part {
  std::string path;
  Lattice lattice;
  std::uint64_t first = 0, count = 0;
  std::int64_t begin_ns = 0, end_ns = 0; ///< realtime of the first and the last line
  [[nodiscard]] std::uint64_t end() const noexcept { return first + count; }
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

/// Looks at line tables only. Empty: another device's, not all levels, or no line.
Result<std::optional<Part>> look_into(const std::string& path, std::string_view device) {
  SCANSION_TRY(reader, RecordingReader::open(path));
  const RecordingFacts& facts = reader.facts();
  if (facts.device != device || facts.stored_levels != facts.level_count + 1) return std::optional<Part>();
  Part part{path, facts.lattice};
  DecodedGroup decoded;
  bool is_whole = true;
  for (std::size_t i = 0; i < reader.groups().size() && is_whole; ++i) {
    SCANSION_TRY(reader.read_lines(i, decoded));
    for (const ScanLine& line : decoded.group.lines) {
      const std::int64_t time = line.stamps.host_realtime_ns.value_or(0);
      if (part.count == 0) {
        part.first = line.index;
        part.begin_ns = time;
      }
      is_whole = line.index == part.end();
      if (!is_whole) break;
      ++part.count;
      part.end_ns = time;
    }
  }
  return part.count == 0 ? std::optional<Part>() : std::optional(std::move(part));
}

Result<void> read_lines(const Part& part, std::size_t most, std::vector<LineBuffer>& lines) {
  SCANSION_TRY(reader, RecordingReader::open(part.path));
  DecodedGroup decoded;
  for (std::size_t i = 0; i < reader.groups().size(); ++i) {
    SCANSION_TRY(reader.read_group(i, reader.facts().level_count, decoded));
    for (const ScanLine& line : decoded.group.lines) {
      if (line.index >= part.end() || lines.size() >= most) return success();
      lines.push_back(copy_line(decoded.group, line));
    }
  }
  return success();
}

std::optional<FileName> parse_name(const std::filesystem::path& path, std::string_view device) {
  constexpr std::string_view kStamp = "-20240517T083000Z-";
  const std::string name = path.filename().string();
  if (!name.starts_with(device) || !name.ends_with(".mcap") || name.size() <= device.size() + kStamp.size())
    return std::nullopt;
  FileName out{path.string(), name.substr(device.size() + 1, kStamp.size() - 2), 0};
  if (out.time[8] != 'T' || out.time.back() != 'Z') return std::nullopt; // of a device whose name begins like this one's
  const char* const digits = name.data() + device.size() + kStamp.size();
  if (std::from_chars(digits, name.data() + name.size(), out.number).ec != std::errc()) return std::nullopt;
  return out;
}

/// Newest first.
Result<std::vector<FileName>> files_of(const JournalDirectory& directory, std::string_view device) {
  std::vector<FileName> out;
  std::error_code error;
  for (auto at = std::filesystem::directory_iterator(directory.path(), error);
       !error && at != std::filesystem::directory_iterator(); at.increment(error)) {
    if (auto file = parse_name(at->path(), device)) out.push_back(std::move(*file));
  }
  if (error) return system_error(directory.path() + ": cannot be listed", error.value());
  std::sort(out.begin(), out.end(),
            [](const FileName& a, const FileName& b) { return std::tie(b.time, b.number) < std::tie(a.time, a.number); });
  return out;
}

/// All files that may hold lines of the newest scan: back to the newest one that begins with line 0, and those of its time.
/// A run that goes on with an interrupted scan begins with its first lines and their stamps, so it has the same time.
Result<std::vector<Part>> parts_of_newest_scan(const JournalDirectory& directory, std::string_view device) {
  SCANSION_TRY(files, files_of(directory, device));
  std::vector<Part> out;
  std::string_view begin; ///< time of the file with line 0
  for (const FileName& file : files) {
    if (!begin.empty() && file.time != begin) break;
    SCANSION_TRY(part, look_into(file.path, device));
    if (!part) continue;
    if (part->first == 0) begin = file.time;
    out.push_back(std::move(*part));
  }
  return out;
}

/// The one that ends where `next` begins; of several, which hold the same, the newest.
const Part* part_before(const std::vector<Part>& parts, const Part& next) {
  const Part* out = nullptr;
  for (const Part& part : parts) {
    if (part.end() != next.first || part.end_ns > next.begin_ns || !(part.lattice == next.lattice)) continue;
    if (out == nullptr || part.end_ns > out->end_ns) out = &part;
  }
  return out;
}

} // namespace

Result<std::optional<EarlierScan>> find_earlier_scan(const JournalDirectory& directory, std::string_view device,
                                                     std::size_t most) {
  SCANSION_TRY(parts, parts_of_newest_scan(directory, device));
  if (parts.empty()) return std::optional<EarlierScan>();
  // Not the newest file: a run that was stopped while it repeated lines of before has fewer than one of these.
  const auto farthest = std::max_element(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
    return std::pair(a.end_ns, a.end()) < std::pair(b.end_ns, b.end());
  });
  std::vector<const Part*> run{&*farthest};
  while (run.back()->first != 0) {
    const Part* const before = part_before(parts, *run.back());
    if (before == nullptr) return std::optional<EarlierScan>();
    run.push_back(before);
  }
  EarlierScan out{farthest->path, farthest->lattice, {}};
  for (auto part = run.rbegin(); part != run.rend(); ++part) {
    SCANSION_TRY(read_lines(**part, most, out.lines));
  }
  return std::optional(std::move(out));
}

} // namespace scansion
