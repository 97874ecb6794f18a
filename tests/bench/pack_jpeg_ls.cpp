// JPEG-LS by CharLS.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/packers.hpp"

#ifdef SCANSION_BENCH_CHARLS

#include <charls/charls.h>

namespace scansion::bench {
namespace {

std::uint64_t encode(const Image& image) {
  std::size_t written = 0;
  charls_jpegls_encoder* encoder = charls_jpegls_encoder_create();
  if (encoder == nullptr) return 0;
  const charls_frame_info frame{image.width, image.height, 16, 1};
  std::size_t room = 0;
  std::string out;
  const auto ok = [](charls_jpegls_errc code) { return code == charls::jpegls_errc::success; };
  if (ok(charls_jpegls_encoder_set_frame_info(encoder, &frame)) &&
      ok(charls_jpegls_encoder_get_estimated_destination_size(encoder, &room))) {
    out.resize(2 * room + 4096);
    if (!ok(charls_jpegls_encoder_set_destination_buffer(encoder, out.data(), out.size())) ||
        !ok(charls_jpegls_encoder_encode_from_buffer(encoder, image.pixels.data(), 2 * image.pixels.size(), 0)) ||
        !ok(charls_jpegls_encoder_get_bytes_written(encoder, &written)))
      written = 0;
  }
  charls_jpegls_encoder_destroy(encoder);
  return written;
}

} // namespace

Packed pack_jpeg_ls(const Groups& groups) {
  return pack_images(groups, encode);
}

} // namespace scansion::bench

#else

namespace scansion::bench {

Packed pack_jpeg_ls(const Groups& /*groups*/) {
  return {0, "not built: libcharls-dev"};
}

} // namespace scansion::bench

#endif
