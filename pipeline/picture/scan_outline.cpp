// Where a scan lies and how far its samples are apart.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/picture/scan_outline.hpp"

#include <algorithm>
#include <cmath>

namespace scansion {
namespace {

/// A scan line as its chord, seen from above.
struct Chord {
  std::uint64_t line = 0;
  std::array<double, 2> middle{}, along{};
};

constexpr std::size_t kChords = 1U << 16U; // enough to know the spacing by
constexpr double kEverywhere = 1e300;

class Outliner {
public:
  explicit Outliner(const Millimetre& millimetre) : millimetre_(millimetre) {
    out_.low.fill(kEverywhere);
    out_.high.fill(-kEverywhere);
  }

  void add(const DecodedGroup& decoded) {
    const LineGroup& group = decoded.group;
    for (const ScanLine& line : group.lines) {
      ++out_.lines;
      std::size_t seen = 0;
      std::array<double, 3> first{};
      std::array<double, 3> last{};
      for (const Run& run : group.runs_of(line)) {
        out_.points += run.count;
        steps_ += run.count - 1;
        bool inside = false;
        for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
          if (decoded.width[i] == DecodedGroup::kUnknown) continue;
          const auto at = millimetre_.position(group, i);
          if (inside) path_ += std::hypot(at[0] - last[0], at[1] - last[1]);
          if (seen++ == 0) first = at;
          last = at;
          inside = true;
          widen(at);
        }
      }
      if (seen > 1 && chords_.size() < kChords)
        chords_.push_back(
            {line.index, {(first[0] + last[0]) / 2, (first[1] + last[1]) / 2}, {last[0] - first[0], last[1] - first[1]}});
    }
  }

  ScanOutline finish() {
    if (steps_ > 0) out_.step_mm = path_ / static_cast<double>(steps_);
    out_.advance = advance();
    return out_;
  }

private:
  void widen(const std::array<double, 3>& at) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      out_.low[axis] = std::min(out_.low[axis], at[axis]);
      out_.high[axis] = std::max(out_.high[axis], at[axis]);
    }
  }

  /// Zigzag lines count in one direction.
  [[nodiscard]] std::array<double, 2> direction() const {
    std::array<double, 2> sum{};
    for (const Chord& chord : chords_) {
      const double sign = chord.along[0] * sum[0] + chord.along[1] * sum[1] < 0.0 ? -1.0 : 1.0;
      sum[0] += sign * chord.along[0];
      sum[1] += sign * chord.along[1];
    }
    const double length = std::hypot(sum[0], sum[1]);
    if (!(length > 0.0)) return {};
    return {sum[0] / length, sum[1] / length};
  }

  [[nodiscard]] std::array<double, 2> advance() const {
    const auto along = direction();
    const std::array<double, 2> across{-along[1], along[0]};
    std::vector<double> spacings;
    for (std::size_t i = 1; i < chords_.size(); ++i) {
      const Chord& a = chords_[i - 1];
      const Chord& b = chords_[i];
      if (b.line != a.line + 1) continue;
      const double spacing = std::fabs((b.middle[0] - a.middle[0]) * across[0] + (b.middle[1] - a.middle[1]) * across[1]);
      if (spacing > 0.0) spacings.push_back(spacing);
    }
    if (spacings.empty()) return {};
    const auto half = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
    std::nth_element(spacings.begin(), half, spacings.end());
    return {across[0] * *half, across[1] * *half};
  }

  const Millimetre& millimetre_;
  ScanOutline out_;
  double path_ = 0.0;
  std::uint64_t steps_ = 0;
  std::vector<Chord> chords_;
};

} // namespace

Result<ScanOutline> outline_of(RecordingReader& reader) {
  SCANSION_TRY(resolution, resolution_mm(reader.facts().lattice));
  const Millimetre millimetre(reader.facts().lattice, resolution);
  Outliner outliner(millimetre);
  DecodedGroup decoded;
  for (std::size_t g = 0; g < reader.groups().size(); ++g) {
    SCANSION_TRY(reader.read_group(g, reader.facts().stored_levels - 1, decoded));
    outliner.add(decoded);
  }
  ScanOutline out = outliner.finish();
  if (out.points == 0) return fail(Errc::undecodable, "the recording has no point to show");
  return out;
}

} // namespace scansion
