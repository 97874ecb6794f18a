// Other ways to store the same points without loss. All but the text ones pack each group of up to 64 lines by itself.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/codec/codec.hpp"
#include "pipeline/model/scan_line.hpp"
#include "tests/bench/lines.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace scansion::bench {

struct Packed {
  std::uint64_t bytes = 0;
  std::string skipped; ///< why there is no figure; empty when there is one
};

using Groups = std::vector<LineGroup>;
using Pack = Packed (*)(const Groups&);

/// Bytes of integers as zigzag, byte planes (as many as the largest needs) and one zstd frame of level 3.
[[nodiscard]] std::uint64_t planes_bytes(std::span<const std::int64_t> values);

/// What any packer needs besides the points of the axes that are not regular. An axis is regular in a group when within every
/// run all steps are equal (an x of constant pitch, a constant y).
struct Shape {
  std::array<bool, 3> regular{};
  std::array<std::int64_t, 3> unit{1, 1, 1}; ///< greatest common divisor of all differences; for images and AEC
  std::uint64_t bytes = 0; ///< run lengths; first values and steps of regular axes, differences run to run; units: planes_bytes
};
[[nodiscard]] Shape shape_of(const LineGroup& group);

/// Delta to the point before in the run (to the run before for first points) of every axis that is not regular, planes_bytes.
[[nodiscard]] Packed pack_planes(const Groups& groups);

/// An axis of a group as an image, one line a row; short lines are filled up with their last value.
struct Image {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint16_t> pixels; ///< in units, from the smallest value of the group; where that does not fit, of the line
  std::uint64_t side_bytes = 0;      ///< of the smallest values
};
/// Images of the axes that are not regular; the reason when a value does not fit 16 bits.
[[nodiscard]] std::string images_of(const LineGroup& group, const Shape& shape, std::vector<Image>& images);
/// Packs all images of all groups by `encode`, which returns bytes or 0 when it failed.
[[nodiscard]] Packed pack_images(const Groups& groups, std::uint64_t (*encode)(const Image&));

[[nodiscard]] Packed pack_jpeg_ls(const Groups& groups); ///< CharLS
[[nodiscard]] Packed pack_jpeg_xl(const Groups& groups); ///< libjxl, effort 7
[[nodiscard]] Packed pack_aec(const Groups& groups);     ///< libaec (CCSDS 121), 32 bit, unit delay; in units

/// The points as text, the shortest decimals that are exact, as `scansion export` writes them.
[[nodiscard]] Result<std::string> text_of(const LineSet& set);
[[nodiscard]] Packed pack_text_xz(const std::string& text);   ///< xz -9
[[nodiscard]] Packed pack_text_zstd(const std::string& text); ///< zstd -19

/// The points farther than a tolerance alone, all groups in one stream: xz -9e of index and value differences as varints. What
/// regular axes and run lengths need is not counted.
[[nodiscard]] Packed pack_kept_xz(const Groups& groups, std::span<const GroupRanks> ranks, double tolerance_mm);

} // namespace scansion::bench
