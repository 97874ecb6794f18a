// Settings of the tests on driver recordings.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace scansion::test {

inline bool update_golden = false; ///< set before the tests run

} // namespace scansion::test
