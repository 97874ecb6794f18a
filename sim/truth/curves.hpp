// The true feature curves of a scene within a scan.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/scene/scan_plan.hpp"
#include "sim/scene/scene.hpp"
#include "sim/truth/truth.hpp"

namespace scansion {

/// The least turning that counts as an edge, degrees.
inline constexpr double kLeastTurning = 7.0;
/// An arc of a greater radius is a smooth surface and no edge, mm.
inline constexpr double kLargestFillet = 3.0;

/// Does this bend make a line when nothing else is near?
[[nodiscard]] bool bends_enough(const ProfileBend& bend) noexcept;

/// Curves inside the scan window, cut where the bend is too weak, where another feature's wall breaks them and where a leaning
/// scan plane does not see them.
[[nodiscard]] std::vector<TrueCurve> true_curves(const Scene& scene, const ScanGeometry& geometry);

} // namespace scansion
