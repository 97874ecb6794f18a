// Feature lines and patches from JSON text.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/record/notes.hpp"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

namespace scansion {
namespace {

using Json = nlohmann::json;

/// Inside the parser only: every rejection ends in one Error.
struct Rejected {
  std::string what;
};

template <class Kind>
Kind kind(const Json& word, std::size_t count) {
  const auto& text = word.get_ref<const std::string&>();
  for (std::size_t k = 0; k < count; ++k) {
    if (name(static_cast<Kind>(k)) == text) return static_cast<Kind>(k);
  }
  throw Rejected{"'" + text + "' is no word of this format"};
}

template <class T>
T whole(const Json& value) {
  if (!value.is_number_integer()) throw Rejected{"a number is not whole"};
  // Json keeps what is not negative unsigned, and the rest signed.
  const bool fits =
      value.is_number_unsigned() ? std::in_range<T>(value.get<std::uint64_t>()) : std::in_range<T>(value.get<std::int64_t>());
  if (!fits) throw Rejected{"a number is out of range"};
  return value.get<T>();
}

double real(const Json& value) {
  if (!value.is_number()) throw Rejected{"a number is missing"};
  const double number = value.get<double>();
  if (!std::isfinite(number)) throw Rejected{"a number is not finite"};
  return number;
}

template <class T>
std::vector<T> wholes(const Json& list) {
  std::vector<T> out;
  for (const Json& entry : list) out.push_back(whole<T>(entry));
  return out;
}

std::array<double, 3> triple(const Json& list) {
  if (!list.is_array() || list.size() < 3) throw Rejected{"three numbers are missing"};
  return {real(list[0]), real(list[1]), real(list[2])};
}

MeanDeviation spread(const Json& list) {
  if (!list.is_array() || list.size() != 2) throw Rejected{"a mean and a deviation are missing"};
  return {real(list[0]), real(list[1])};
}

std::optional<LineEnd> line_end(const Json& j, const char* key) {
  const auto found = j.find(key);
  if (found == j.end()) return std::nullopt;
  if (!found->is_array() || found->size() != 2) throw Rejected{"an end of a line is not an id and a word"};
  const auto& word = (*found)[1].get_ref<const std::string&>();
  if (word != "first" && word != "last") throw Rejected{"an end of a line is neither first nor last"};
  return LineEnd{whole<std::uint64_t>((*found)[0]), word == "last"};
}

FeatureVertex vertex(const Json& row) {
  FeatureVertex v;
  v.position = triple(row);
  if (row.size() < 5 || row.size() > 6) throw Rejected{"a vertex has not five or six numbers"};
  v.line = whole<std::uint64_t>(row[3]);
  v.index = whole<std::uint32_t>(row[4]);
  v.guided = row.size() == 6;
  return v;
}

FeatureLine feature_line(const Json& j) {
  FeatureLine line;
  line.id = whole<std::uint64_t>(j.at("id"));
  line.piece = whole<std::int32_t>(j.at("piece"));
  line.begins_at = line_end(j, "begins_at");
  line.ends_at = line_end(j, "ends_at");
  line.type = kind<FeatureType>(j.at("type"), kFeatureTypes);
  line.level = whole<std::uint32_t>(j.at("level"));
  line.closed_loop = j.at("closed_loop").get<bool>();
  line.begins = kind<FeatureEnd>(j.at("begins"), kFeatureEnds);
  line.ends = kind<FeatureEnd>(j.at("ends"), kFeatureEnds);
  line.length_mm = real(j.at("length"));
  line.scan_lines = whole<std::uint64_t>(j.at("scan_lines"));
  line.inner_angle = spread(j.at("inner_angle"));
  line.orientation = spread(j.at("orientation"));
  line.turning = spread(j.at("turning"));
  line.width = spread(j.at("width"));
  line.sharpness = real(j.at("sharpness"));
  line.guided_share = real(j.at("guided_share"));
  line.persistence = real(j.at("persistence"));
  line.across_mm = real(j.at("across"));
  for (const auto& [word, count] : j.at("elements").items())
    line.elements[static_cast<std::size_t>(kind<ShapeElement>(Json(word), kShapeElements))] = whole<std::uint32_t>(count);
  if (const Json& partner = j.at("partner"); !partner.is_null()) line.partner = whole<std::uint64_t>(partner);
  line.junctions = wholes<std::uint64_t>(j.at("junctions"));
  for (const Json& row : j.at("vertices")) line.vertices.push_back(vertex(row));
  return line;
}

Patch patch(const Json& j) {
  Patch p;
  p.id = whole<std::uint32_t>(j.at("id"));
  p.label = kind<FormKind>(j.at("label"), kFormKinds);
  p.shape = kind<PatchShape>(j.at("shape"), kPatchShapes);
  p.samples = whole<std::uint64_t>(j.at("samples"));
  p.area_mm2 = real(j.at("area"));
  p.centroid = triple(j.at("centroid"));
  p.normal = triple(j.at("normal"));
  p.plane_residual_mm = real(j.at("plane_residual"));
  p.quadric_residual_mm = real(j.at("quadric_residual"));
  p.neighbours = wholes<std::uint32_t>(j.at("neighbours"));
  p.doubtful = j.at("doubtful").get<bool>();
  return p;
}

void runs(const Json& rows, std::vector<PatchRun>& out) {
  Json patches;
  for (const Json& row : rows) {
    if (!row.is_array() || row.size() < 3 || row.size() > 4) throw Rejected{"a row of runs has not three or four parts"};
    if (row.size() == 4) patches = row[3];
    const auto line = whole<std::uint64_t>(row[0]);
    std::uint64_t at = whole<std::uint32_t>(row[1]);
    if (!row[2].is_array() || row[2].size() != patches.size()) throw Rejected{"runs and their patches do not match"};
    for (std::size_t k = 0; k < patches.size(); ++k) {
      const auto count = whole<std::uint32_t>(row[2][k]);
      if (count == 0 || at + count > std::numeric_limits<std::uint32_t>::max()) throw Rejected{"a run of impossible length"};
      if (patches[k] != -1) out.push_back({line, static_cast<std::uint32_t>(at), count, whole<std::uint32_t>(patches[k])});
      at += count;
    }
  }
}

template <class Read>
Result<void> parse(std::string_view text, std::string_view what, Read read) {
  try {
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object()) return fail(Errc::damaged, what, " message is no JSON object");
    read(json);
    return success();
  } catch (const Json::exception& error) {
    return fail(Errc::damaged, what, " message: ", error.what());
  } catch (const Rejected& rejected) {
    return fail(Errc::damaged, what, " message: ", rejected.what);
  }
}

} // namespace

Result<void> parse_features_message(std::string_view text, FeatureReport& report) {
  return parse(text, "features", [&](const Json& json) {
    report.group = whole<std::uint64_t>(json.at("group"));
    for (const Json& entry : json.at("lines")) report.lines.push_back(feature_line(entry));
  });
}

Result<void> parse_patches_message(std::string_view text, FeatureReport& report) {
  return parse(text, "patches", [&](const Json& json) {
    report.group = whole<std::uint64_t>(json.at("group"));
    if (const auto rows = json.find("runs"); rows != json.end()) runs(*rows, report.runs);
    if (const auto merges = json.find("merges"); merges != json.end()) {
      for (const Json& entry : *merges) {
        const auto pair = wholes<std::uint32_t>(entry);
        if (pair.size() != 2) throw Rejected{"a merge is not two patches"};
        report.merges.push_back({pair[0], pair[1]});
      }
    }
    if (const auto patches = json.find("patches"); patches != json.end()) {
      for (const Json& entry : *patches) report.patches.push_back(patch(entry));
    }
    if (const auto forms = json.find("forms"); forms != json.end()) {
      for (const Json& entry : *forms) {
        report.forms.push_back({kind<FormKind>(entry.at("kind"), kFormKinds), wholes<std::uint32_t>(entry.at("patches")),
                                real(entry.at("confidence"))});
      }
    }
  });
}

} // namespace scansion
