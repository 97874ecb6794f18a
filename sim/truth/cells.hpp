// Cells of a scene: which stretch of which feature's cross-section a place lies on.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/scene/scene.hpp"
#include "sim/truth/truth.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

namespace scansion {

/// Numbers the cells of one scene as they are met; edges that are lines of their own part them. Thread-bound.
class Cells {
public:
  explicit Cells(const Scene& scene);

  /// The cell of a sample at (x, y, z), mm; the height decides at vertical walls.
  [[nodiscard]] std::uint32_t at(double x, double y, double z);

  /// Does the edge of `feature` part the two?
  [[nodiscard]] bool parted_by(std::size_t feature, std::uint32_t a, std::uint32_t b) const noexcept {
    return code(a, feature) != code(b, feature);
  }
  /// Is the cell a wall, top, floor or flank of `feature`?
  [[nodiscard]] bool inside(std::size_t feature, std::uint32_t cell) const noexcept;
  /// As the last feature has it in which the cell lies; a face outside of all.
  [[nodiscard]] FormKind kind(std::uint32_t cell) const noexcept;
  /// What the whole feature is; a face when it is nothing with a name.
  [[nodiscard]] FormKind form(std::size_t feature) const noexcept { return zones_[feature].form; }

private:
  struct Cut {
    double d = 0.0;
    bool wall = false; ///< a vertical one
    bool concave = false;
  };
  struct Zones {
    std::vector<Cut> cuts;       // ascending
    std::vector<FormKind> kinds; // of the stretches between them, one more than cuts
    std::size_t middle = 0;      // the innermost stretch that has a place
    bool crested = false;        // which slopes up or down to its crest
    FormKind form = FormKind::face;
  };
  [[nodiscard]] static Zones zones_of(const Feature& feature);
  [[nodiscard]] std::uint8_t code_at(std::size_t feature, double x, double y, double z) const noexcept;
  [[nodiscard]] std::uint8_t code(std::uint32_t cell, std::size_t feature) const noexcept {
    return codes_[cell * zones_.size() + feature];
  }

  const Scene& scene_;
  std::vector<Zones> zones_;
  std::vector<std::uint8_t> codes_; // of all cells, one a feature: 16 * stretch + 2 * sector + (1 on a vertical wall's face)
  std::string key_;
  std::unordered_map<std::string, std::uint32_t> numbers_;
};

} // namespace scansion
