// What stands around the map of a top view.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/legend.hpp"

#include "pipeline/export/feature_writer.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace scansion {
namespace {

constexpr double kRow = 1.5; // letters: from a row of text to the next

std::string general(double value, int digits) {
  std::array<char, 40> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits).ptr};
}

/// Millimetres with as many decimals as tell the ends of `span` apart.
std::string millimetres_text(double value, double span) {
  const int decimals = span > 0.0 ? std::clamp(2 - static_cast<int>(std::floor(std::log10(span))), 0, 6) : 3;
  std::array<char, 400> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals).ptr;
  return std::string(text.data(), end) + " mm";
}

// Short: the column beside the map is narrow.
std::string length_text(double mm) {
  constexpr double kLong = 10'000.0;
  return mm < kLong ? general(mm, 4) + " mm" : general(mm / 1000.0, 4) + " m";
}

double round_length(double mm) {
  const double power = std::pow(10.0, std::floor(std::log10(mm)));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= mm) return step * power;
  }
  return power;
}

/// Rows of text in the column beside the map.
class Column {
public:
  Column(Drawing& drawing, const Margins& margins)
      : drawing_(drawing), text_(margins.text), left_(drawing.width - margins.right + margins.text),
        y_(margins.top + margins.text) {}
  void row(const std::string& text) {
    drawing_.labels.push_back({left_, y_, Label::Anchor::start, text});
    skip(1.0);
  }
  void row(const Rgb& colour, const std::string& text) {
    drawing_.boxes.push_back({left_, y_ - 0.5 * text_, 1.6 * text_, 0.3 * text_, colour});
    drawing_.labels.push_back({left_ + 2.1 * text_, y_, Label::Anchor::start, text});
    skip(1.0);
  }
  void ramp(const std::string& high, const std::string& low) {
    constexpr int kSteps = 48;
    const double step = std::max(1.0, std::round(text_ / 6.0)); // whole pixels, so that no seams show
    const double top = std::round(y_ - text_);
    const double height = kSteps * step;
    for (int k = 0; k < kSteps; ++k) {
      drawing_.boxes.push_back({left_, top + k * step, 1.6 * text_, step, height_colour(1.0 - (k + 0.5) / kSteps)});
    }
    drawing_.labels.push_back({left_ + 2.1 * text_, y_, Label::Anchor::start, high});
    drawing_.labels.push_back({left_ + 2.1 * text_, y_ - text_ + height, Label::Anchor::start, low});
    y_ += height;
    skip(0.3);
  }
  void skip(double rows) { y_ += kRow * rows * text_; }

private:
  Drawing& drawing_;
  double text_, left_, y_;
};

void add_types(Column& column, const std::vector<FeatureLine>& lines) {
  std::array<std::size_t, kFeatureTypes> count{};
  std::array<double, kFeatureTypes> length{};
  for (const FeatureLine& line : lines) {
    ++count[static_cast<std::size_t>(line.type)];
    length[static_cast<std::size_t>(line.type)] += line.length_mm;
  }
  column.row("Feature lines: " + std::to_string(lines.size()));
  for (std::size_t k = 0; k < kFeatureTypes; ++k) {
    const auto type = static_cast<FeatureType>(k);
    column.row(colour(type), std::string(name(type)) + "  " + std::to_string(count[k]) + ", " + length_text(length[k]));
  }
}

} // namespace

Margins margins_for(int size) {
  const double text = std::clamp(size / 90.0, 8.0, 33.0);
  return {text, text, 2.6 * text, 18.5 * text, 3.4 * text, 25.0 * text};
}

void add_caption(Drawing& drawing, const Margins& margins, const std::string& caption) {
  std::string plain = caption;
  std::ranges::replace_if(
      plain, [](char c) { return c < ' ' || c > '~'; }, '?');
  drawing.labels.push_back({margins.left, 1.6 * margins.text, Label::Anchor::start, plain});
}

void add_scale_bar(Drawing& drawing, const Margins& margins, const TopMap& map) {
  const double mm = round_length(std::max(map.width / map.per_mm[0] / 3.5, 1e-300));
  const double length = mm * map.per_mm[0];
  const double y = drawing.height - 2.0 * margins.text;
  const double tick = 0.4 * margins.text;
  const double line = 0.15 * margins.text;
  const Rgb ink{20, 20, 20};
  drawing.boxes.push_back({margins.left, y, length, line, ink});
  drawing.boxes.push_back({margins.left, y - tick, line, 2 * tick, ink});
  drawing.boxes.push_back({margins.left + length - line, y - tick, line, 2 * tick, ink});
  std::string text = general(mm, 6) + " mm";
  const double ratio = map.per_mm[1] / map.per_mm[0];
  if (std::fabs(ratio - 1.0) > 0.01)
    text += ratio > 1.0 ? " in x; y is drawn " + general(ratio, 3) + " times as large"
                        : " in x; y is drawn " + general(1.0 / ratio, 3) + " times as small";
  drawing.labels.push_back({margins.left, y + 1.4 * margins.text, Label::Anchor::start, text});
}

void add_key(Drawing& drawing, const Margins& margins, const HeightRange& range, double lowest_mm, const ViewContent& content) {
  Column column(drawing, margins);
  if (content.shade == Shade::height) {
    const double span = range.high - range.low;
    column.row("Height");
    column.ramp(millimetres_text(lowest_mm + range.high, span), millimetres_text(lowest_mm + range.low, span));
  } else {
    column.row("Patches: " + std::to_string(content.findings->patches.size()));
    column.skip(0.5);
  }
  if (content.level) {
    column.row({16, 16, 16}, "points of level " + std::to_string(*content.level));
    column.skip(0.5);
  }
  if (content.findings)
    add_types(column, content.findings->lines);
  else
    column.row("no feature lines recorded");
}

} // namespace scansion
