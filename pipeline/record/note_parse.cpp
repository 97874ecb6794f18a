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

LineEnd line_end(const Json& end) {
  if (!end.is_array() || end.size() != 2) throw Rejected{"an end of a line is not an id and a word"};
  const auto& word = end[1].get_ref<const std::string&>();
  if (word != "first" && word != "last") throw Rejected{"an end of a line is neither first nor last"};
  return {whole<std::uint64_t>(end[0]), word == "last"};
}

/// Rows of x, y, z in counts, scan line and sample, each less the row before.
std::vector<FeatureVertex> vertices(const Json& list, std::uint32_t per_mm) {
  // Counts stay exact through a double and back; the sum of two numbers below a limit fits.
  constexpr std::array<std::int64_t, 5> kLimits{std::int64_t{1} << 50U, std::int64_t{1} << 50U, std::int64_t{1} << 50U,
                                                std::int64_t{1} << 62U, std::int64_t{1} << 32U};
  if (!list.is_array() || list.size() % 5 != 0) throw Rejected{"the vertices are not rows of five numbers"};
  std::vector<FeatureVertex> out;
  out.reserve(list.size() / 5);
  std::array<std::int64_t, 5> row{};
  const auto check = [](std::int64_t value, std::int64_t limit) {
    if (value > limit || value < -limit) throw Rejected{"a vertex is too far away"};
  };
  for (std::size_t k = 0; k < list.size(); ++k) {
    const auto difference = whole<std::int64_t>(list[k]);
    check(difference, kLimits[k % 5]);
    row[k % 5] += difference;
    check(row[k % 5], kLimits[k % 5]);
    if (k % 5 != 4) continue;
    if (row[3] < 0 || !std::in_range<std::uint32_t>(row[4])) throw Rejected{"a vertex on no sample"};
    FeatureVertex& v = out.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) v.position[i] = static_cast<double>(row[i]) / per_mm;
    v.line = static_cast<std::uint64_t>(row[3]);
    v.index = static_cast<std::uint32_t>(row[4]);
  }
  return out;
}

/// What is usual is left out of a message.
template <class Read>
void when(const Json& j, const char* key, Read read) {
  if (const auto found = j.find(key); found != j.end()) read(*found);
}

FeatureLine feature_line(const Json& j) {
  FeatureLine line;
  line.id = whole<std::uint64_t>(j.at("id"));
  when(j, "piece", [&](const Json& v) { line.piece = whole<std::int32_t>(v); });
  when(j, "begins_at", [&](const Json& v) { line.begins_at = line_end(v); });
  when(j, "ends_at", [&](const Json& v) { line.ends_at = line_end(v); });
  line.type = kind<FeatureType>(j.at("type"), kFeatureTypes);
  line.level = whole<std::uint32_t>(j.at("level"));
  when(j, "closed_loop", [&](const Json& v) { line.closed_loop = v.get<bool>(); });
  when(j, "begins", [&](const Json& v) { line.begins = kind<FeatureEnd>(v, kFeatureEnds); });
  when(j, "ends", [&](const Json& v) { line.ends = kind<FeatureEnd>(v, kFeatureEnds); });
  line.length_mm = real(j.at("length"));
  line.scan_lines = whole<std::uint64_t>(j.at("scan_lines"));
  line.orientation = spread(j.at("orientation"));
  line.turning = spread(j.at("turning"));
  line.inner_angle = {180.0 - std::abs(line.turning.mean), line.turning.deviation};
  line.width = spread(j.at("width"));
  line.sharpness = real(j.at("sharpness"));
  when(j, "guided_share", [&](const Json& v) { line.guided_share = real(v); });
  line.persistence = real(j.at("persistence"));
  when(j, "across", [&](const Json& v) { line.across_mm = real(v); });
  for (const auto& [word, count] : j.at("elements").items())
    line.elements[static_cast<std::size_t>(kind<ShapeElement>(Json(word), kShapeElements))] = whole<std::uint32_t>(count);
  when(j, "partner", [&](const Json& v) { line.partner = whole<std::uint64_t>(v); });
  when(j, "junctions", [&](const Json& v) { line.junctions = wholes<std::uint64_t>(v); });
  when(j, "met_by", [&](const Json& v) {
    for (const Json& end : v) line.met_by.push_back(line_end(end));
  });
  line.per_mm = whole<std::uint32_t>(j.at("per_mm"));
  if (line.per_mm == 0) throw Rejected{"no counts a mm"};
  line.vertices = vertices(j.at("vertices"), line.per_mm);
  return line;
}

Backlash backlash(const Json& j) {
  return {real(j.at("along")), real(j.at("deviation")), real(j.at("taken_off")), whole<std::uint64_t>(j.at("places"))};
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

Form form(const Json& j) {
  Form f{kind<FormKind>(j.at("kind"), kFormKinds), wholes<std::uint32_t>(j.at("patches")), real(j.at("confidence")), {}};
  if (f.kind != FormKind::hole) return f;
  HoleSize& hole = f.hole.emplace();
  hole.middle = triple(j.at("middle"));
  hole.along_mm = real(j.at("along"));
  hole.across_mm = real(j.at("across"));
  hole.area_mm2 = real(j.at("area"));
  hole.rim = whole<std::uint64_t>(j.at("rim"));
  return f;
}

/// Rows in full, or by how much the lengths of runs differ from those of the row before.
class RunReader {
public:
  explicit RunReader(std::vector<PatchRun>& out) : out_(out) {}

  void read(const Json& row) {
    if (!row.is_array()) throw Rejected{"a row of runs is no list"};
    const bool full = row.size() == 4 && row[2].is_array();
    if (full)
      take(row);
    else
      change(row);
    std::uint64_t at = first_;
    for (std::size_t k = 0; k < counts_.size(); ++k) {
      if (counts_[k] <= 0 || at + static_cast<std::uint64_t>(counts_[k]) > std::numeric_limits<std::uint32_t>::max())
        throw Rejected{"a run of impossible length"};
      const auto count = static_cast<std::uint32_t>(counts_[k]);
      if (patches_[k]) out_.push_back({line_, static_cast<std::uint32_t>(at), count, *patches_[k]});
      at += count;
    }
  }

private:
  void take(const Json& row) {
    line_ = whole<std::uint64_t>(row[0]);
    first_ = whole<std::uint32_t>(row[1]);
    counts_.clear();
    patches_.clear();
    for (const Json& count : row[2]) counts_.push_back(whole<std::uint32_t>(count));
    for (const Json& patch : row[3])
      patches_.push_back(patch == -1 ? std::nullopt : std::optional(whole<std::uint32_t>(patch)));
    if (counts_.size() != patches_.size()) throw Rejected{"runs and their patches do not match"};
    begun_ = true;
  }
  void change(const Json& row) {
    if (!begun_ || row.size() > counts_.size()) throw Rejected{"runs that differ from none"};
    ++line_;
    for (std::size_t k = 0; k < row.size(); ++k) counts_[k] += whole<std::int32_t>(row[k]);
  }

  std::vector<PatchRun>& out_;
  bool begun_ = false;
  std::uint64_t line_ = 0;
  std::uint32_t first_ = 0;
  std::vector<std::int64_t> counts_;
  std::vector<std::optional<std::uint32_t>> patches_;
};

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
    when(json, "backlash", [&](const Json& v) { report.backlash = backlash(v); });
  });
}

Result<void> parse_patches_message(std::string_view text, FeatureReport& report) {
  return parse(text, "patches", [&](const Json& json) {
    report.group = whole<std::uint64_t>(json.at("group"));
    if (const auto rows = json.find("runs"); rows != json.end()) {
      RunReader reader(report.runs);
      for (const Json& row : *rows) reader.read(row);
    }
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
        report.forms.push_back(form(entry));
      }
    }
  });
}

} // namespace scansion
