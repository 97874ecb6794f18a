// Finds what a recording says about itself, in its head or in one of the copies behind it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/record/recording.hpp"
#include "pipeline/record/window.hpp"

namespace scansion {

struct Head {
  RecordingFacts facts;
  std::uint64_t size = 0; ///< where the first chunk starts
};

/// Walks the records of the head. Fails with undecodable when the file is none of ours (or of a newer version), with damaged
/// when the head is cut or broken.
[[nodiscard]] Result<Head> read_head(Window& window);

/// The facts from the head, or from the first intact copy anywhere in the file. Fails with damaged when there is none.
[[nodiscard]] Result<RecordingFacts> find_facts(Window& window);

} // namespace scansion
