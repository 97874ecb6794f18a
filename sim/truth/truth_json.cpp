// Ground truth as JSON.
// SPDX-License-Identifier: Apache-2.0
#include "sim/truth/truth_json.hpp"

#include "sim/scene/scan_command.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace scansion {
namespace {

using Json = nlohmann::ordered_json;

double micrometres(double mm) noexcept {
  return std::round(mm * 1000.0) / 1000.0;
}

void append_point(std::string& out, const std::array<double, 3>& point) {
  for (std::size_t axis = 0; axis < 3; ++axis) out += (axis == 0 ? "[" : ",") + shortest(micrometres(point[axis]) + 0.0);
  out += "]";
}

/// Rows of their own keep the file readable; nlohmann would put each number on a row.
void append_points(std::string& out, const std::vector<std::array<double, 3>>& points) {
  out += "[";
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (k > 0) out += ",";
    append_point(out, points[k]);
  }
  out += "]";
}

template <class Kinds>
std::optional<Kinds> kind_of(std::string_view word, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    if (name(static_cast<Kinds>(k)) == word) return static_cast<Kinds>(k);
  }
  return std::nullopt;
}

} // namespace

std::string truth_json(const Truth& truth) {
  std::string out = "{\"format\":\"scansion-truth\",\"version\":1,\"unit\":\"mm\",\n\"scene\":" + Json(truth.scene).dump() +
                    ",\"command\":" + Json(truth.command).dump() + ",\n";
  const auto number = [&](const char* key, double value) { out += std::string("\"") + key + "\":" + shortest(value) + ","; };
  number("pitch_mm", truth.pitch_mm);
  number("spacing_mm", truth.spacing_mm);
  number("noise_um", truth.noise_um);
  number("direction_deg", truth.direction_deg);
  number("tilt_deg", truth.tilt_deg);
  number("area_mm2", truth.area_mm2);
  out += "\n\"curves\":[";
  for (std::size_t k = 0; k < truth.curves.size(); ++k) {
    const TrueCurve& curve = truth.curves[k];
    out += (k == 0 ? "\n{\"id\":" : ",\n{\"id\":") + std::to_string(k) + ",\"type\":\"" + std::string(name(curve.type)) +
           "\",\"closed\":" + (curve.closed ? "true" : "false") + ",\"optional\":" + (curve.optional ? "true" : "false") +
           ",\"feature\":" + std::to_string(curve.feature) + ",\"radius_mm\":" + shortest(curve.radius_mm) +
           ",\"wall_mm\":" + shortest(curve.wall_mm) + ",\"points\":";
    append_points(out, curve.points);
    out += "}";
  }
  out += "],\n\"patches\":[";
  for (std::size_t k = 0; k < truth.patches.size(); ++k) {
    out += (k == 0 ? "\n{\"id\":" : ",\n{\"id\":") + std::to_string(k) + ",\"kind\":\"" +
           std::string(name(truth.patches[k].kind)) + "\",\"samples\":" + std::to_string(truth.patches[k].samples) + "}";
  }
  out += "],\n\"forms\":[";
  for (std::size_t k = 0; k < truth.forms.size(); ++k) {
    const TrueForm& form = truth.forms[k];
    out += (k == 0 ? "\n{\"kind\":\"" : ",\n{\"kind\":\"") + std::string(name(form.kind)) +
           "\",\"feature\":" + std::to_string(form.feature) + ",\"patches\":" + Json(form.patches).dump();
    if (form.hole) {
      out += ",\"middle\":";
      append_point(out, form.hole->middle);
      out += ",\"area_mm2\":" + shortest(micrometres(form.hole->area_mm2));
    }
    out += "}";
  }
  out += "],\n\"lines\":[";
  for (std::size_t k = 0; k < truth.lines.size(); ++k) {
    out += k == 0 ? "\n[" : ",\n[";
    bool first = true;
    for (const TrueRun& run : truth.lines[k]) {
      out += (first ? "" : ",") + std::to_string(run.count) + "," + std::to_string(run.patch);
      first = false;
    }
    out += "]";
  }
  return out + "]}\n";
}

Result<Truth> parse_truth(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    if (json.at("format") != "scansion-truth" || json.at("version") != 1)
      return fail(Errc::undecodable, "not a ground truth of version 1");
    Truth truth;
    json.at("scene").get_to(truth.scene);
    json.at("command").get_to(truth.command);
    json.at("pitch_mm").get_to(truth.pitch_mm);
    json.at("spacing_mm").get_to(truth.spacing_mm);
    json.at("noise_um").get_to(truth.noise_um);
    json.at("direction_deg").get_to(truth.direction_deg);
    json.at("tilt_deg").get_to(truth.tilt_deg);
    json.at("area_mm2").get_to(truth.area_mm2);
    for (const Json& entry : json.at("curves")) {
      TrueCurve& curve = truth.curves.emplace_back();
      const auto type = kind_of<FeatureType>(entry.at("type").get<std::string>(), kFeatureTypes);
      if (!type) return fail(Errc::undecodable, "unknown type of curve ", entry.at("type").get<std::string>());
      curve.type = *type;
      entry.at("closed").get_to(curve.closed);
      entry.at("optional").get_to(curve.optional);
      entry.at("feature").get_to(curve.feature);
      entry.at("radius_mm").get_to(curve.radius_mm);
      entry.at("wall_mm").get_to(curve.wall_mm);
      entry.at("points").get_to(curve.points);
    }
    for (const Json& entry : json.at("patches")) {
      const auto kind = kind_of<FormKind>(entry.at("kind").get<std::string>(), kFormKinds);
      if (!kind) return fail(Errc::undecodable, "unknown kind of patch ", entry.at("kind").get<std::string>());
      truth.patches.push_back({*kind, entry.at("samples").get<std::uint64_t>()});
    }
    for (const Json& entry : json.at("forms")) {
      const auto kind = kind_of<FormKind>(entry.at("kind").get<std::string>(), kFormKinds);
      if (!kind) return fail(Errc::undecodable, "unknown kind of form ", entry.at("kind").get<std::string>());
      TrueForm& form = truth.forms.emplace_back();
      form.kind = *kind;
      entry.at("feature").get_to(form.feature);
      entry.at("patches").get_to(form.patches);
      if (*kind != FormKind::hole) continue;
      form.hole = TrueHole{entry.at("middle").get<std::array<double, 3>>(), entry.at("area_mm2").get<double>()};
    }
    for (const Json& entry : json.at("lines")) {
      const auto numbers = entry.get<std::vector<std::uint32_t>>();
      auto& line = truth.lines.emplace_back();
      for (std::size_t k = 0; k + 1 < numbers.size(); k += 2) line.push_back({numbers[k], numbers[k + 1]});
    }
    return truth;
  } catch (const nlohmann::json::exception& error) {
    return fail(Errc::undecodable, "ground truth: ", error.what());
  }
}

} // namespace scansion
