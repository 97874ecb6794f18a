// An image as PNG bytes through cairo.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/picture/drawing.hpp"

#include <cairo.h>
#include <functional>
#include <memory>

namespace scansion {

struct SurfaceRelease {
  void operator()(cairo_surface_t* surface) const noexcept { cairo_surface_destroy(surface); }
};
using Surface = std::unique_ptr<cairo_surface_t, SurfaceRelease>;

/// A surface over the pixels of `image`, which must outlive it and is not changed.
[[nodiscard]] Surface surface_over(const Image& image);
/// Gives the bytes piece by piece to `sink`, a callable of Result<void>(std::string_view).
using ByteSink = std::function<Result<void>(std::string_view)>;
[[nodiscard]] Result<void> encode_png(cairo_surface_t* surface, const ByteSink& sink);

} // namespace scansion
