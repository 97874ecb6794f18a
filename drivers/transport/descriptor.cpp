// A transport on a file descriptor.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/descriptor.hpp"

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace scansion {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;
constexpr int kMostEmptyReads = 3;

std::int64_t clock_ns(clockid_t clock) noexcept {
  timespec time{};
  ::clock_gettime(clock, &time);
  return time.tv_sec * kSecondNs + time.tv_nsec;
}

bool is_hang_up(short events) noexcept {
  return (events & (POLLHUP | POLLERR | POLLNVAL)) != 0;
}

} // namespace

Moment machine_moment() noexcept {
  return {clock_ns(CLOCK_MONOTONIC), clock_ns(CLOCK_REALTIME)};
}

Result<short> poll_descriptor(int fd, short events, std::int64_t deadline_ns, const std::string& name) {
  for (;;) {
    const std::int64_t left = std::clamp<std::int64_t>(deadline_ns - clock_ns(CLOCK_MONOTONIC), 0, 3600 * kSecondNs);
    const timespec wait{left / kSecondNs, left % kSecondNs};
    pollfd one{fd, events, 0};
    const int ready = ::ppoll(&one, 1, &wait, nullptr);
    if (ready >= 0) return ready == 0 ? short{0} : one.revents;
    if (errno != EINTR) return system_error(name + ": waiting failed", errno);
  }
}

Error DescriptorTransport::lost() const {
  return make_error(Errc::unavailable, {name_, ": lost, ", gone()});
}

Result<Arrival> DescriptorTransport::take_empty(short events, bool& again) {
  switch (empty_read()) {
    case Empty::end: return Arrival{0, machine_moment(), true};
    case Empty::datagram: break;
    case Empty::hang_up: return lost();
    case Empty::maybe: {
      int waiting = 0;
      // A port that vanished fails here although its read did not.
      if (is_hang_up(events) || ::ioctl(fd_.get(), FIONREAD, &waiting) != 0 || ++empty_reads_ >= kMostEmptyReads) return lost();
      break;
    }
  }
  again = true;
  return Arrival{};
}

Result<Arrival> DescriptorTransport::read(std::span<std::uint8_t> to, std::int64_t deadline_ns) {
  if (!fd_) return fail(Errc::unavailable, name_, ": is not open");
  for (;;) {
    SCANSION_TRY(events, poll_descriptor(fd_.get(), POLLIN, deadline_ns, name_));
    if (events == 0) return Arrival{0, machine_moment(), false};
    const ssize_t got = ::read(fd_.get(), to.data(), to.size());
    if (got > 0) {
      empty_reads_ = 0;
      return Arrival{static_cast<std::size_t>(got), machine_moment(), false};
    }
    if (got == 0) {
      bool again = false;
      SCANSION_TRY(arrival, take_empty(events, again));
      if (!again) return arrival;
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (is_hang_up(events)) return lost();
    } else if (errno != EINTR) {
      // EIO is how a terminal says that its device went away.
      if (errno == EIO || errno == ENXIO || errno == ENODEV) return lost();
      const Error error = system_error(name_ + ": lost, reading failed", errno);
      return make_error(Errc::unavailable, {error.context});
    }
  }
}

Result<void> DescriptorTransport::write(std::span<const std::uint8_t> bytes, std::int64_t deadline_ns) {
  if (!fd_) return fail(Errc::unavailable, name_, ": is not open");
  while (!bytes.empty()) {
    const ssize_t put = ::write(fd_.get(), bytes.data(), bytes.size());
    if (put >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(put));
      continue;
    }
    if (errno == EINTR) continue;
    if (errno == EPIPE || errno == EIO || errno == ENXIO || errno == ENODEV || errno == ECONNRESET) return lost();
    if (errno != EAGAIN && errno != EWOULDBLOCK) {
      const Error error = system_error(name_ + ": lost, writing failed", errno);
      return make_error(Errc::unavailable, {error.context});
    }
    SCANSION_TRY(events, poll_descriptor(fd_.get(), POLLOUT, deadline_ns, name_));
    if (events == 0) return fail(Errc::unavailable, name_, ": the device takes no bytes");
    if (is_hang_up(events)) return lost();
  }
  return success();
}

} // namespace scansion
