// The words for feature types, shapes and forms, and what follows from their values.
// SPDX-License-Identifier: Apache-2.0
#include "pipeline/feature/feature_line.hpp"

#include <cmath>
#include <numbers>

namespace scansion {

namespace {

constexpr std::array<std::string_view, kFeatureTypes> kTypes = {"convex",      "concave", "step-top",
                                                                "step-bottom", "ridge",   "valley"};
constexpr std::array<std::string_view, kShapeElements> kElements = {"straight",
                                                                    "peak",
                                                                    "blade",
                                                                    "pit",
                                                                    "slit",
                                                                    "shoulder-falling",
                                                                    "shoulder-levelling",
                                                                    "foot-levelling",
                                                                    "foot-rising",
                                                                    "slope-change-convex",
                                                                    "slope-change-concave",
                                                                    "weak-bend-convex",
                                                                    "weak-bend-concave",
                                                                    "wall-bend-convex",
                                                                    "wall-bend-concave",
                                                                    "step-top",
                                                                    "step-bottom"};
constexpr std::array<std::string_view, kFeatureEnds> kEnds = {"open", "death", "border", "gap", "junction", "cap"};
constexpr std::array<std::string_view, kPatchShapes> kShapes = {"plane", "cylinder", "free-form"};
constexpr std::array<std::string_view, kFormKinds> kForms = {"face", "fillet", "chamfer", "wall", "rib",
                                                             "boss", "slot",   "pocket",  "step", "hole"};

} // namespace

double HoleSize::diameter_mm() const noexcept {
  return 2.0 * std::sqrt(area_mm2 / std::numbers::pi);
}

std::string_view name(FeatureType type) noexcept {
  return kTypes[static_cast<std::size_t>(type)];
}
std::string_view name(ShapeElement element) noexcept {
  return kElements[static_cast<std::size_t>(element)];
}
std::string_view name(FeatureEnd end) noexcept {
  return kEnds[static_cast<std::size_t>(end)];
}
std::string_view name(PatchShape shape) noexcept {
  return kShapes[static_cast<std::size_t>(shape)];
}
std::string_view name(FormKind kind) noexcept {
  return kForms[static_cast<std::size_t>(kind)];
}

} // namespace scansion
