// Feature lines to JSON text: short in recordings, plain for readers.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/note_json.hpp"
#include "pipeline/record/notes.hpp"

namespace scansion {
namespace {

using json::put;
using json::put_key;
using json::put_list;
using json::put_word;

constexpr double kTenths = 10.0, kHundredths = 100.0, kThousandths = 1000.0;

void put_number(std::string& out, std::string_view key, double value, double per_unit) {
  put_key(out, key);
  put(out, value, per_unit);
}

void put_spread(std::string& out, std::string_view key, const MeanDeviation& value, double per_unit) {
  put_key(out, key);
  put_list(out, std::array{value.mean, value.deviation}, [&](double v) { put(out, v, per_unit); });
}

void put_elements(std::string& out, const std::array<std::uint32_t, kShapeElements>& elements) {
  put_key(out, "elements");
  out += '{';
  for (std::size_t k = 0; k < kShapeElements; ++k) {
    if (elements[k] == 0) continue;
    put_key(out, name(static_cast<ShapeElement>(k)));
    put(out, elements[k]);
  }
  out += '}';
}

void put_line_end(std::string& out, const LineEnd& end) {
  out += '[';
  put(out, end.line);
  out += end.last ? ",\"last\"]" : ",\"first\"]";
}

void put_line_end(std::string& out, std::string_view key, const std::optional<LineEnd>& end) {
  if (!end) return;
  put_key(out, key);
  put_line_end(out, *end);
}

void put_ids(std::string& out, std::string_view key, const std::vector<std::uint64_t>& ids) {
  put_key(out, key);
  put_list(out, ids, [&](std::uint64_t id) { put(out, id); });
}

// Rows of x, y, z in counts, scan line and sample, each less the row before.
void put_differences(std::string& out, const FeatureLine& line) {
  put_key(out, "vertices");
  out += '[';
  std::array<std::int64_t, 5> before{};
  for (const FeatureVertex& v : line.vertices) {
    std::array<std::int64_t, 5> row{0, 0, 0, static_cast<std::int64_t>(v.line), static_cast<std::int64_t>(v.index)};
    for (std::size_t i = 0; i < 3; ++i) row[i] = std::llround(v.position[i] * line.per_mm);
    for (std::size_t i = 0; i < row.size(); ++i) {
      if (out.back() != '[') out += ',';
      put(out, row[i] - before[i]);
    }
    before = row;
  }
  out += ']';
}

/// All but the vertices, without the brace that closes it. In full, or without what is usual.
void put_attributes(std::string& out, const FeatureLine& line, bool in_full) {
  out += '{';
  put_key(out, "id");
  put(out, line.id);
  if (in_full || line.piece != 0) {
    put_key(out, "piece");
    put(out, line.piece);
  }
  put_line_end(out, "begins_at", line.begins_at);
  put_line_end(out, "ends_at", line.ends_at);
  put_word(out, "type", name(line.type));
  put_key(out, "level");
  put(out, line.level);
  if (in_full) put_word(out, "state", line.is_open() ? "open" : "closed");
  if (in_full || line.closed_loop) {
    put_key(out, "closed_loop");
    out += line.closed_loop ? "true" : "false";
  }
  if (in_full || line.begins != FeatureEnd::death) put_word(out, "begins", name(line.begins));
  if (in_full || line.ends != FeatureEnd::death) put_word(out, "ends", name(line.ends));
  put_number(out, "length", line.length_mm, kThousandths);
  put_key(out, "scan_lines");
  put(out, line.scan_lines);
  if (in_full) put_spread(out, "inner_angle", line.inner_angle, kTenths);
  put_spread(out, "orientation", line.orientation, kTenths);
  put_spread(out, "turning", line.turning, kTenths);
  put_spread(out, "width", line.width, kHundredths);
  put_number(out, "sharpness", line.sharpness, kTenths);
  if (in_full || line.guided_share > 0.0) put_number(out, "guided_share", line.guided_share, kHundredths);
  put_number(out, "persistence", line.persistence, kTenths);
  if (in_full || line.across_mm > 0.0) put_number(out, "across", line.across_mm, kThousandths);
  put_elements(out, line.elements);
  if (in_full || line.partner) {
    put_key(out, "partner");
    if (line.partner)
      put(out, *line.partner);
    else
      out += "null";
  }
  if (in_full || !line.junctions.empty()) put_ids(out, "junctions", line.junctions);
}

} // namespace

void append_line_entry(std::string& out, const FeatureLine& line) {
  put_attributes(out, line, false);
  if (!line.met_by.empty()) {
    put_key(out, "met_by");
    put_list(out, line.met_by, [&](const LineEnd& end) { put_line_end(out, end); });
  }
  put_key(out, "per_mm");
  put(out, line.per_mm);
  put_differences(out, line);
  out += '}';
}

void append_feature_line(std::string& out, const FeatureLine& line) {
  put_attributes(out, line, true);
  put_key(out, "vertices");
  put_list(out, line.vertices, [&](const FeatureVertex& v) {
    out += '[';
    for (const double value : v.position) {
      put(out, value, 0.0);
      out += ',';
    }
    put(out, v.line);
    out += ',';
    put(out, v.index);
    out += ']';
  });
  out += '}';
}

} // namespace scansion
