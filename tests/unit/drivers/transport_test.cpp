// Ports against pseudo terminals, sockets and files: bytes, deadlines, hang-ups, locks.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/descriptor.hpp"
#include "drivers/transport/options.hpp"
#include "drivers/transport/ports.hpp"

#include <arpa/inet.h>
#include <cstdlib>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

namespace scansion {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

std::string read_some(Transport& transport, std::int64_t wait_ns = 5 * kSecond) {
  std::uint8_t buffer[256];
  auto arrival = transport.read(buffer, transport.now().monotonic_ns + wait_ns);
  if (!arrival) return "[" + arrival.assume_error().context + "]";
  return {reinterpret_cast<const char*>(buffer), arrival.assume_value().count};
}

struct Pty {
  Pty() : master(::posix_openpt(O_RDWR | O_NOCTTY)) {
    if (!master || ::grantpt(master.get()) != 0 || ::unlockpt(master.get()) != 0) std::abort();
    char buffer[64];
    if (::ptsname_r(master.get(), buffer, sizeof buffer) != 0) std::abort();
    name = buffer;
  }
  UniqueFd master;
  std::string name;
};

void put(int fd, std::string_view text) {
  ASSERT_EQ(::write(fd, text.data(), text.size()), static_cast<ssize_t>(text.size()));
}

TEST(Serial, CarriesBytesThroughAPseudoTerminal) {
  Pty pty;
  auto port = serial_transport(pty.name, 115200);
  ASSERT_TRUE(port->open());
  put(pty.master.get(), std::string_view("a\r\n\x11\x03\0b", 7));
  EXPECT_EQ(read_some(*port), std::string("a\r\n\x11\x03\0b", 7)) << "nothing may be changed, echoed or taken for a command";
  ASSERT_TRUE(port->write("ask\n", port->now().monotonic_ns + kSecond));
  char buffer[16];
  ASSERT_EQ(::read(pty.master.get(), buffer, sizeof buffer), 4);
  EXPECT_EQ(std::string(buffer, 4), "ask\n");
  EXPECT_EQ(read_some(*port, 1'000'000), "");
}

TEST(Serial, HangUpIsAnErrorAfterTheLastBytes) {
  Pty pty;
  auto port = serial_transport(pty.name, 115200);
  ASSERT_TRUE(port->open());
  const std::int64_t before = port->now().monotonic_ns;
  pty.master.reset();
  EXPECT_EQ(read_some(*port), "[" + pty.name + ": lost, the port is gone (unplugged?)]");
  EXPECT_LT(port->now().monotonic_ns - before, kSecond / 10);
}

TEST(Serial, KeepsDtrUpWhereThatIsAsked) {
  Pty pty;
  for (const bool keeps : {false, true}) {
    termios settings{};
    ASSERT_EQ(::tcgetattr(pty.master.get(), &settings), 0);
    settings.c_cflag |= HUPCL;
    ASSERT_EQ(::tcsetattr(pty.master.get(), TCSANOW, &settings), 0);
    auto port = serial_transport(pty.name, 115200, keeps);
    ASSERT_TRUE(port->open());
    ASSERT_EQ(::tcgetattr(pty.master.get(), &settings), 0);
    EXPECT_EQ((settings.c_cflag & HUPCL) == 0, keeps);
  }
}

TEST(Serial, IsLockedAgainstASecondUser) {
  Pty pty;
  auto first = serial_transport(pty.name, 115200);
  auto second = serial_transport(pty.name, 115200);
  ASSERT_TRUE(first->open());
  auto opened = second->open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.assume_error().code, Errc::unavailable);
  first->close();
  EXPECT_TRUE(second->open());
}

TEST(Serial, AbsentAndWrongPortsSaySo) {
  auto absent = serial_transport("/dev/serial/by-id/none", 9600)->open();
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.assume_error().code, Errc::not_found);
  auto wrong = serial_transport("/dev/null", 9600)->open();
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.assume_error().context.find("no serial port"), std::string::npos);
}

TEST(Serial, FullOutputEndsAtTheDeadline) {
  Pty pty;
  auto port = serial_transport(pty.name, 115200);
  ASSERT_TRUE(port->open());
  const std::string much(1U << 20U, 'x');
  auto written = port->write(much, port->now().monotonic_ns + kSecond / 50);
  ASSERT_FALSE(written);
  EXPECT_NE(written.assume_error().context.find("takes no bytes"), std::string::npos);
}

struct Server {
  Server() : listener(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (::bind(listener.get(), reinterpret_cast<sockaddr*>(&address), size) != 0 || ::listen(listener.get(), 1) != 0 ||
        ::getsockname(listener.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0)
      std::abort();
    port = std::to_string(ntohs(address.sin_port));
  }
  UniqueFd listener;
  std::string port;
};

TEST(Tcp, CarriesBytesAndNoticesTheEnd) {
  Server server;
  auto link = tcp_transport({"127.0.0.1", server.port});
  ASSERT_TRUE(link->open());
  UniqueFd peer(::accept(server.listener.get(), nullptr, nullptr));
  ASSERT_TRUE(link->write("ask\n", link->now().monotonic_ns + kSecond));
  char buffer[16];
  ASSERT_EQ(::read(peer.get(), buffer, sizeof buffer), 4);
  put(peer.get(), "answer");
  EXPECT_EQ(read_some(*link), "answer");
  peer.reset();
  EXPECT_EQ(read_some(*link), "[tcp 127.0.0.1:" + server.port + ": lost, the connection was closed]");
}

TEST(Tcp, RefusedConnectionIsUnavailable) {
  std::string port;
  {
    const Server server;
    port = server.port;
  }
  auto opened = tcp_transport({"127.0.0.1", port})->open();
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.assume_error().code, Errc::unavailable);
}

TEST(File, IsReadToItsEnd) {
  const std::string path = testing::TempDir() + "scansion-file-" + std::to_string(::getpid());
  {
    UniqueFd out(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
    put(out.get(), "1 2 3\n");
  }
  auto file = file_transport(path);
  ASSERT_TRUE(file->open());
  EXPECT_FALSE(file->is_live());
  EXPECT_EQ(read_some(*file), "1 2 3\n");
  std::uint8_t byte[1];
  auto arrival = file->read(byte, 0);
  ASSERT_TRUE(arrival);
  EXPECT_TRUE(arrival.assume_value().end);
  ::unlink(path.c_str());
}

TEST(File, FifoOutlivesItsWriters) {
  const std::string path = testing::TempDir() + "scansion-fifo-" + std::to_string(::getpid());
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  auto fifo = file_transport(path);
  ASSERT_TRUE(fifo->open());
  EXPECT_TRUE(fifo->is_live());
  for (const char* text : {"one", "two"}) {
    UniqueFd writer(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
    put(writer.get(), text);
    writer.reset();
    EXPECT_EQ(read_some(*fifo), text);
    EXPECT_EQ(read_some(*fifo, 1'000'000), "");
  }
  ::unlink(path.c_str());
}

TEST(HostPort, IsReadStrictly) {
  EXPECT_EQ(parse_host_port("10.0.0.1:10940").assume_value(), (HostPort{"10.0.0.1", "10940"}));
  EXPECT_EQ(parse_host_port("[::1]:5").assume_value(), (HostPort{"::1", "5"}));
  EXPECT_EQ(parse_host_port(":5000").assume_value(), (HostPort{"", "5000"}));
  for (const char* text : {"", "host", "host:", "host:0", "host:65536", "host:-1", "::1:5", "host:5x"}) {
    EXPECT_FALSE(parse_host_port(text)) << text;
  }
}

TEST(TransportOptions, ExactlyOneWayIsTaken) {
  constexpr TransportKinds kinds{.serial = true, .tcp = true};
  OptionValues values;
  values.set("baud", std::int64_t{9600});
  EXPECT_FALSE(make_transport(values, kinds, std::make_shared<RawRing>()));
  values.set("port", std::string("/dev/ttyS0"));
  EXPECT_TRUE(make_transport(values, kinds, std::make_shared<RawRing>()));
  values.set("tcp", std::string("a:1"));
  auto both = make_transport(values, kinds, std::make_shared<RawRing>());
  ASSERT_FALSE(both);
  EXPECT_EQ(both.assume_error().code, Errc::config);
}

} // namespace
} // namespace scansion
