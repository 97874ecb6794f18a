// What main() needs to know of a verb of scansim.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <functional>

namespace CLI {
class App;
}

namespace scansion {

struct Verb {
  CLI::App* command = nullptr;       ///< owned by the application it was added to
  std::function<Result<void>()> run; ///< after parsing, when `command` was given
};

} // namespace scansion
