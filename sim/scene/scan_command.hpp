// The scansim command line that makes a scan again, as it stands in the scan's own header.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/scene/scan_plan.hpp"

#include <string>

namespace scansion {

/// The shortest decimal that reads back as `value`.
[[nodiscard]] std::string shortest(double value);

/// "scansim scene NAME --lines 20 ... --seed 7 --noise 5": the options that were given, seed and noise always; no output file.
[[nodiscard]] std::string scan_command(const Scene& scene, const ScanPlan& plan);

/// The comment rows on top of an xyz file: the command, the unit and the sampling.
[[nodiscard]] std::string scan_header(const Scene& scene, const ScanPlan& plan, const ScanGeometry& geometry);

} // namespace scansion
