// What stands in the way of opening a port.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/serial_list.hpp"
#include "drivers/transport/unique_fd.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>

namespace scansion {
namespace {

TEST(SerialList, NamesWhatStandsInTheWay) {
  const std::string path = testing::TempDir() + "scansion-port-" + std::to_string(::getpid());
  const UniqueFd port(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600));
  ASSERT_TRUE(port);
  std::string problem;
  std::string fix;
  check_access(path, problem, fix);
  EXPECT_EQ(problem, "");
  ASSERT_EQ(::flock(port.get(), LOCK_EX), 0);
  check_access(path, problem, fix);
  EXPECT_EQ(problem, "in use by another program");
  EXPECT_NE(fix, "");
  ::unlink(path.c_str());
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
