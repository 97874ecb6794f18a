// Feature lines, patches and forms: the values that the feature stage publishes. Positions are millimetres in the frame of the
// recording. After sections 4 to 6 of the paper; what each attribute means stands in docs/FEATURES.md.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace scansion {

/// What a feature line runs along.
enum class FeatureType : std::uint8_t { convex, concave, step_top, step_bottom, ridge, valley };
inline constexpr std::size_t kFeatureTypes = 6;
[[nodiscard]] std::string_view name(FeatureType type) noexcept; ///< "convex", "concave", "step-top", ...

/// The shape of a profile at one point (after Tab. 1 of the paper).
enum class ShapeElement : std::uint8_t {
  straight,
  peak,
  blade,
  pit,
  slit,
  shoulder_falling,
  shoulder_levelling,
  foot_levelling,
  foot_rising,
  slope_change_convex,
  slope_change_concave,
  weak_bend_convex,
  weak_bend_concave,
  wall_bend_convex,
  wall_bend_concave,
  step_top,
  step_bottom
};
inline constexpr std::size_t kShapeElements = 17;
[[nodiscard]] std::string_view name(ShapeElement element) noexcept;

struct FeatureVertex {
  std::array<double, 3> position{}; ///< mm
  std::uint64_t line = 0;           ///< index of the scan line it was found on
  std::uint32_t index = 0;          ///< of the nearest sample of that line, counted over all its runs

  friend bool operator==(const FeatureVertex&, const FeatureVertex&) = default;
};

/// Why a feature line ends where it does.
enum class FeatureEnd : std::uint8_t {
  open,     ///< it goes on: the recording, or this piece of the line, ends here
  death,    ///< no longer found
  border,   ///< the scan ends here
  gap,      ///< scan lines are missing here
  junction, ///< it runs into another feature line
  cap       ///< it closes with another line that ends here
};
inline constexpr std::size_t kFeatureEnds = 6;
[[nodiscard]] std::string_view name(FeatureEnd end) noexcept;

struct MeanDeviation {
  double mean = 0.0, deviation = 0.0;

  friend bool operator==(const MeanDeviation&, const MeanDeviation&) = default;
};

/// The first or the last vertex of a feature line.
struct LineEnd {
  std::uint64_t line = 0; ///< id
  bool last = false;

  friend bool operator==(const LineEnd&, const LineEnd&) = default;
};

/// A feature line, or a piece of one that is very long. Pieces share the id and stand in the order of their numbers, which may
/// be below 0: a line may grow at both ends. The last vertex of one is the first of the next, and they meet with `open` ends.
/// The attributes of a piece are its own; join_pieces() puts them together.
struct FeatureLine {
  std::uint64_t id = 0;
  std::int32_t piece = 0;
  std::optional<LineEnd> begins_at, ends_at; ///< of another line in pieces, which goes on from here: both are one line
  FeatureType type = FeatureType::convex;
  std::uint32_t level = 0; ///< k of the coarsest S_k that holds most of its points
  bool closed_loop = false;
  FeatureEnd begins = FeatureEnd::death, ends = FeatureEnd::death;
  std::vector<FeatureVertex>
      vertices;             ///< those that matter: what was found between them lies within a tenth of u (see FEATURES.md)
  std::uint32_t per_mm = 1; ///< positions are whole multiples of 1 / per_mm mm

  double length_mm = 0.0;
  std::uint64_t scan_lines = 0;                         ///< on which it was seen
  MeanDeviation inner_angle, orientation, turning;      ///< delta, beta, tau in degrees
  MeanDeviation width;                                  ///< log2(D / finest tolerance of the feature stage)
  double sharpness = 0.0;                               ///< mean Lambda: above 0 a corner, below an arc
  double guided_share = 0.0;                            ///< of its points: measured where the line was expected
  double persistence = 0.0;                             ///< length in units of five sampling steps
  double across_mm = 0.0;                               ///< uncertainty of a step between two scan lines; 0: none stated
  std::array<std::uint32_t, kShapeElements> elements{}; ///< how often each shape was seen
  std::optional<std::uint64_t> partner;                 ///< the other edge of a step
  std::vector<std::uint64_t> junctions;                 ///< feature lines that it runs into, or that run into it
  std::vector<LineEnd> met_by; ///< ends of lines published before that run into this one; join_pieces() makes junctions of them

  [[nodiscard]] bool is_open() const noexcept { return begins == FeatureEnd::open || ends == FeatureEnd::open; }
  friend bool operator==(const FeatureLine&, const FeatureLine&) = default;
};

/// A stretch of one scan line that belongs to one patch.
struct PatchRun {
  std::uint64_t line = 0;
  std::uint32_t first = 0, count = 0; ///< samples of that line, counted over all its runs
  std::uint32_t patch = 0;            ///< id when it was published; see PatchMerge

  friend bool operator==(const PatchRun&, const PatchRun&) = default;
};

/// From now on the samples of patch `from` belong to `into`.
struct PatchMerge {
  std::uint32_t from = 0, into = 0;

  friend bool operator==(const PatchMerge&, const PatchMerge&) = default;
};

enum class PatchShape : std::uint8_t { plane, cylinder, free_form };
inline constexpr std::size_t kPatchShapes = 3;
[[nodiscard]] std::string_view name(PatchShape shape) noexcept;

enum class FormKind : std::uint8_t { face, fillet, chamfer, wall, rib, boss, slot, pocket, step, hole };
inline constexpr std::size_t kFormKinds = 10;
[[nodiscard]] std::string_view name(FormKind kind) noexcept;

/// A patch at its end, or when the recording ends.
struct Patch {
  std::uint32_t id = 0;
  FormKind label = FormKind::face;
  PatchShape shape = PatchShape::plane;
  std::uint64_t samples = 0;
  double area_mm2 = 0.0;
  std::array<double, 3> centroid{}, normal{};                ///< mm; unit vector
  double plane_residual_mm = 0.0, quadric_residual_mm = 0.0; ///< root mean square
  std::vector<std::uint32_t> neighbours;
  bool doubtful = false; ///< grown together over a contact that is short against its cut border

  friend bool operator==(const Patch&, const Patch&) = default;
};

/// Place and size of a hole, in plan of the scan.
struct HoleSize {
  std::array<double, 3> middle{};         ///< mm; at the height of its rim
  double along_mm = 0.0, across_mm = 0.0; ///< its extent along the scan lines and across them
  double area_mm2 = 0.0;
  std::uint64_t rim = 0; ///< id of the feature line around it

  [[nodiscard]] double diameter_mm() const noexcept; ///< of the circle of this area
  friend bool operator==(const HoleSize&, const HoleSize&) = default;
};

/// A form feature: the patches that make it up; of a hole the one that it lies in.
struct Form {
  FormKind kind = FormKind::face;
  std::vector<std::uint32_t> patches;
  double confidence = 0.0;        ///< share of its border that feature lines back; of a hole's outline, that is its rim
  std::optional<HoleSize> hole{}; ///< of holes only

  friend bool operator==(const Form&, const Form&) = default;
};

/// Of a scan whose lines run to and fro.
struct Backlash {
  double mm = 0.0;           ///< by which lines scanned against the first one say that things lie further along it
  double deviation_mm = 0.0; ///< its uncertainty, one sigma
  double taken_off_mm = 0.0; ///< from these lines, where features were looked for
  std::uint64_t places = 0;  ///< of features on three successive lines, from which it was found

  friend bool operator==(const Backlash&, const Backlash&) = default;
};

/// What the feature stage found out between two groups of lines; everything in it is settled.
struct FeatureReport {
  std::uint64_t group = 0; ///< the group after whose lines it was made
  std::vector<FeatureLine> lines;
  std::vector<PatchRun> runs;
  std::vector<PatchMerge> merges;
  std::vector<Patch> patches;
  std::vector<Form> forms;
  std::optional<Backlash> backlash; ///< the newest

  [[nodiscard]] bool empty() const noexcept {
    return !backlash && lines.empty() && runs.empty() && merges.empty() && patches.empty() && forms.empty();
  }
  void clear() noexcept {
    lines.clear();
    runs.clear();
    merges.clear();
    patches.clear();
    forms.clear();
    backlash.reset();
  }
  friend bool operator==(const FeatureReport&, const FeatureReport&) = default;
};

} // namespace scansion
