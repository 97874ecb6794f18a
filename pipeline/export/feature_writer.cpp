// Feature lines as files.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/export/feature_writer.hpp"

#include "pipeline/record/notes.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>

namespace scansion {
namespace {

constexpr std::array<std::string_view, 7> kFormats{"txt", "csv", "json", "obj", "dxf", "ply", "vtp"};

std::string text_of(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// Numbers of one unit, rounded to 0.1 um.
class Numbers {
public:
  explicit Numbers(Unit unit) : per_mm_(1.0 / millimetres(unit).value()) {
    while (per_mm_ * 1e-4 * per_unit_ < 1.0 - 1e-9) per_unit_ *= 10.0;
  }
  [[nodiscard]] double value(double mm) const noexcept {
    const double rounded = std::nearbyint(mm * per_mm_ * per_unit_) / per_unit_;
    return rounded == 0.0 ? 0.0 : rounded; // no -0
  }
  [[nodiscard]] std::string row(const FeatureVertex& vertex, char between) const {
    return text_of(value(vertex.position[0])) + between + text_of(value(vertex.position[1])) + between +
           text_of(value(vertex.position[2]));
  }

private:
  double per_mm_;
  double per_unit_ = 1.0;
};

class Writer {
public:
  Writer(const std::vector<FeatureLine>& lines, Unit unit, OutputFile& file)
      : lines_(lines), unit_(unit), numbers_(unit), file_(file) {
    for (const FeatureLine& line : lines_) {
      vertices_ += line.vertices.size();
      edges_ += edges_of(line);
    }
  }

  Result<void> txt() {
    bool first = true;
    for (const FeatureLine& line : lines_) {
      std::string head = first ? "" : "\n";
      first = false;
      head += "# id=" + std::to_string(line.id) + " type=" + std::string(name(line.type)) +
              " level=" + std::to_string(line.level) + " state=" + (line.ends == FeatureEnd::open ? "open" : "closed") +
              " length=" + text_of(std::round(line.length_mm * 1e4) / 1e4) + "\n";
      SCANSION_TRY(file_.append(head));
      for (const FeatureVertex& v : line.vertices) {
        SCANSION_TRY(file_.append(numbers_.row(v, ' ') + ' ' + std::to_string(v.line) + ' ' + std::to_string(v.index) + '\n'));
      }
    }
    return success();
  }

  Result<void> csv() {
    SCANSION_TRY(file_.append("id,type,x,y,z,line,index\n"));
    for (const FeatureLine& line : lines_) {
      const std::string head = std::to_string(line.id) + ',' + std::string(name(line.type)) + ',';
      for (const FeatureVertex& v : line.vertices) {
        SCANSION_TRY(
            file_.append(head + numbers_.row(v, ',') + ',' + std::to_string(v.line) + ',' + std::to_string(v.index) + '\n'));
      }
    }
    return success();
  }

  Result<void> json() {
    SCANSION_TRY(file_.append("{\"unit\":\"" + std::string(name(unit_)) + "\",\"lines\":["));
    std::string text;
    for (const FeatureLine& line : lines_) {
      FeatureLine scaled = line;
      for (FeatureVertex& v : scaled.vertices) {
        for (double& x : v.position) x = numbers_.value(x);
      }
      text = &line == &lines_.front() ? "\n" : ",\n";
      append_feature_line(text, scaled);
      SCANSION_TRY(file_.append(text));
    }
    return file_.append("]}\n");
  }

  /// Groups by type; vertices of all lines are numbered through from 1.
  Result<void> obj() {
    SCANSION_TRY(file_.append("# scansion feature lines, unit " + std::string(name(unit_)) + "\n"));
    std::uint64_t number = 0;
    for (std::size_t k = 0; k < kFeatureTypes; ++k) {
      const auto type = static_cast<FeatureType>(k);
      if (std::ranges::none_of(lines_, [&](const FeatureLine& line) { return line.type == type; })) continue;
      SCANSION_TRY(file_.append("g " + std::string(name(type)) + "\n"));
      for (const FeatureLine& line : lines_) {
        if (line.type != type || line.vertices.empty()) continue;
        std::string row = "l";
        const std::uint64_t first = number + 1;
        for (const FeatureVertex& v : line.vertices) {
          SCANSION_TRY(file_.append("v " + numbers_.row(v, ' ') + '\n'));
          row += ' ' + std::to_string(++number);
        }
        if (line.closed_loop) row += ' ' + std::to_string(first);
        SCANSION_TRY(file_.append(row + '\n'));
      }
    }
    return success();
  }

  /// AutoCAD R12: a layer a type, each line a polyline in space.
  Result<void> dxf() {
    constexpr std::array<int, kFeatureTypes> kIndexColours{1, 5, 30, 4, 2, 6};
    std::string text = "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n70\n" + std::to_string(kFeatureTypes) + "\n";
    for (std::size_t k = 0; k < kFeatureTypes; ++k) {
      text += "0\nLAYER\n2\n" + std::string(name(static_cast<FeatureType>(k))) + "\n70\n0\n62\n" +
              std::to_string(kIndexColours[k]) + "\n6\nCONTINUOUS\n";
    }
    text += "0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n";
    SCANSION_TRY(file_.append(text));
    for (const FeatureLine& line : lines_) {
      const std::string layer = "8\n" + std::string(name(line.type)) + "\n";
      SCANSION_TRY(file_.append("0\nPOLYLINE\n" + layer + "66\n1\n70\n" + (line.closed_loop ? "9" : "8") +
                                "\n10\n0.0\n20\n0.0\n30\n0.0\n"));
      for (const FeatureVertex& v : line.vertices) {
        text = "0\nVERTEX\n" + layer + "70\n32\n";
        for (std::size_t axis = 0; axis < 3; ++axis)
          text += std::to_string(10 * (axis + 1)) + "\n" + text_of(numbers_.value(v.position[axis])) + "\n";
        SCANSION_TRY(file_.append(text));
      }
      SCANSION_TRY(file_.append("0\nSEQEND\n" + layer));
    }
    return file_.append("0\nENDSEC\n0\nEOF\n");
  }

  Result<void> ply() {
    SCANSION_TRY(
        file_.append("ply\nformat ascii 1.0\ncomment scansion feature lines, unit " + std::string(name(unit_)) +
                     "\ncomment type: 0 convex, 1 concave, 2 step-top, 3 step-bottom, 4 ridge, 5 valley\nelement vertex " +
                     std::to_string(vertices_) +
                     "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\nproperty uchar green\n"
                     "property uchar blue\nproperty uchar type\nproperty uint id\nelement edge " +
                     std::to_string(edges_) + "\nproperty int vertex1\nproperty int vertex2\nend_header\n"));
    for (const FeatureLine& line : lines_) {
      std::string tail;
      for (const std::uint8_t part : colour(line.type)) tail += ' ' + std::to_string(part);
      tail += ' ' + std::to_string(static_cast<int>(line.type)) + ' ' + std::to_string(line.id) + '\n';
      for (const FeatureVertex& v : line.vertices) {
        SCANSION_TRY(file_.append(numbers_.row(v, ' ') + tail));
      }
    }
    std::uint64_t first = 0;
    for (const FeatureLine& line : lines_) {
      const std::uint64_t size = line.vertices.size();
      for (std::uint64_t k = 0; k < edges_of(line); ++k) {
        SCANSION_TRY(file_.append(std::to_string(first + k) + ' ' + std::to_string(first + (k + 1) % size) + '\n'));
      }
      first += size;
    }
    return success();
  }

  Result<void> vtp() {
    SCANSION_TRY(
        file_.append("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
                     "<PolyData><Piece NumberOfPoints=\"" +
                     std::to_string(vertices_) + "\" NumberOfVerts=\"0\" NumberOfLines=\"" + std::to_string(lines_.size()) +
                     "\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points><DataArray type=\"Float64\" "
                     "NumberOfComponents=\"3\" format=\"ascii\">\n"));
    for (const FeatureLine& line : lines_) {
      for (const FeatureVertex& v : line.vertices) {
        SCANSION_TRY(file_.append(numbers_.row(v, ' ') + '\n'));
      }
    }
    SCANSION_TRY(file_.append("</DataArray></Points>\n<Lines>\n"));
    std::uint64_t first = 0;
    SCANSION_TRY(array("Int64", "connectivity", [&](const FeatureLine& line) {
      std::string row;
      for (std::uint64_t k = 0; k < line.vertices.size(); ++k) row += std::to_string(first + k) + ' ';
      if (line.closed_loop && !line.vertices.empty()) row += std::to_string(first);
      first += line.vertices.size();
      return row;
    }));
    std::uint64_t end = 0;
    SCANSION_TRY(array("Int64", "offsets", [&](const FeatureLine& line) {
      end += line.vertices.size() + (line.closed_loop && !line.vertices.empty() ? 1 : 0);
      return std::to_string(end);
    }));
    SCANSION_TRY(file_.append("</Lines>\n<CellData Scalars=\"type\">\n"));
    SCANSION_TRY(array("Int32", "type", [](const FeatureLine& line) { return std::to_string(static_cast<int>(line.type)); }));
    SCANSION_TRY(array("Int64", "id", [](const FeatureLine& line) { return std::to_string(line.id); }));
    SCANSION_TRY(array("Int32", "level", [](const FeatureLine& line) { return std::to_string(line.level); }));
    SCANSION_TRY(array("Float64", "length_mm", [](const FeatureLine& line) { return text_of(line.length_mm); }));
    return file_.append("</CellData>\n</Piece></PolyData></VTKFile>\n");
  }

private:
  static std::uint64_t edges_of(const FeatureLine& line) noexcept {
    if (line.vertices.size() < 2) return 0;
    return line.vertices.size() - (line.closed_loop ? 0 : 1);
  }
  template <class Row>
  Result<void> array(std::string_view type, std::string_view name, Row row) {
    for (const std::string_view part : {std::string_view("<DataArray type=\""), type, std::string_view("\" Name=\""), name,
                                        std::string_view("\" format=\"ascii\">\n")}) {
      SCANSION_TRY(file_.append(part));
    }
    for (const FeatureLine& line : lines_) {
      SCANSION_TRY(file_.append(row(line) + '\n'));
    }
    return file_.append("</DataArray>\n");
  }

  const std::vector<FeatureLine>& lines_;
  Unit unit_;
  Numbers numbers_;
  OutputFile& file_;
  std::uint64_t vertices_ = 0, edges_ = 0;
};

} // namespace

Result<FeatureFormat> parse_feature_format(std::string_view name) {
  const auto found = std::ranges::find(kFormats, name);
  if (found != kFormats.end()) return static_cast<FeatureFormat>(found - kFormats.begin());
  return fail(Errc::usage, "feature lines are not written as '", name, "'; take --format txt, csv, json, obj, dxf, ply or vtp");
}

Result<void> write_feature_lines(const std::vector<FeatureLine>& lines, FeatureFormat format, Unit unit, OutputFile& file) {
  Writer writer(lines, unit, file);
  switch (format) {
    case FeatureFormat::txt: return writer.txt();
    case FeatureFormat::csv: return writer.csv();
    case FeatureFormat::json: return writer.json();
    case FeatureFormat::obj: return writer.obj();
    case FeatureFormat::dxf: return writer.dxf();
    case FeatureFormat::ply: return writer.ply();
    case FeatureFormat::vtp: return writer.vtp();
  }
  return success();
}

std::array<std::uint8_t, 3> colour(FeatureType type) noexcept {
  constexpr std::array<std::array<std::uint8_t, 3>, kFeatureTypes> kColours{
      {{214, 39, 40}, {31, 119, 180}, {255, 127, 14}, {23, 190, 207}, {188, 160, 0}, {148, 103, 189}}};
  return kColours[static_cast<std::size_t>(type)];
}

std::array<std::uint8_t, 3> patch_colour(std::int64_t patch) noexcept {
  if (patch < 0) return {160, 160, 160};
  // Multiples of the golden ratio spread neighbouring numbers over the circle of hues.
  const double hue = 6.0 * std::fmod(static_cast<double>(patch) * 0.6180339887498949, 1.0);
  std::array<std::uint8_t, 3> out{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double wave = std::fabs(std::fmod(hue + 6.0 - 2.0 * static_cast<double>(k), 6.0) - 3.0) - 1.0;
    out[k] = static_cast<std::uint8_t>(90.0 + 150.0 * std::clamp(wave, 0.0, 1.0));
  }
  return out;
}

} // namespace scansion
