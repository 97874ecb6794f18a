// Names of form features on a top view by patches.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/form_names.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

namespace scansion {
namespace {

using Pixel = std::array<double, 2>;

struct Name {
  Pixel middle{};
  double room = 0.0; // pixels
  std::string text;
};

/// Where a patch is widest, not far from its middle.
struct WidestPlace {
  double middle_row = 0.0, score = -1e300;
  Pixel at{};
  double width = 0.0;

  void look(int row, int first, int end) noexcept {
    const double length = end - first, now = length - 2.0 * std::abs(row - middle_row);
    if (now <= score) return;
    score = now;
    width = length;
    at = {0.5 * (first + end), row + 0.5};
  }
};

/// Looks at the cells of some patches and at the borders between some.
class Survey {
public:
  explicit Survey(const Findings& findings) {
    for (const Form& form : findings.forms) {
      if (form.patches.empty() || form.hole) continue;
      const bool touches = form.kind == FormKind::step && form.patches.size() == 2;
      if (touches)
        borders_.try_emplace(pair_of(form));
      else
        places_.try_emplace(main_patch(form));
    }
  }

  void look_at(const HeightRaster& raster, const Findings& findings) {
    const TopMap& map = raster.map();
    for (const Patch& patch : findings.patches) {
      const auto place = places_.find(patch.id);
      if (place != places_.end()) place->second.middle_row = map.pixel(patch.centroid[0], patch.centroid[1])[1];
    }
    for (int row = 0; row < map.height; ++row) look_at_row(raster, row);
  }

  [[nodiscard]] std::optional<Name> name_of(const Form& form, const TopMap& map) const {
    Name out;
    out.text = name(form.kind);
    if (form.hole) {
      const std::array<double, 3>& middle = form.hole->middle;
      out.middle = map.pixel(middle[0], middle[1]);
      out.room = map.pixel(middle[0] + form.hole->diameter_mm(), middle[1])[0] - out.middle[0];
      return out;
    }
    if (const auto border = borders_.find(pair_of(form)); border != borders_.end() && form.kind == FormKind::step) {
      if (border->second.empty()) return std::nullopt;
      out.middle = middle_of(border->second);
      out.room = static_cast<double>(border->second.size());
      return out;
    }
    const auto place = places_.find(main_patch(form));
    if (place == places_.end() || place->second.width <= 0.0) return std::nullopt;
    out.middle = place->second.at;
    out.room = place->second.width;
    return out;
  }

private:
  using Ids = std::pair<std::int64_t, std::int64_t>;

  // Of a step the wall between its levels.
  [[nodiscard]] static std::int64_t main_patch(const Form& form) noexcept {
    return form.patches[form.kind == FormKind::step && form.patches.size() > 2 ? 1 : 0];
  }
  [[nodiscard]] static Ids pair_of(const Form& form) noexcept {
    return std::minmax<std::int64_t>(form.patches.front(), form.patches.back());
  }
  // The one nearest to the mean: a border may be bent.
  [[nodiscard]] static Pixel middle_of(const std::vector<Pixel>& cells) {
    Pixel mean{};
    for (const Pixel& cell : cells)
      for (std::size_t k = 0; k < 2; ++k) mean[k] += cell[k] / static_cast<double>(cells.size());
    const auto off = [&](const Pixel& p) { return std::hypot(p[0] - mean[0], p[1] - mean[1]); };
    return *std::min_element(cells.begin(), cells.end(), [&](const Pixel& a, const Pixel& b) { return off(a) < off(b); });
  }

  void look_at_row(const HeightRaster& raster, int row) {
    const int width = raster.map().width;
    const auto patch = [&](int column, int at) {
      return raster.patch(static_cast<std::size_t>(at) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column));
    };
    for (int first = 0; first < width;) {
      const std::int64_t own = patch(first, row);
      int end = first + 1;
      while (end < width && patch(end, row) == own) ++end;
      if (const auto place = places_.find(own); place != places_.end()) place->second.look(row, first, end);
      if (end < width) note_border(own, patch(end, row), {static_cast<double>(end), row + 0.5});
      first = end;
    }
    for (int column = 0; row > 0 && column < width; ++column)
      if (patch(column, row) != patch(column, row - 1))
        note_border(patch(column, row), patch(column, row - 1), {column + 0.5, static_cast<double>(row)});
  }

  void note_border(std::int64_t a, std::int64_t b, const Pixel& at) {
    const auto border = borders_.find(std::minmax(a, b));
    if (border != borders_.end()) border->second.push_back(at);
  }

  std::unordered_map<std::int64_t, WidestPlace> places_; ///< by patch
  std::map<Ids, std::vector<Pixel>> borders_;            ///< by both patches
};

bool overlap(const Box& a, const Box& b) noexcept {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

} // namespace

void add_form_names(Drawing& drawing, const HeightRaster& raster, const Findings& findings) {
  constexpr double kLetter = 0.6; // of the text size: width of a letter
  Survey survey(findings);
  survey.look_at(raster, findings);
  std::vector<Name> names;
  for (const Form& form : findings.forms) {
    if (form.patches.empty()) continue;
    if (auto found = survey.name_of(form, raster.map())) names.push_back(*std::move(found));
  }
  std::stable_sort(names.begin(), names.end(), [](const Name& a, const Name& b) { return a.room > b.room; });
  const double text = drawing.text_size;
  std::vector<Box> grounds;
  for (const Name& n : names) {
    const double x = drawing.image_x + n.middle[0], y = drawing.image_y + n.middle[1];
    const double width = kLetter * text * (static_cast<double>(n.text.size()) + 1.0);
    const Box ground{x - 0.5 * width, y - 0.6 * text, width, 1.2 * text, {255, 255, 255}};
    if (std::any_of(grounds.begin(), grounds.end(), [&](const Box& other) { return overlap(ground, other); })) continue;
    grounds.push_back(ground);
    drawing.labels.push_back({x, y + 0.35 * text, Label::Anchor::middle, n.text});
  }
  drawing.boxes.insert(drawing.boxes.end(), grounds.begin(), grounds.end());
}

} // namespace scansion
