// Points as text: xyz, csv, obj, json.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/export/point_writer.hpp"

#include <array>
#include <charconv>
#include <cstring>

namespace scansion {
namespace {

constexpr std::size_t kRow = 3 * ValueFormat::kMaxText + 32;

char* put(char* to, std::string_view text) noexcept {
  std::memcpy(to, text.data(), text.size());
  return to + text.size();
}

char* put(char* to, std::uint64_t number) noexcept {
  return std::to_chars(to, to + 20, number).ptr;
}

char* put_point(char* to, const ValueFormat& values, const LineGroup& group, std::uint32_t point, char between) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axis > 0) *to++ = between;
    to = values.write(to, axis, group.xyz[axis][point], ulp_of(group, axis, point));
  }
  return to;
}

class TextWriter : public PointWriter {
public:
  TextWriter(const ValueFormat& values, PointStyle style) : values_(values), style_(std::move(style)) {}
  [[nodiscard]] Result<void> end(OutputFile&) override { return success(); }

protected:
  ValueFormat values_;
  PointStyle style_;
  bool first_ = true;

  [[nodiscard]] std::string comment() const {
    return "# scansion points, unit " + std::string(name(style_.unit)) + (style_.remark.empty() ? "" : ", " + style_.remark) +
           "\n";
  }
};

class XyzWriter final : public TextWriter {
public:
  using TextWriter::TextWriter;
  [[nodiscard]] Result<void> begin(OutputFile& file) override { return file.append(comment()); }
  [[nodiscard]] Result<void> line(OutputFile& file, std::uint64_t, const LineGroup& group,
                                  std::span<const std::uint32_t> points) override {
    if (!first_) {
      SCANSION_TRY(file.append("\n"));
    }
    first_ = false;
    for (const std::uint32_t p : points) {
      SCANSION_TRY(to, file.reserve(kRow));
      char* end = put_point(to, values_, group, p, ' ');
      *end++ = '\n';
      file.advance(static_cast<std::size_t>(end - to));
    }
    return success();
  }
};

class CsvWriter final : public TextWriter {
public:
  using TextWriter::TextWriter;
  [[nodiscard]] Result<void> begin(OutputFile& file) override {
    SCANSION_TRY(file.append(comment()));
    return file.append("x,y,z,line\n");
  }
  [[nodiscard]] Result<void> line(OutputFile& file, std::uint64_t index, const LineGroup& group,
                                  std::span<const std::uint32_t> points) override {
    for (const std::uint32_t p : points) {
      SCANSION_TRY(to, file.reserve(kRow));
      char* end = put_point(to, values_, group, p, ',');
      *end++ = ',';
      end = put(end, index);
      *end++ = '\n';
      file.advance(static_cast<std::size_t>(end - to));
    }
    return success();
  }
};

class ObjWriter final : public TextWriter {
public:
  using TextWriter::TextWriter;
  [[nodiscard]] Result<void> begin(OutputFile& file) override { return file.append(comment()); }
  [[nodiscard]] Result<void> line(OutputFile& file, std::uint64_t, const LineGroup& group,
                                  std::span<const std::uint32_t> points) override {
    for (const std::uint32_t p : points) {
      SCANSION_TRY(to, file.reserve(kRow));
      char* end = put_point(put(to, "v "), values_, group, p, ' ');
      *end++ = '\n';
      file.advance(static_cast<std::size_t>(end - to));
    }
    SCANSION_TRY(file.append(points.size() > 1 ? "l" : "p"));
    for (std::size_t i = 0; i < points.size(); ++i) {
      SCANSION_TRY(to, file.reserve(kRow));
      *to = ' ';
      file.advance(static_cast<std::size_t>(put(to + 1, ++vertices_) - to));
    }
    return file.append("\n");
  }

private:
  std::uint64_t vertices_ = 0;
};

class JsonWriter final : public TextWriter {
public:
  using TextWriter::TextWriter;
  [[nodiscard]] Result<void> begin(OutputFile& file) override {
    return file.append("{\"unit\":\"" + std::string(name(style_.unit)) + "\",\"lines\":[");
  }
  [[nodiscard]] Result<void> line(OutputFile& file, std::uint64_t index, const LineGroup& group,
                                  std::span<const std::uint32_t> points) override {
    SCANSION_TRY(file.append((first_ ? "\n{\"index\":" : ",\n{\"index\":") + std::to_string(index) + ",\"points\":["));
    first_ = false;
    for (const std::uint32_t p : points) {
      SCANSION_TRY(to, file.reserve(kRow));
      char* end = put_point(put(to, p == points.front() ? "[" : ",["), values_, group, p, ',');
      *end++ = ']';
      file.advance(static_cast<std::size_t>(end - to));
    }
    return file.append("]}");
  }
  [[nodiscard]] Result<void> end(OutputFile& file) override { return file.append("\n]}\n"); }
};

} // namespace

Result<PointFormat> parse_point_format(std::string_view name) {
  struct Named {
    std::string_view name;
    PointFormat format;
  };
  constexpr std::array<Named, 7> kFormats{{{"xyz", PointFormat::xyz},
                                           {"txt", PointFormat::xyz},
                                           {"csv", PointFormat::csv},
                                           {"ply", PointFormat::ply},
                                           {"pcd", PointFormat::pcd},
                                           {"obj", PointFormat::obj},
                                           {"json", PointFormat::json}}};
  for (const Named& f : kFormats)
    if (f.name == name) return f.format;
  return fail(Errc::usage, "points cannot be written as '", name, "'; choose xyz, csv, ply, pcd, obj or json with --format");
}

bool needs_patching(PointFormat format) noexcept {
  return format == PointFormat::ply || format == PointFormat::pcd;
}

std::unique_ptr<PointWriter> make_point_writer(PointFormat format, const ValueFormat& values, const PointStyle& style) {
  switch (format) {
    case PointFormat::xyz: return std::make_unique<XyzWriter>(values, style);
    case PointFormat::csv: return std::make_unique<CsvWriter>(values, style);
    case PointFormat::obj: return std::make_unique<ObjWriter>(values, style);
    case PointFormat::json: return std::make_unique<JsonWriter>(values, style);
    case PointFormat::ply:
    case PointFormat::pcd: break;
  }
  return make_binary_writer(format, values, style);
}

} // namespace scansion
