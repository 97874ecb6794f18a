// Points with their patches as files.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/export/patch_writer.hpp"

#include "pipeline/export/feature_writer.hpp"
#include "pipeline/record/notes.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>

namespace scansion {
namespace {

constexpr std::array<std::string_view, 4> kFormats{"txt", "csv", "ply", "json"};
constexpr std::size_t kRow = 3 * ValueFormat::kMaxText + 64;
constexpr std::size_t kCountDigits = 20;

class PatchWriter : public PointWriter {
public:
  PatchWriter(const ValueFormat& values, PointStyle style, const Findings& findings)
      : values_(values), style_(std::move(style)), findings_(findings), cursor_(findings.runs) {}

  [[nodiscard]] Result<void> line(OutputFile& file, std::uint64_t index, const LineGroup& group,
                                  std::span<const std::uint32_t> points) override {
    const ScanLine& line = group.lines[index - group.lines.front().index];
    const std::uint32_t first = group.runs_of(line).front().first;
    for (const std::uint32_t p : points) {
      SCANSION_TRY(to, file.reserve(kRow));
      file.advance(static_cast<std::size_t>(put(to, group, p, index, cursor_.patch(index, p - first)) - to));
    }
    return success();
  }
  [[nodiscard]] Result<void> end(OutputFile&) override { return success(); }

protected:
  [[nodiscard]] virtual char* put(char* to, const LineGroup& group, std::uint32_t point, std::uint64_t line,
                                  std::int64_t patch) = 0;

  [[nodiscard]] char* put_text(char* to, const LineGroup& group, std::uint32_t point, char between) const noexcept {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      to = values_.write(to, axis, group.xyz[axis][point], ulp_of(group, axis, point));
      *to++ = between;
    }
    return to;
  }
  [[nodiscard]] static char* put_number(char* to, std::int64_t value) noexcept { return std::to_chars(to, to + 24, value).ptr; }

  ValueFormat values_;
  PointStyle style_;
  const Findings& findings_;
  PatchCursor cursor_;
};

class TextPatches final : public PatchWriter {
public:
  using PatchWriter::PatchWriter;
  [[nodiscard]] Result<void> begin(OutputFile&) override { return success(); }

protected:
  char* put(char* to, const LineGroup& group, std::uint32_t point, std::uint64_t, std::int64_t patch) override {
    to = put_number(put_text(to, group, point, ' '), patch);
    *to++ = '\n';
    return to;
  }
};

class CsvPatches final : public PatchWriter {
public:
  using PatchWriter::PatchWriter;
  [[nodiscard]] Result<void> begin(OutputFile& file) override { return file.append("x,y,z,line,patch\n"); }

protected:
  char* put(char* to, const LineGroup& group, std::uint32_t point, std::uint64_t line, std::int64_t patch) override {
    to = put_number(put_text(to, group, point, ','), static_cast<std::int64_t>(line));
    *to++ = ',';
    to = put_number(to, patch);
    *to++ = '\n';
    return to;
  }
};

/// Binary, little endian, coloured by patch.
class PlyPatches final : public PatchWriter {
public:
  using PatchWriter::PatchWriter;
  [[nodiscard]] Result<void> begin(OutputFile& file) override {
    const std::string type = style_.single ? "float" : "double";
    const std::string head = "ply\nformat binary_little_endian 1.0\ncomment scansion patches, unit " +
                             std::string(name(style_.unit)) + "\nelement vertex ";
    count_at_ = head.size();
    return file.append(
        head + std::string(kCountDigits, '0') + "\nproperty " + type + " x\nproperty " + type + " y\nproperty " + type +
        " z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty int patch\nproperty uint line\n"
        "end_header\n");
  }
  [[nodiscard]] Result<void> end(OutputFile& file) override {
    std::string count = std::to_string(count_);
    count.insert(0, kCountDigits - count.size(), '0');
    return file.patch(count_at_, count);
  }

protected:
  char* put(char* to, const LineGroup& group, std::uint32_t point, std::uint64_t line, std::int64_t patch) override {
    ++count_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double value = values_.value(axis, group.xyz[axis][point], ulp_of(group, axis, point));
      to = style_.single ? put_raw(to, static_cast<float>(value)) : put_raw(to, value);
    }
    for (const std::uint8_t part : patch_colour(patch)) to = put_raw(to, part);
    return put_raw(put_raw(to, static_cast<std::int32_t>(patch)), static_cast<std::uint32_t>(line));
  }

private:
  static_assert(std::endian::native == std::endian::little);
  template <class T>
  [[nodiscard]] static char* put_raw(char* to, T value) noexcept {
    std::memcpy(to, &value, sizeof value);
    return to + sizeof value;
  }
  std::uint64_t count_ = 0;
  std::size_t count_at_ = 0;
};

/// What patches and forms there are, then a row for each point.
class JsonPatches final : public PatchWriter {
public:
  using PatchWriter::PatchWriter;
  [[nodiscard]] Result<void> begin(OutputFile& file) override {
    std::string text = "{\"unit\":\"" + std::string(name(style_.unit)) + "\",\"patches\":[";
    for (const Patch& patch : findings_.patches) {
      text += (&patch == &findings_.patches.front() ? "\n" : ",\n") + ("{\"id\":" + std::to_string(patch.id)) +
              ",\"label\":\"" + std::string(name(patch.label)) + "\",\"shape\":\"" + std::string(name(patch.shape)) +
              "\",\"samples\":" + std::to_string(patch.samples) + "}";
    }
    const double mm_per_unit = millimetres(style_.unit).value();
    text += "],\"forms\":[";
    for (const Form& form : findings_.forms) {
      text += &form == &findings_.forms.front() ? "\n" : ",\n";
      append_form(text, form, mm_per_unit);
    }
    return file.append(text + "],\"points\":[");
  }
  [[nodiscard]] Result<void> end(OutputFile& file) override { return file.append("]}\n"); }

protected:
  char* put(char* to, const LineGroup& group, std::uint32_t point, std::uint64_t line, std::int64_t patch) override {
    if (!first_) *to++ = ',';
    first_ = false;
    *to++ = '\n';
    *to++ = '[';
    to = put_number(put_text(to, group, point, ','), static_cast<std::int64_t>(line));
    *to++ = ',';
    to = put_number(to, patch);
    *to++ = ']';
    return to;
  }

private:
  bool first_ = true;
};

} // namespace

std::int64_t PatchCursor::patch(std::uint64_t line, std::uint32_t index) noexcept {
  const auto before = [&](const PatchRun& run) {
    return run.line < line || (run.line == line && run.first + run.count <= index);
  };
  if (at_ < runs_.size() && before(runs_[at_]) && runs_[at_].line < line) { // a line ahead, perhaps many of them
    const auto next = std::partition_point(runs_.begin() + static_cast<std::ptrdiff_t>(at_), runs_.end(),
                                           [&](const PatchRun& run) { return run.line < line; });
    at_ = static_cast<std::size_t>(next - runs_.begin());
  }
  while (at_ < runs_.size() && before(runs_[at_])) ++at_;
  if (at_ == runs_.size()) return -1;
  const PatchRun& run = runs_[at_];
  return run.line == line && run.first <= index ? std::int64_t{run.patch} : -1;
}

Result<PatchFormat> parse_patch_format(std::string_view name) {
  const auto found = std::ranges::find(kFormats, name);
  if (found != kFormats.end()) return static_cast<PatchFormat>(found - kFormats.begin());
  return fail(Errc::usage, "patches are not written as '", name, "'; take --format txt, csv, ply or json");
}

bool needs_patching(PatchFormat format) noexcept {
  return format == PatchFormat::ply;
}

std::unique_ptr<PointWriter> make_patch_writer(PatchFormat format, const ValueFormat& values, const PointStyle& style,
                                               const Findings& findings) {
  switch (format) {
    case PatchFormat::txt: return std::make_unique<TextPatches>(values, style, findings);
    case PatchFormat::csv: return std::make_unique<CsvPatches>(values, style, findings);
    case PatchFormat::ply: return std::make_unique<PlyPatches>(values, style, findings);
    case PatchFormat::json: return std::make_unique<JsonPatches>(values, style, findings);
  }
  return nullptr;
}

} // namespace scansion
