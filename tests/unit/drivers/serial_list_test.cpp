// What stands in the way of opening a port.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/serial_list.hpp"
#include "drivers/transport/unique_fd.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/file.h>

namespace scansion {
namespace {

// On a device node, as ports are: /proc/locks names files of an overlay file system otherwise than stat does.
TEST(SerialList, NamesWhatStandsInTheWay) {
  UniqueFd master(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
  char path[64];
  ASSERT_TRUE(master && ::grantpt(master.get()) == 0 && ::unlockpt(master.get()) == 0 &&
              ::ptsname_r(master.get(), path, sizeof path) == 0);
  const UniqueFd port(::open(path, O_RDWR | O_NOCTTY | O_CLOEXEC));
  ASSERT_TRUE(port);
  std::string problem;
  std::string fix;
  check_access(path, problem, fix);
  EXPECT_EQ(problem, "");
  ASSERT_EQ(::flock(port.get(), LOCK_EX), 0);
  check_access(path, problem, fix);
  EXPECT_EQ(problem, "in use by another program");
  EXPECT_NE(fix, "");
  ASSERT_EQ(::flock(port.get(), LOCK_UN), 0);
  check_access(path, problem, fix);
  EXPECT_EQ(problem, "");
  EXPECT_EQ(fix, "");
  master.reset();
  check_access(path, problem, fix);
  EXPECT_NE(problem, "");
}

TEST(SerialList, PortsAreOrdered) {
  auto ports = list_serial_ports();
  ASSERT_TRUE(ports);
  for (std::size_t i = 1; i < ports.assume_value().size(); ++i) {
    EXPECT_LT(ports.assume_value()[i - 1].path, ports.assume_value()[i].path);
    EXPECT_FALSE(ports.assume_value()[i].selector.empty());
  }
}

} // namespace
} // namespace scansion
