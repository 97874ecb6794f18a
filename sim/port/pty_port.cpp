// A pseudo terminal with a name that stays.
// SPDX-License-Identifier: Apache-2.0
#include "sim/port/port.hpp"

#include "drivers/transport/descriptor.hpp"

#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

namespace scansion {
namespace {

class PtyPort final : public Port {
public:
  explicit PtyPort(std::string link) : link_(std::move(link)) {}
  ~PtyPort() override { unplug(); }

  Result<void> plug() override {
    UniqueFd master(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    char name[64];
    if (!master || ::grantpt(master.get()) != 0 || ::unlockpt(master.get()) != 0 ||
        ::ptsname_r(master.get(), name, sizeof name) != 0) {
      return system_error("cannot make a pseudo terminal", errno);
    }
    // Held open: without a slave the master reports a hang-up all the time, and the settings would be lost.
    UniqueFd slave(::open(name, O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    termios settings{};
    if (!slave || ::tcgetattr(slave.get(), &settings) != 0) return system_error(name, errno);
    ::cfmakeraw(&settings);
    if (::tcsetattr(slave.get(), TCSANOW, &settings) != 0) return system_error(name, errno);
    SCANSION_TRY(make_link(name));
    master_ = std::move(master);
    slave_ = std::move(slave);
    name_ = name;
    return success();
  }

  void unplug() noexcept override {
    if (!master_) return;
    char target[64];
    const ssize_t length = ::readlink(link_.c_str(), target, sizeof target);
    if (length > 0 && std::string_view(target, static_cast<std::size_t>(length)) == name_) ::unlink(link_.c_str());
    slave_.reset();
    master_.reset();
  }

  void cut() noexcept override {
    unplug();
    static_cast<void>(plug()); // worked before
  }

  int descriptor() const noexcept override { return master_.get(); }
  int stream() const noexcept override { return master_.get(); }

  Input input(std::span<std::uint8_t> to) override {
    if (!master_) return {};
    const ssize_t got = ::read(master_.get(), to.data(), to.size());
    if (got <= 0) return {};
    return {Event::bytes, static_cast<std::size_t>(got)};
  }

  std::size_t output(std::span<const std::uint8_t> bytes) override {
    if (!master_) return bytes.size(); // nobody misses them
    const ssize_t put = ::write(master_.get(), bytes.data(), bytes.size());
    return put > 0 ? static_cast<std::size_t>(put) : 0;
  }

  std::string where() const override { return "pty " + link_ + " (" + name_ + ")"; }

private:
  /// The name changes from the old terminal to the new one in one step.
  Result<void> make_link(const char* target) const {
    struct stat status {};
    if (::lstat(link_.c_str(), &status) == 0 && !S_ISLNK(status.st_mode)) {
      return fail(Errc::exists, link_, ": exists and is no link; choose another name for --pty");
    }
    const std::string temporary = link_ + ".new" + std::to_string(::getpid());
    ::unlink(temporary.c_str());
    if (::symlink(target, temporary.c_str()) != 0 || ::rename(temporary.c_str(), link_.c_str()) != 0) {
      const int reason = errno;
      ::unlink(temporary.c_str());
      return system_error(link_, reason);
    }
    return success();
  }

  const std::string link_;
  std::string name_;
  UniqueFd master_, slave_;
};

} // namespace

std::unique_ptr<Port> pty_port(std::string link) {
  return std::make_unique<PtyPort>(std::move(link));
}

} // namespace scansion
