// What a patch is: face, wall, fillet, floor or top of a form feature (docs/FEATURES.md, "Forms").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/patch_graph.hpp"
#include "pipeline/feature/sampling.hpp"

namespace scansion {

/// The label of patch `id` by its borders, and how much of them is backed by feature lines.
struct Labelled {
  FormKind kind = FormKind::face;
  double confidence = 0.0;
};
[[nodiscard]] Labelled label_patch(PatchGraph& graph, std::uint32_t id, const Patch& patch, const Sampling& sampling);

} // namespace scansion
