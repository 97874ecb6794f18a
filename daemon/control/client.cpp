// Asks a running daemon over its control socket.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/control/client.hpp"

#include "daemon/control/address.hpp"

#include <cerrno>
#include <poll.h>
#include <sys/socket.h>

namespace scansion {
namespace {

using SteadyTime = std::chrono::steady_clock::time_point;

constexpr std::size_t kMaxReply = 4U << 20U;

Error refused(const std::string& path, int error) {
  if (error == EACCES || error == EPERM) {
    return Error{Errc::permission, path + ": access refused; run as root or as a member of the socket's group"};
  }
  Error out = system_error(path + ": no daemon answers", error);
  out.code = Errc::unavailable;
  out.context += "; start scansiond, or name its socket";
  return out;
}

/// Waits for `events`; fails with unavailable at the deadline.
Result<void> wait_for(int fd, short events, SteadyTime deadline, const std::string& path) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now()).count();
    pollfd entry{fd, events, 0};
    const int ready = left > 0 ? ::poll(&entry, 1, static_cast<int>(left)) : 0;
    if (ready > 0) return success();
    if (ready == 0) return fail(Errc::unavailable, path, ": the daemon did not answer in time");
    if (errno != EINTR) return system_error(path, errno);
  }
}

Result<UniqueFd> connect_to(const std::string& path, SteadyTime deadline) {
  SCANSION_TRY(address, socket_address(path));
  UniqueFd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!fd) return system_error("cannot make a socket", errno);
  // A full listen queue says EAGAIN, which poll cannot wait for: ask again until the deadline.
  while (::connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    if (errno == EINTR) continue;
    if (errno != EAGAIN) return refused(path, errno);
    if (std::chrono::steady_clock::now() >= deadline)
      return fail(Errc::unavailable, path, ": the daemon is too busy to answer");
    ::poll(nullptr, 0, 10);
  }
  return fd;
}

Result<void> send_all(int fd, std::string_view text, SteadyTime deadline, const std::string& path) {
  while (!text.empty()) {
    const ssize_t sent = ::send(fd, text.data(), text.size(), MSG_NOSIGNAL);
    if (sent >= 0) {
      text.remove_prefix(static_cast<std::size_t>(sent));
    } else if (errno == EAGAIN) {
      SCANSION_TRY(wait_for(fd, POLLOUT, deadline, path));
    } else if (errno != EINTR) {
      return refused(path, errno);
    }
  }
  return success();
}

Result<std::string> receive_line(int fd, SteadyTime deadline, const std::string& path) {
  std::string reply;
  while (reply.size() <= kMaxReply) {
    char buffer[4096];
    const ssize_t got = ::recv(fd, buffer, sizeof buffer, 0);
    if (got == 0) return fail(Errc::unavailable, path, ": the daemon closed the connection without an answer");
    if (got < 0 && errno == EAGAIN) {
      SCANSION_TRY(wait_for(fd, POLLIN, deadline, path));
    } else if (got < 0 && errno != EINTR) {
      return refused(path, errno);
    } else if (got > 0) {
      const std::string_view part(buffer, static_cast<std::size_t>(got));
      const auto newline = part.find('\n');
      reply.append(part.substr(0, newline));
      if (newline != std::string_view::npos) return reply;
    }
  }
  return fail(Errc::undecodable, path, ": the reply is longer than 4 MiB, so no daemon of ours listens there");
}

} // namespace

std::vector<std::string> socket_candidates() {
  std::vector<std::string> out;
  if (auto path = default_socket_path()) out.push_back(std::move(path).assume_value());
  const std::string service = "/run/scansion/control.sock";
  if (out.empty() || out.front() != service) out.push_back(service);
  return out;
}

Result<std::string> request(const std::string& socket_path, std::string_view json, std::chrono::milliseconds timeout) {
  const SteadyTime deadline = std::chrono::steady_clock::now() + timeout;
  SCANSION_TRY(fd, connect_to(socket_path, deadline));
  SCANSION_TRY(send_all(fd.get(), std::string(json) + '\n', deadline, socket_path));
  return receive_line(fd.get(), deadline, socket_path);
}

Result<std::string> request(std::string_view json, std::chrono::milliseconds timeout) {
  Result<std::string> first = fail(Errc::unavailable, "no daemon answers");
  bool tried = false;
  for (const std::string& path : socket_candidates()) {
    auto reply = request(path, json, timeout);
    if (reply) return reply;
    if (!tried || reply.assume_error().code != Errc::unavailable) first = std::move(reply);
    tried = true;
  }
  return first;
}

Result<void> stream(const std::optional<std::string>& socket_path, std::string_view json,
                    const std::function<Result<void>(std::string_view)>& on_line) {
  const SteadyTime deadline = std::chrono::steady_clock::now() + kRequestTimeout;
  const std::vector<std::string> paths = socket_path ? std::vector{*socket_path} : socket_candidates();
  Result<UniqueFd> fd = connect_to(paths.front(), deadline);
  for (std::size_t i = 1; !fd && fd.assume_error().code == Errc::unavailable && i < paths.size(); ++i)
    fd = connect_to(paths[i], deadline);
  SCANSION_TRY(connection, std::move(fd));
  SCANSION_TRY(send_all(connection.get(), std::string(json) + '\n', deadline, paths.front()));
  std::string held;
  for (;;) {
    pollfd entry{connection.get(), POLLIN, 0};
    if (::poll(&entry, 1, -1) < 0 && errno != EINTR) return system_error("cannot wait for the daemon", errno);
    char buffer[1U << 16U];
    const ssize_t got = ::recv(connection.get(), buffer, sizeof buffer, 0);
    if (got < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (got <= 0) return fail(Errc::unavailable, "the daemon has ended the connection");
    held.append(buffer, static_cast<std::size_t>(got));
    std::size_t begin = 0;
    for (std::size_t end = 0; (end = held.find('\n', begin)) != std::string::npos; begin = end + 1) {
      SCANSION_TRY(on_line(std::string_view(held).substr(begin, end - begin)));
    }
    held.erase(0, begin);
    if (held.size() > kMaxReply) return fail(Errc::undecodable, "a message is longer than 4 MiB, so no daemon of ours listens");
  }
}

} // namespace scansion
