// JPEG XL by libjxl, lossless, effort 7.
// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/packers.hpp"

#ifdef SCANSION_BENCH_JXL

#include <jxl/encode.h>

namespace scansion::bench {
namespace {

bool feed(JxlEncoder* encoder, const Image& image) {
  JxlBasicInfo info;
  JxlEncoderInitBasicInfo(&info);
  info.xsize = image.width;
  info.ysize = image.height;
  info.bits_per_sample = 16;
  info.num_color_channels = 1;
  info.uses_original_profile = JXL_TRUE;
  JxlColorEncoding colour;
  JxlColorEncodingSetToSRGB(&colour, JXL_TRUE);
  const JxlPixelFormat format{1, JXL_TYPE_UINT16, JXL_NATIVE_ENDIAN, 0};
  if (JxlEncoderSetBasicInfo(encoder, &info) != JXL_ENC_SUCCESS) return false;
  if (JxlEncoderSetColorEncoding(encoder, &colour) != JXL_ENC_SUCCESS) return false;
  if (const int level = JxlEncoderGetRequiredCodestreamLevel(encoder); level == 10)
    JxlEncoderSetCodestreamLevel(encoder, level);
  JxlEncoderFrameSettings* settings = JxlEncoderFrameSettingsCreate(encoder, nullptr);
  if (JxlEncoderSetFrameLossless(settings, JXL_TRUE) != JXL_ENC_SUCCESS) return false;
  if (JxlEncoderFrameSettingsSetOption(settings, JXL_ENC_FRAME_SETTING_EFFORT, 7) != JXL_ENC_SUCCESS) return false;
  if (JxlEncoderAddImageFrame(settings, &format, image.pixels.data(), 2 * image.pixels.size()) != JXL_ENC_SUCCESS) return false;
  JxlEncoderCloseInput(encoder);
  return true;
}

std::uint64_t encode(const Image& image) {
  JxlEncoder* encoder = JxlEncoderCreate(nullptr);
  if (encoder == nullptr) return 0;
  std::uint64_t written = 0;
  if (feed(encoder, image)) {
    std::vector<std::uint8_t> out(4 * image.pixels.size() + 65536);
    std::uint8_t* next = out.data();
    std::size_t room = out.size();
    if (JxlEncoderProcessOutput(encoder, &next, &room) == JXL_ENC_SUCCESS) written = out.size() - room;
  }
  JxlEncoderDestroy(encoder);
  return written;
}

} // namespace

Packed pack_jpeg_xl(const Groups& groups) {
  return pack_images(groups, encode);
}

} // namespace scansion::bench

#else

namespace scansion::bench {

Packed pack_jpeg_xl(const Groups& /*groups*/) {
  return {0, "not built: libjxl-dev"};
}

} // namespace scansion::bench

#endif
