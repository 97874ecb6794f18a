// A drawing as an SVG picture; the image stands in it as a PNG.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/image_png.hpp"

#include <charconv>
#include <cmath>

namespace scansion {
namespace {

/// Hundredths of a pixel are finer than any screen.
std::string number(double value) {
  const double rounded = std::nearbyint(value * 100.0) / 100.0;
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), rounded == 0.0 ? 0.0 : rounded).ptr};
}

std::string hex(const Rgb& colour) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text = "#";
  for (const std::uint8_t part : colour) {
    text += kDigits[part >> 4U];
    text += kDigits[part & 15U];
  }
  return text;
}

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      default: out += c;
    }
  }
  return out;
}

/// Base64 of bytes that come in pieces.
class Base64 {
public:
  explicit Base64(OutputFile& file) : file_(file) {}
  Result<void> append(std::string_view bytes) {
    std::string out;
    for (const char c : bytes) {
      held_ = held_ << 8U | static_cast<unsigned char>(c);
      if (++count_ == 3) flush(out);
    }
    return file_.append(out);
  }
  Result<void> end() {
    std::string out;
    if (count_ > 0) {
      const unsigned missing = 3 - count_;
      held_ <<= 8U * missing;
      flush(out);
      out.replace(out.size() - missing, missing, missing, '=');
    }
    return file_.append(out);
  }

private:
  void flush(std::string& out) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (unsigned k = 0; k < 4; ++k) out += kDigits[held_ >> (18U - 6U * k) & 63U];
    held_ = 0;
    count_ = 0;
  }
  OutputFile& file_;
  std::uint32_t held_ = 0;
  unsigned count_ = 0;
};

Result<void> put_image(const Drawing& drawing, OutputFile& file) {
  const Surface image = surface_over(drawing.image);
  SCANSION_TRY(file.append("<image x=\"" + number(drawing.image_x) + "\" y=\"" + number(drawing.image_y) + "\" width=\"" +
                           number(drawing.image.width) + "\" height=\"" + number(drawing.image.height) +
                           "\" href=\"data:image/png;base64,"));
  Base64 base64(file);
  SCANSION_TRY(encode_png(image.get(), [&](std::string_view bytes) { return base64.append(bytes); }));
  SCANSION_TRY(base64.end());
  return file.append("\"/>\n");
}

Result<void> put_layer(const Layer& layer, OutputFile& file) {
  SCANSION_TRY(file.append("<g id=\"" + escaped(layer.name) + "\" fill=\"none\" stroke=\"" + hex(layer.colour) +
                           "\" stroke-width=\"" + number(layer.width) +
                           "\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n"));
  for (const Stroke& stroke : layer.strokes) {
    std::string text = stroke.closed ? "<polygon points=\"" : "<polyline points=\"";
    for (const auto& point : stroke.points) text += number(point[0]) + ',' + number(point[1]) + ' ';
    if (!stroke.points.empty()) text.pop_back();
    text += "\"><title>" + escaped(stroke.title) + (stroke.closed ? "</title></polygon>\n" : "</title></polyline>\n");
    SCANSION_TRY(file.append(text));
  }
  return file.append("</g>\n");
}

std::string text_of(const Label& label) {
  constexpr std::array<std::string_view, 3> kAnchors{"start", "middle", "end"};
  return "<text x=\"" + number(label.x) + "\" y=\"" + number(label.y) + "\" text-anchor=\"" +
         std::string(kAnchors[static_cast<std::size_t>(label.anchor)]) + "\">" + escaped(label.text) + "</text>\n";
}

} // namespace

Result<void> write_svg(const Drawing& drawing, OutputFile& file) {
  const std::string width = std::to_string(drawing.width);
  const std::string height = std::to_string(drawing.height);
  SCANSION_TRY(file.append("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
                           width + "\" height=\"" + height + "\" viewBox=\"0 0 " + width + ' ' + height +
                           "\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"));
  SCANSION_TRY(put_image(drawing, file));
  for (const Layer& layer : drawing.layers) {
    SCANSION_TRY(put_layer(layer, file));
  }
  for (const Box& box : drawing.boxes) {
    SCANSION_TRY(file.append("<rect x=\"" + number(box.x) + "\" y=\"" + number(box.y) + "\" width=\"" + number(box.width) +
                             "\" height=\"" + number(box.height) + "\" fill=\"" + hex(box.colour) + "\"/>\n"));
  }
  SCANSION_TRY(
      file.append("<g fill=\"#141414\" font-family=\"sans-serif\" font-size=\"" + number(drawing.text_size) + "\">\n"));
  for (const Label& label : drawing.labels) {
    SCANSION_TRY(file.append(text_of(label)));
  }
  return file.append("</g>\n</svg>\n");
}

} // namespace scansion
