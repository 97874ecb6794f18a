// Runs the tests on driver recordings; --update writes the golden files anew.
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/drivers/recordings_test.hpp"

#include <gtest/gtest.h>
#include <string_view>

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  for (int i = 1; i < argc; ++i) scansion::test::update_golden |= std::string_view(argv[i]) == "--update";
  return RUN_ALL_TESTS();
}
