// A drawing as a PNG picture.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/image_png.hpp"

namespace scansion {
namespace {

struct ContextRelease {
  void operator()(cairo_t* context) const noexcept { cairo_destroy(context); }
};
using Context = std::unique_ptr<cairo_t, ContextRelease>;

void set_colour(cairo_t* to, const Rgb& colour) {
  cairo_set_source_rgb(to, colour[0] / 255.0, colour[1] / 255.0, colour[2] / 255.0);
}

void draw_layer(cairo_t* to, const Layer& layer) {
  set_colour(to, layer.colour);
  cairo_set_line_width(to, layer.width);
  for (const Stroke& stroke : layer.strokes) {
    for (const auto& point : stroke.points) cairo_line_to(to, point[0], point[1]);
    if (stroke.closed) cairo_close_path(to);
    cairo_stroke(to);
  }
}

void draw_label(cairo_t* to, const Label& label) {
  cairo_text_extents_t extents;
  cairo_text_extents(to, label.text.c_str(), &extents);
  const double back = label.anchor == Label::Anchor::start    ? 0.0
                      : label.anchor == Label::Anchor::middle ? extents.x_advance / 2.0
                                                              : extents.x_advance;
  cairo_move_to(to, label.x - back, label.y);
  cairo_show_text(to, label.text.c_str());
}

void draw(cairo_t* to, const Drawing& drawing, cairo_surface_t* image) {
  set_colour(to, {255, 255, 255});
  cairo_paint(to);
  cairo_set_source_surface(to, image, drawing.image_x, drawing.image_y);
  cairo_paint(to);
  cairo_set_line_join(to, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(to, CAIRO_LINE_CAP_ROUND);
  for (const Layer& layer : drawing.layers) draw_layer(to, layer);
  for (const Box& box : drawing.boxes) {
    set_colour(to, box.colour);
    cairo_rectangle(to, box.x, box.y, box.width, box.height);
    cairo_fill(to);
  }
  set_colour(to, {20, 20, 20});
  cairo_select_font_face(to, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(to, drawing.text_size);
  for (const Label& label : drawing.labels) draw_label(to, label);
}

Result<void> ok(cairo_status_t status) {
  if (status == CAIRO_STATUS_SUCCESS) return success();
  return fail(Errc::io, "cannot draw: ", cairo_status_to_string(status));
}

struct PngTarget {
  const ByteSink& sink;
  Result<void> result = success();
};

cairo_status_t take_png(void* closure, const unsigned char* bytes, unsigned length) {
  auto& target = *static_cast<PngTarget*>(closure);
  target.result = target.sink({reinterpret_cast<const char*>(bytes), length});
  return target.result ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

} // namespace

Surface surface_over(const Image& image) {
  // cairo takes no const pixels, but a surface that is only read from does not write them.
  auto* pixels = reinterpret_cast<unsigned char*>(const_cast<std::uint32_t*>(image.pixels.data()));
  return Surface(cairo_image_surface_create_for_data(pixels, CAIRO_FORMAT_RGB24, image.width, image.height, 4 * image.width));
}

Result<void> encode_png(cairo_surface_t* surface, const ByteSink& sink) {
  PngTarget target{sink};
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface, take_png, &target);
  SCANSION_TRY(target.result);
  return ok(status);
}

Result<PictureFormat> parse_picture_format(std::string_view name) {
  if (name == "png") return PictureFormat::png;
  if (name == "svg") return PictureFormat::svg;
  return fail(Errc::usage, "pictures are not written as '", name, "'; take --format png or svg");
}

Result<void> write_png(const Drawing& drawing, OutputFile& file) {
  const Surface image = surface_over(drawing.image);
  SCANSION_TRY(ok(cairo_surface_status(image.get())));
  const Surface page(cairo_image_surface_create(CAIRO_FORMAT_RGB24, drawing.width, drawing.height));
  const Context context(cairo_create(page.get()));
  draw(context.get(), drawing, image.get());
  SCANSION_TRY(ok(cairo_status(context.get())));
  return encode_png(page.get(), [&](std::string_view bytes) { return file.append(bytes); });
}

} // namespace scansion
