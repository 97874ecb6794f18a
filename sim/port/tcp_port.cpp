// A TCP server for one host at a time.
// SPDX-License-Identifier: Apache-2.0
#include "sim/port/port.hpp"

#include "drivers/transport/descriptor.hpp"
#include "drivers/transport/ports.hpp"

#include <cerrno>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/socket.h>

namespace scansion {
namespace {

class TcpPort final : public Port {
public:
  explicit TcpPort(HostPort address) : address_(std::move(address)), wait_(::epoll_create1(EPOLL_CLOEXEC)) {}
  ~TcpPort() override { unplug(); }

  Result<void> plug() override {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
    addrinfo* list = nullptr;
    if (const int problem =
            ::getaddrinfo(address_.host.empty() ? nullptr : address_.host.c_str(), address_.port.c_str(), &hints, &list);
        problem != 0) {
      return fail(Errc::usage, "--tcp ", address_.host, ": ", ::gai_strerror(problem));
    }
    UniqueFd listener(::socket(list->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    constexpr int kYes = 1;
    ::setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &kYes, sizeof kYes);
    const bool listens =
        listener && ::bind(listener.get(), list->ai_addr, list->ai_addrlen) == 0 && ::listen(listener.get(), 4) == 0;
    const int reason = errno;
    ::freeaddrinfo(list);
    if (!listens) return system_error("--tcp " + address_.host + ":" + address_.port, reason);
    note_port(listener.get());
    watch(listener.get());
    listener_ = std::move(listener);
    return success();
  }

  void unplug() noexcept override {
    cut();
    listener_.reset();
  }

  void cut() noexcept override {
    if (client_) left_ = true;
    client_.reset();
  }

  int descriptor() const noexcept override { return listener_ ? wait_.get() : -1; }
  int stream() const noexcept override { return client_.get(); }

  Input input(std::span<std::uint8_t> to) override {
    if (std::exchange(left_, false)) return {Event::disconnected, 0};
    if (client_) {
      const ssize_t got = ::recv(client_.get(), to.data(), to.size(), 0);
      if (got > 0) return {Event::bytes, static_cast<std::size_t>(got)};
      if (got == 0 || (errno != EAGAIN && errno != EINTR)) {
        client_.reset();
        return {Event::disconnected, 0};
      }
    }
    if (!listener_) return {};
    UniqueFd host(::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!host || client_) return {}; // a second host is turned away
    constexpr int kYes = 1;
    ::setsockopt(host.get(), IPPROTO_TCP, TCP_NODELAY, &kYes, sizeof kYes);
    watch(host.get());
    client_ = std::move(host);
    return {Event::connected, 0};
  }

  std::size_t output(std::span<const std::uint8_t> bytes) override {
    if (!client_) return bytes.size();
    const ssize_t put = ::send(client_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    return put > 0 ? static_cast<std::size_t>(put) : 0;
  }

  std::string where() const override { return "tcp " + address_.host + ":" + address_.port; }

private:
  void watch(int fd) noexcept {
    epoll_event event{};
    event.events = EPOLLIN;
    ::epoll_ctl(wait_.get(), EPOLL_CTL_ADD, fd, &event); // a closed descriptor leaves by itself
  }

  /// Port 0 becomes the one that was found, also for the next plug().
  void note_port(int fd) {
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    char port[16];
    if (::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0 &&
        ::getnameinfo(reinterpret_cast<sockaddr*>(&address), size, nullptr, 0, port, sizeof port, NI_NUMERICSERV) == 0) {
      address_.port = port;
    }
  }

  HostPort address_;
  UniqueFd wait_;
  UniqueFd listener_, client_;
  bool left_ = false; ///< the host was cut off, which the device has not heard yet
};

} // namespace

Result<std::unique_ptr<Port>> tcp_port(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  // Port 0, which a host could not connect to, is of use here.
  const bool any = colon != std::string::npos && address.substr(colon + 1) == "0";
  auto parsed = parse_host_port(any ? address.substr(0, colon) + ":1" : address);
  if (!parsed) return fail(Errc::usage, "--tcp ", address, " ", parsed.assume_error().context);
  HostPort at = std::move(parsed).assume_value();
  if (any) at.port = "0";
  return std::unique_ptr<Port>(std::make_unique<TcpPort>(std::move(at)));
}

} // namespace scansion
