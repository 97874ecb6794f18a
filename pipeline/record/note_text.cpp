// Feature lines and patches to JSON text.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/notes.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace scansion {
namespace {

constexpr std::size_t kFull = 1U << 20U; // bytes; a message is closed after this many
constexpr std::int64_t kNoPatch = -1;
constexpr double kTenthUm = 1e4; // per mm
constexpr double kExact = 0.0;

void put(std::string& out, std::uint64_t value) {
  std::array<char, 24> text{};
  out.append(text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr);
}

void put(std::string& out, double value, double per_unit) {
  // Beyond this the lattice's own counts are coarser than the rounding.
  constexpr double kLargest = 1e11;
  double rounded = std::isfinite(value) ? value : 0.0;
  if (per_unit > 0.0 && std::fabs(rounded) < kLargest) rounded = std::nearbyint(rounded * per_unit) / per_unit;
  if (rounded == 0.0) rounded = 0.0; // no -0
  std::array<char, 32> text{};
  out.append(text.data(), std::to_chars(text.data(), text.data() + text.size(), rounded).ptr);
}

void put_mm(std::string& out, double value) {
  put(out, value, kTenthUm);
}
void put_value(std::string& out, double value) {
  put(out, value, 1e3);
}

template <class Items, class Put>
void put_list(std::string& out, const Items& items, Put put_item) {
  out += '[';
  bool first = true;
  for (const auto& item : items) {
    if (!first) out += ',';
    first = false;
    put_item(item);
  }
  out += ']';
}

void put_key(std::string& out, std::string_view key) {
  if (out.back() != '{') out += ',';
  ((out += '"') += key) += "\":";
}

void put_word(std::string& out, std::string_view key, std::string_view word) {
  put_key(out, key);
  ((out += '"') += word) += '"';
}

void put_spread(std::string& out, std::string_view key, const MeanDeviation& value) {
  put_key(out, key);
  put_list(out, std::array{value.mean, value.deviation}, [&](double v) { put_value(out, v); });
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

void put_line_end(std::string& out, std::string_view key, const std::optional<LineEnd>& end) {
  if (!end) return;
  put_key(out, key);
  out += '[';
  put(out, end->line);
  out += end->last ? ",\"last\"]" : ",\"first\"]";
}

void put_vertex(std::string& out, const FeatureVertex& vertex, Rounding rounding) {
  out += '[';
  for (const double value : vertex.position) {
    put(out, value, rounding == Rounding::none ? kExact : kTenthUm);
    out += ',';
  }
  put(out, vertex.line);
  out += ',';
  put(out, vertex.index);
  if (vertex.guided) out += ",1";
  out += ']';
}

void put_patch(std::string& out, const Patch& patch) {
  out += '{';
  put_key(out, "id");
  put(out, patch.id);
  put_word(out, "label", name(patch.label));
  put_word(out, "shape", name(patch.shape));
  put_key(out, "samples");
  put(out, patch.samples);
  put_key(out, "area");
  put_value(out, patch.area_mm2);
  put_key(out, "centroid");
  put_list(out, patch.centroid, [&](double v) { put_mm(out, v); });
  put_key(out, "normal");
  put_list(out, patch.normal, [&](double v) { put(out, v, 1e6); });
  put_key(out, "plane_residual");
  put_mm(out, patch.plane_residual_mm);
  put_key(out, "quadric_residual");
  put_mm(out, patch.quadric_residual_mm);
  put_key(out, "neighbours");
  put_list(out, patch.neighbours, [&](std::uint32_t id) { put(out, id); });
  put_key(out, "doubtful");
  out += patch.doubtful ? "true" : "false";
  out += '}';
}

/// Collects entries of lists into messages that stay near kFull bytes.
class Messages {
public:
  explicit Messages(std::uint64_t group) : group_(group) {}

  /// The text to append one entry of `list` to.
  std::string& entry(std::string_view list) {
    if (!text_.empty() && text_.size() >= kFull) close();
    if (text_.empty()) {
      text_ = "{\"group\":";
      put(text_, group_);
      list_ = {};
    }
    if (list_ == list) return text_ += ',';
    if (!list_.empty()) text_ += ']';
    list_ = list;
    begun_ = true;
    ((text_ += ",\"") += list) += "\":[";
    return text_;
  }
  /// Whether the entry just asked for is the first of its list in its message.
  [[nodiscard]] bool begun() noexcept { return std::exchange(begun_, false); }
  std::vector<std::string> take() {
    if (!text_.empty()) close();
    return std::move(done_);
  }

private:
  void close() {
    text_ += "]}";
    done_.push_back(std::move(text_));
    text_.clear();
    list_ = {};
  }

  std::uint64_t group_;
  std::string text_;
  std::string_view list_;
  bool begun_ = false;
  std::vector<std::string> done_;
};

/// The runs of one scan line: where they begin, how long they are, and their patches unless these are those of the line before.
class RunRows {
public:
  explicit RunRows(Messages& messages) : messages_(messages) {}

  void add(const std::vector<PatchRun>& runs) {
    for (std::size_t begin = 0; begin < runs.size();) {
      std::size_t end = begin + 1;
      while (end < runs.size() && runs[end].line == runs[begin].line &&
             runs[end].first >= runs[end - 1].first + runs[end - 1].count)
        ++end;
      row(runs, begin, end);
      begin = end;
    }
  }

private:
  void row(const std::vector<PatchRun>& runs, std::size_t begin, std::size_t end) {
    std::string& out = messages_.entry("runs");
    const bool first = messages_.begun();
    now_.clear();
    counts_.clear();
    std::uint32_t at = runs[begin].first;
    for (std::size_t k = begin; k < end; ++k) {
      if (runs[k].first > at) {
        counts_.push_back(runs[k].first - at);
        now_.push_back(kNoPatch);
      }
      counts_.push_back(runs[k].count);
      now_.push_back(runs[k].patch);
      at = runs[k].first + runs[k].count;
    }
    out += '[';
    put(out, runs[begin].line);
    out += ',';
    put(out, runs[begin].first);
    out += ',';
    put_list(out, counts_, [&](std::uint32_t count) { put(out, count); });
    if (first || now_ != before_) {
      out += ',';
      put_list(out, now_, [&](std::int64_t patch) { out += std::to_string(patch); });
    }
    out += ']';
    before_.swap(now_);
  }

  Messages& messages_;
  std::vector<std::int64_t> before_, now_;
  std::vector<std::uint32_t> counts_;
};

} // namespace

void append_feature_line(std::string& out, const FeatureLine& line, Rounding rounding) {
  out += '{';
  put_key(out, "id");
  put(out, line.id);
  put_key(out, "piece");
  out += std::to_string(line.piece);
  put_line_end(out, "begins_at", line.begins_at);
  put_line_end(out, "ends_at", line.ends_at);
  put_word(out, "type", name(line.type));
  put_key(out, "level");
  put(out, line.level);
  put_key(out, "closed_loop");
  out += line.closed_loop ? "true" : "false";
  put_word(out, "begins", name(line.begins));
  put_word(out, "ends", name(line.ends));
  put_key(out, "length");
  put_mm(out, line.length_mm);
  put_key(out, "scan_lines");
  put(out, line.scan_lines);
  put_spread(out, "inner_angle", line.inner_angle);
  put_spread(out, "orientation", line.orientation);
  put_spread(out, "turning", line.turning);
  put_spread(out, "width", line.width);
  put_key(out, "sharpness");
  put_value(out, line.sharpness);
  put_key(out, "guided_share");
  put_value(out, line.guided_share);
  put_key(out, "persistence");
  put_value(out, line.persistence);
  put_key(out, "across");
  put_mm(out, line.across_mm);
  put_elements(out, line.elements);
  put_key(out, "partner");
  if (line.partner)
    put(out, *line.partner);
  else
    out += "null";
  put_key(out, "junctions");
  put_list(out, line.junctions, [&](std::uint64_t id) { put(out, id); });
  put_key(out, "vertices");
  put_list(out, line.vertices, [&](const FeatureVertex& vertex) { put_vertex(out, vertex, rounding); });
  out += '}';
}

std::vector<std::string> features_messages(const FeatureReport& report) {
  Messages messages(report.group);
  for (const FeatureLine& line : report.lines) append_feature_line(messages.entry("lines"), line);
  return messages.take();
}

std::vector<std::string> patches_messages(const FeatureReport& report) {
  Messages messages(report.group);
  RunRows(messages).add(report.runs);
  for (const PatchMerge& merge : report.merges) {
    std::string& out = messages.entry("merges");
    put_list(out, std::array{merge.from, merge.into}, [&](std::uint32_t id) { put(out, id); });
  }
  for (const Patch& patch : report.patches) put_patch(messages.entry("patches"), patch);
  for (const Form& form : report.forms) {
    std::string& out = messages.entry("forms");
    out += '{';
    put_word(out, "kind", name(form.kind));
    put_key(out, "patches");
    put_list(out, form.patches, [&](std::uint32_t id) { put(out, id); });
    put_key(out, "confidence");
    put_value(out, form.confidence);
    out += '}';
  }
  return messages.take();
}

} // namespace scansion
