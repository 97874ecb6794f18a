// What a patch is: face, wall, fillet, floor or top of a form feature (docs/FEATURES.md, "Forms").
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/feature/patch/patch_role.hpp"
#include "pipeline/feature/profile/sampling.hpp"

#include <vector>

namespace scansion {

/// Labels patch `id` by what it borders on, and adds the form features that are complete with it to `forms`: each once, with
/// its floor, top or larger flank first, a step with its upper level first.
[[nodiscard]] FormKind name_forms(PatchGraph& graph, std::uint32_t id, PatchLooks& looks, const Sampling& sampling,
                                  std::vector<Form>& forms);

} // namespace scansion
