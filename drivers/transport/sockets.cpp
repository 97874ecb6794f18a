// TCP and UDP.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/descriptor.hpp"
#include "drivers/transport/ports.hpp"

#include <cerrno>
#include <charconv>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

namespace scansion {
namespace {

constexpr std::int64_t kConnectNs = 2'000'000'000;

struct AddressFree {
  void operator()(addrinfo* list) const noexcept { ::freeaddrinfo(list); }
};
using Addresses = std::unique_ptr<addrinfo, AddressFree>;

std::string shown(const HostPort& address) {
  const bool is_v6 = address.host.find(':') != std::string::npos;
  return (is_v6 ? "[" + address.host + "]" : address.host) + ":" + address.port;
}

/// A name is looked up by the system, which may take its own time; a numeric address takes none.
Result<Addresses> resolve(const HostPort& address, int type, const std::string& name) {
  addrinfo hints{};
  hints.ai_socktype = type;
  hints.ai_flags = AI_NUMERICSERV | (type == SOCK_DGRAM ? AI_PASSIVE : 0);
  addrinfo* list = nullptr;
  const int problem = ::getaddrinfo(address.host.empty() ? nullptr : address.host.c_str(), address.port.c_str(), &hints, &list);
  if (problem != 0) return fail(Errc::unavailable, name, ": address not found: ", ::gai_strerror(problem));
  return Addresses(list);
}

void set_option(int fd, int level, int option, int value) noexcept {
  static_cast<void>(::setsockopt(fd, level, option, &value, sizeof value));
}

class TcpTransport final : public DescriptorTransport {
public:
  explicit TcpTransport(const HostPort& address) : DescriptorTransport("tcp " + shown(address)), address_(address) {}

  Result<void> open() override {
    close();
    SCANSION_TRY(list, resolve(address_, SOCK_STREAM, name()));
    const std::int64_t deadline = now().monotonic_ns + kConnectNs;
    Error last = make_error(Errc::unavailable, {name(), ": has no address"});
    for (const addrinfo* at = list.get(); at != nullptr; at = at->ai_next) {
      auto connected = connect(*at, deadline);
      if (connected) return success();
      last = connected.assume_error();
    }
    return last;
  }

private:
  Result<void> connect(const addrinfo& at, std::int64_t deadline) {
    UniqueFd fd(::socket(at.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, at.ai_protocol));
    if (!fd) return refused(errno);
    if (::connect(fd.get(), at.ai_addr, at.ai_addrlen) != 0) {
      if (errno != EINPROGRESS) return refused(errno);
      SCANSION_TRY(events, poll_descriptor(fd.get(), POLLOUT, deadline, name()));
      if (events == 0) return refused(ETIMEDOUT);
      int reason = 0;
      socklen_t size = sizeof reason;
      ::getsockopt(fd.get(), SOL_SOCKET, SO_ERROR, &reason, &size);
      if (reason != 0) return refused(reason);
    }
    set_option(fd.get(), IPPROTO_TCP, TCP_NODELAY, 1);
    set_option(fd.get(), SOL_SOCKET, SO_KEEPALIVE, 1);
    set_option(fd.get(), IPPROTO_TCP, TCP_KEEPIDLE, 4);
    set_option(fd.get(), IPPROTO_TCP, TCP_KEEPINTVL, 2);
    set_option(fd.get(), IPPROTO_TCP, TCP_KEEPCNT, 3);
    set_option(fd.get(), IPPROTO_TCP, TCP_USER_TIMEOUT, 8000);
    fd_ = std::move(fd);
    return success();
  }

  Error refused(int reason) const {
    Error error = system_error(name() + ": cannot connect", reason);
    error.code = Errc::unavailable;
    return error;
  }

  HostPort address_;
};

class UdpTransport final : public DescriptorTransport {
public:
  explicit UdpTransport(const HostPort& address) : DescriptorTransport("udp " + shown(address)), address_(address) {}

  Result<void> open() override {
    close();
    SCANSION_TRY(list, resolve(address_, SOCK_DGRAM, name()));
    UniqueFd fd(::socket(list->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, list->ai_protocol));
    if (!fd || ::bind(fd.get(), list->ai_addr, list->ai_addrlen) != 0) {
      Error error = system_error(name() + ": cannot listen", errno);
      error.code = Errc::unavailable;
      return error;
    }
    set_option(fd.get(), SOL_SOCKET, SO_RCVBUF, 4 << 20); // the kernel drops silently what does not fit
    fd_ = std::move(fd);
    return success();
  }

private:
  Empty empty_read() const noexcept override { return Empty::datagram; }

  HostPort address_;
};

} // namespace

Result<HostPort> parse_host_port(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return fail(Errc::config, "has no port; write host:port");
  std::string_view host = text.substr(0, colon);
  const std::string_view port = text.substr(colon + 1);
  const bool bracketed = host.size() >= 2 && host.front() == '[' && host.back() == ']';
  if (bracketed)
    host = host.substr(1, host.size() - 2);
  else if (host.find(':') != std::string_view::npos)
    return fail(Errc::config, "has more than one colon; write an IPv6 address in brackets, [::1]:port");
  unsigned number = 0;
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), number);
  if (error != std::errc() || end != port.data() + port.size() || number < 1 || number > 65535) {
    return fail(Errc::config, "has no port number from 1 to 65535 behind its colon");
  }
  return HostPort{std::string(host), std::string(port)};
}

std::unique_ptr<Transport> tcp_transport(const HostPort& address) {
  return std::make_unique<TcpTransport>(address);
}

std::unique_ptr<Transport> udp_transport(const HostPort& address) {
  return std::make_unique<UdpTransport>(address);
}

} // namespace scansion
