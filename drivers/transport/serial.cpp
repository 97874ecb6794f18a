// A serial port: libserialport, or termios where that refuses.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/descriptor.hpp"
#include "drivers/transport/ports.hpp"

#include <array>
#include <cerrno>
#include <climits>
#include <cstdlib>
#include <fcntl.h>
#include <libserialport.h>
#include <memory>
#include <optional>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>
#include <utility>

namespace scansion {
namespace {

/// Frees a port of libserialport, and closes it.
struct PortCloser {
  void operator()(sp_port* port) const noexcept {
    sp_close(port);
    sp_free_port(port);
  }
};

std::optional<speed_t> termios_speed(int baud) noexcept {
  constexpr std::array<std::pair<int, speed_t>, 14> kSpeeds{{{9600, B9600},
                                                             {19200, B19200},
                                                             {38400, B38400},
                                                             {57600, B57600},
                                                             {115200, B115200},
                                                             {230400, B230400},
                                                             {460800, B460800},
                                                             {500000, B500000},
                                                             {921600, B921600},
                                                             {1000000, B1000000},
                                                             {2000000, B2000000},
                                                             {4800, B4800},
                                                             {2400, B2400},
                                                             {1200, B1200}}};
  for (const auto& [rate, speed] : kSpeeds) {
    if (rate == baud) return speed;
  }
  return std::nullopt;
}

/// A raw line without echo; on a pseudo terminal the rate means nothing, so an odd one is left out.
bool make_raw(int fd, int baud) noexcept {
  termios settings{};
  if (::tcgetattr(fd, &settings) != 0) return false;
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS);
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  if (const auto speed = termios_speed(baud)) ::cfsetspeed(&settings, *speed);
  return ::tcsetattr(fd, TCSANOW, &settings) == 0;
}

/// A port that cannot do this still carries bytes: no error.
void keep_dtr(int fd) noexcept {
  termios settings{};
  if (::tcgetattr(fd, &settings) != 0) return;
  settings.c_cflag &= ~static_cast<tcflag_t>(HUPCL);
  ::tcsetattr(fd, TCSANOW, &settings);
}

class SerialTransport final : public DescriptorTransport {
public:
  SerialTransport(std::string path, int baud, bool keeps_dtr)
      : DescriptorTransport(std::move(path)), baud_(baud), keeps_dtr_(keeps_dtr) {}
  ~SerialTransport() override { close(); }

  Result<void> open() override {
    close();
    char real[PATH_MAX];
    // libserialport knows a port by its device name only, not by a link such as /dev/serial/by-id.
    if (::realpath(name().c_str(), real) == nullptr) return cannot_open(errno);
    SCANSION_TRY(open_with_library(real));
    if (!port_) {
      SCANSION_TRY(open_with_termios(real));
    }
    if (::flock(fd_.get(), LOCK_EX | LOCK_NB) != 0) {
      close();
      return fail(Errc::unavailable, name(), ": is in use by another program; stop it, or choose another port");
    }
    if (keeps_dtr_) keep_dtr(fd_.get());
    ::tcflush(fd_.get(), TCIFLUSH); // bytes of before belong to nobody
    return success();
  }

  Result<void> change_rate(int baud) override {
    if (!fd_) return fail(Errc::unavailable, name(), ": is not open");
    if (port_ ? sp_set_baudrate(port_.get(), baud) == SP_OK : make_raw(fd_.get(), baud)) return success();
    return cannot_set(baud);
  }

  void close() noexcept override {
    if (port_) static_cast<void>(fd_.release()); // libserialport's own
    port_.reset();
    fd_.reset();
  }

private:
  Empty empty_read() const noexcept override { return Empty::maybe; }
  std::string_view gone() const noexcept override { return "the port is gone (unplugged?)"; }

  /// Leaves port_ empty for what the library does not take for a serial port.
  Result<void> open_with_library(const char* path) {
    sp_port* found = nullptr;
    if (sp_get_port_by_name(path, &found) != SP_OK) return success();
    std::unique_ptr<sp_port, void (*)(sp_port*)> unopened(found, sp_free_port);
    if (sp_open(found, SP_MODE_READ_WRITE) != SP_OK) {
      const int reason = errno;
      // ENOTTY: no modem lines, as with a pseudo terminal; termios may still do.
      if (reason == ENOTTY || reason == EINVAL) return success();
      return cannot_open(reason);
    }
    port_.reset(unopened.release());
    const bool configured = sp_set_bits(found, 8) == SP_OK && sp_set_parity(found, SP_PARITY_NONE) == SP_OK &&
                            sp_set_stopbits(found, 1) == SP_OK && sp_set_flowcontrol(found, SP_FLOWCONTROL_NONE) == SP_OK;
    if (!configured || sp_set_baudrate(found, baud_) != SP_OK) {
      const Error error = cannot_set(baud_);
      close();
      return error;
    }
    int fd = -1;
    if (sp_get_port_handle(found, &fd) != SP_OK) {
      close();
      return fail(Errc::unavailable, name(), ": has no descriptor");
    }
    fd_.reset(fd);
    ::ioctl(fd, TIOCEXCL); // keeps programs out that take no lock
    return success();
  }

  Result<void> open_with_termios(const char* path) {
    UniqueFd fd(::open(path, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (!fd) return cannot_open(errno);
    if (::isatty(fd.get()) != 1)
      return fail(Errc::unavailable, name(), ": is no serial port; for a file or FIFO use the key file");
    if (!make_raw(fd.get(), baud_)) return cannot_open(errno);
    fd_ = std::move(fd);
    return success();
  }

  Error cannot_set(int baud) const {
    const Error error = system_error(name() + ": cannot be set to " + std::to_string(baud) + " baud 8N1", errno);
    return make_error(Errc::unavailable, {error.context});
  }

  Error cannot_open(int reason) const {
    if (reason == EACCES || reason == EPERM) {
      return make_error(Errc::permission,
                        {name(), ": permission denied; add the user to the group that owns the port (dialout), "
                                 "see `scansion devices`"});
    }
    if (reason == EBUSY) return make_error(Errc::unavailable, {name(), ": is in use by another program"});
    Error error = system_error(name(), reason);
    if (error.code != Errc::not_found) error.code = Errc::unavailable;
    return error;
  }

  int baud_;
  bool keeps_dtr_;
  std::unique_ptr<sp_port, PortCloser> port_; ///< owns fd_ when set
};

} // namespace

std::unique_ptr<Transport> serial_transport(std::string path, int baud, bool keeps_dtr) {
  return std::make_unique<SerialTransport>(std::move(path), baud, keeps_dtr);
}

} // namespace scansion
