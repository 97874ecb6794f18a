// Points as binary little-endian PLY and PCD. Their headers hold the number of points, which is patched in at the end.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/export/point_writer.hpp"

#include <bit>
#include <cstring>

namespace scansion {
namespace {

// The header is written with the widest count and padded inside a comment, so that the real one fits its place.
constexpr std::size_t kCountWidth = 20;

template <class T>
char* put_le(char* to, T value) noexcept {
  static_assert(std::endian::native == std::endian::little, "PLY and PCD are written in the machine's order");
  std::memcpy(to, &value, sizeof value);
  return to + sizeof value;
}

class BinaryWriter : public PointWriter {
public:
  BinaryWriter(const ValueFormat& values, PointStyle style) : values_(values), style_(std::move(style)) {}

  [[nodiscard]] Result<void> begin(OutputFile& file) override { return file.append(header(0)); }
  [[nodiscard]] Result<void> line(OutputFile& file, std::uint64_t index, const LineGroup& group,
                                  std::span<const std::uint32_t> points) override {
    if (index > 0xFFFFFFFFU)
      return fail(Errc::out_of_range, "line ", std::to_string(index),
                  " does not fit the 32 bit line number of this format; use csv");
    constexpr std::size_t kRecord = 3 * sizeof(double) + sizeof(std::uint32_t);
    for (const std::uint32_t p : points) {
      SCANSION_TRY(to, file.reserve(kRecord));
      char* end = to;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double v = values_.value(axis, group.xyz[axis][p], ulp_of(group, axis, p));
        end = style_.single ? put_le(end, static_cast<float>(v)) : put_le(end, v);
      }
      end = put_le(end, static_cast<std::uint32_t>(index));
      file.advance(static_cast<std::size_t>(end - to));
    }
    points_ += points.size();
    return success();
  }
  [[nodiscard]] Result<void> end(OutputFile& file) override { return file.patch(0, header(points_)); }

protected:
  [[nodiscard]] virtual std::string header(std::uint64_t points) const = 0;
  [[nodiscard]] static std::string padding(std::size_t used) { return std::string(kCountWidth - used, '.'); }
  [[nodiscard]] std::string remark() const {
    return "unit " + std::string(name(style_.unit)) + (style_.remark.empty() ? "" : ", " + style_.remark);
  }

  ValueFormat values_;
  PointStyle style_;
  std::uint64_t points_ = 0;
};

class PlyWriter final : public BinaryWriter {
public:
  using BinaryWriter::BinaryWriter;

private:
  [[nodiscard]] std::string header(std::uint64_t points) const override {
    const std::string count = std::to_string(points);
    const std::string type = style_.single ? "float" : "double";
    return "ply\nformat binary_little_endian 1.0\ncomment scansion points, " + remark() + "\nelement vertex " + count +
           "\nproperty " + type + " x\nproperty " + type + " y\nproperty " + type + " z\nproperty uint line\ncomment " +
           padding(count.size()) + "\nend_header\n";
  }
};

class PcdWriter final : public BinaryWriter {
public:
  using BinaryWriter::BinaryWriter;

private:
  [[nodiscard]] std::string header(std::uint64_t points) const override {
    const std::string count = std::to_string(points);
    const std::string size = style_.single ? "4" : "8";
    return "# .PCD v0.7 - scansion points, " + remark() + "\n# " + padding(count.size()) + padding(count.size()) +
           "\nVERSION 0.7\nFIELDS x y z line\nSIZE " + size + " " + size + " " + size +
           " 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH " + count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count +
           "\nDATA binary\n";
  }
};

} // namespace

std::unique_ptr<PointWriter> make_binary_writer(PointFormat format, const ValueFormat& values, const PointStyle& style) {
  if (format == PointFormat::pcd) return std::make_unique<PcdWriter>(values, style);
  return std::make_unique<PlyWriter>(values, style);
}

} // namespace scansion
