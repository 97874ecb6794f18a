// scansion record: apart from the other verbs, since it alone needs sessions of devices.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/cli/command.hpp"

namespace scansion::cli {

[[nodiscard]] Verb add_record(CLI::App& root);

} // namespace scansion::cli
