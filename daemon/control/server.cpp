// Answers one JSON request per line on a Unix socket.
// SPDX-License-Identifier: Apache-2.0
#include "daemon/control/server.hpp"

#include <algorithm>
#include <cerrno>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace scansion {
namespace {

constexpr std::size_t kMaxClients = 32;
constexpr std::size_t kMaxRequest = 4096;
constexpr SteadyNs kPatience = 10 * kSecond;

struct Client {
  UniqueFd fd;
  std::string in;  ///< at most kMaxRequest bytes and one read
  std::string out; ///< the reply under way
  std::size_t sent = 0;
  SteadyNs last_progress = 0;
  bool closing = false;                        ///< hang up once `out` has gone
  std::unique_ptr<TailHub::Listener> listener; ///< of a client that only listens from now on

  [[nodiscard]] bool writing() const noexcept { return sent < out.size(); }
};

/// Answers the requests that stand in `in`, one after the other, until a reply cannot be sent at once. False: hang up.
bool reply_to(Client& client, const ControlServer::Handler& handler, TailHub* hub, SteadyNs now) {
  for (;;) {
    while (client.writing()) {
      const ssize_t sent =
          ::send(client.fd.get(), client.out.data() + client.sent, client.out.size() - client.sent, MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent < 0) return errno == EAGAIN;
      client.sent += static_cast<std::size_t>(sent);
      client.last_progress = now;
    }
    client.out.clear();
    client.sent = 0;
    if (client.closing) return false;
    if (client.listener) {
      client.in.clear();
      client.out = client.listener->take();
      if (client.out.empty()) return true;
      continue;
    }
    const auto newline = client.in.find('\n');
    if (newline == std::string::npos && client.in.size() <= kMaxRequest) return true;
    if (newline == std::string::npos || newline > kMaxRequest) {
      client.out = R"({"error":"a request must be one line of at most 4096 bytes"})"
                   "\n";
      client.closing = true;
      continue;
    }
    const std::string_view request = std::string_view(client.in).substr(0, newline);
    if (const auto topic = hub != nullptr ? tail_request(request) : std::nullopt) {
      client.listener = std::make_unique<TailHub::Listener>(*hub, *topic);
      client.out = "{\"tail\":\"" + std::string(name(*topic)) + "\"}\n";
      continue;
    }
    client.out = handler(request) + '\n';
    client.in.erase(0, newline + 1);
  }
}

/// False: hang up.
bool receive(Client& client, SteadyNs now) {
  char buffer[kMaxRequest];
  const ssize_t got = ::recv(client.fd.get(), buffer, sizeof buffer, 0);
  if (got < 0) return errno == EAGAIN || errno == EINTR;
  if (got == 0) return false;
  client.in.append(buffer, static_cast<std::size_t>(got));
  client.last_progress = now;
  return true;
}

void accept_clients(int listener, std::vector<Client>& clients, SteadyNs now) {
  for (;;) {
    UniqueFd fd(::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (!fd) return; // none left, or none to be had now: poll says when to ask again
    if (clients.size() >= kMaxClients) continue;
    clients.push_back({std::move(fd), {}, {}, 0, now, false, nullptr});
  }
}

/// True when somebody answers at `address`.
bool is_served(const sockaddr_un& address) {
  const UniqueFd probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  return probe && (::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 || errno == EAGAIN);
}

Result<void> make_way(const std::string& path, const sockaddr_un& address) {
  const auto slash = path.rfind('/');
  if (slash != std::string::npos && slash > 0) {
    const std::string folder = path.substr(0, slash);
    if (::mkdir(folder.c_str(), 0755) != 0 && errno != EEXIST)
      return system_error(folder + ": cannot make the socket's folder", errno);
  }
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) return success();
  if (!S_ISSOCK(status.st_mode)) return fail(Errc::exists, path, ": is no socket; set another one in [control]");
  if (is_served(address))
    return fail(Errc::unavailable, path, ": another daemon answers there; stop it or set another socket in [control]");
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) return system_error(path + ": cannot replace the stale socket", errno);
  return success();
}

Result<UniqueFd> listen_on(const std::string& path) {
  SCANSION_TRY(address, socket_address(path));
  SCANSION_TRY(make_way(path, address));
  UniqueFd fd(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!fd) return system_error("cannot make a socket", errno);
  if (::bind(fd.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return system_error(path + ": cannot make the control socket", errno);
  }
  // Nobody can connect before listen(), so the mode is in force from the first connection on.
  if (::chmod(path.c_str(), 0660) != 0) return system_error(path + ": cannot set the mode", errno);
  if (::listen(fd.get(), 16) != 0) return system_error(path + ": cannot listen", errno);
  return fd;
}

} // namespace

Result<std::unique_ptr<ControlServer>> ControlServer::listen(const std::string& path, Clock& clock) {
  SCANSION_TRY(listener, listen_on(path));
  UniqueFd wake(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!wake) return system_error("cannot make an eventfd", errno);
  return std::unique_ptr<ControlServer>(new ControlServer(path, std::move(listener), std::move(wake), clock));
}

void ControlServer::serve(Handler handler, TailHub* hub) {
  hub_ = hub;
  handler_ = std::move(handler);
  thread_ = std::thread([this] { run(); });
}

ControlServer::~ControlServer() {
  const std::uint64_t one = 1;
  // An eventfd that was never written takes eight bytes; there is nothing else that could fail here.
  [[maybe_unused]] const ssize_t written = ::write(wake_.get(), &one, sizeof one);
  if (thread_.joinable()) thread_.join();
  ::unlink(path_.c_str());
}

void ControlServer::run() {
  std::vector<Client> clients;
  std::vector<pollfd> entries;
  for (;;) {
    entries.clear();
    entries.push_back({wake_.get(), POLLIN, 0});
    entries.push_back({listener_.get(), POLLIN, 0});
    entries.push_back({hub_ != nullptr ? hub_->ready_fd() : -1, POLLIN, 0}); // -1 is passed over
    for (const Client& client : clients) {
      entries.push_back({client.fd.get(), static_cast<short>(client.writing() ? POLLOUT : POLLIN), 0});
    }
    // The second is for idle clients, and for accept() when descriptors have run out.
    const int ready = ::poll(entries.data(), entries.size(), clients.empty() ? -1 : 1000);
    if (ready < 0 && errno != EINTR) return;
    if (entries[0].revents != 0) return;
    const bool has_news = ready > 0 && entries[2].revents != 0;
    if (has_news) hub_->clear();
    const SteadyNs now = clock_.steady_ns();
    for (std::size_t i = 0; i < clients.size(); ++i) {
      Client& client = clients[i];
      const short events = ready > 0 ? entries[i + 3].revents : short{0};
      bool keep = client.listener || now - client.last_progress < kPatience;
      if (keep && (events & POLLIN) != 0) keep = receive(client, now);
      if (keep && (events != 0 || (has_news && client.listener))) keep = reply_to(client, handler_, hub_, now);
      if (keep && (events & (POLLERR | POLLNVAL)) != 0) keep = false;
      if (!keep) client.fd.reset(); // erased below
    }
    std::erase_if(clients, [](const Client& client) { return !client.fd; });
    if (ready > 0 && entries[1].revents != 0) accept_clients(listener_.get(), clients, now);
  }
}

} // namespace scansion
