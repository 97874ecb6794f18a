// Messages of devices for `scansion tail`.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/control/tail.hpp"
#include "daemon/journal/sink.hpp"

namespace scansion {

/// One message for each line of `group`: device, line, points, runs, invalid, realtime.
void tell_lines(TailHub& hub, std::string_view device, const LineGroup& group);
void tell_state(TailHub& hub, std::string_view device, std::string_view state);
/// Sinks that tell of gaps, of files begun and finished, and of each feature line, and pass everything on. `hub` outlives them.
[[nodiscard]] SinkFactory telling_sinks(SinkFactory sinks, TailHub& hub);

} // namespace scansion
