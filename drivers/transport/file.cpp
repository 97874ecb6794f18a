// A file or a FIFO that bytes are read from.
// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/descriptor.hpp"
#include "drivers/transport/ports.hpp"

#include <cerrno>
#include <fcntl.h>
#include <sys/stat.h>

namespace scansion {
namespace {

class FileTransport final : public DescriptorTransport {
public:
  explicit FileTransport(std::string path) : DescriptorTransport(std::move(path)) {}

  Result<void> open() override {
    close();
    struct stat status {};
    if (::stat(name().c_str(), &status) != 0) return system_error(name(), errno);
    if (S_ISDIR(status.st_mode)) return fail(Errc::unavailable, name(), ": is a folder; name a file or a FIFO");
    is_fifo_ = S_ISFIFO(status.st_mode);
    is_file_ = S_ISREG(status.st_mode);
    // A FIFO held for writing too does not end when its last writer goes.
    const int mode = is_fifo_ ? O_RDWR : O_RDONLY;
    UniqueFd fd(::open(name().c_str(), mode | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
    if (!fd) return system_error(name(), errno);
    fd_ = std::move(fd);
    return success();
  }

  using DescriptorTransport::write;
  /// A device that is only heard gets no bytes.
  Result<void> write(std::span<const std::uint8_t> /*bytes*/, std::int64_t /*deadline_ns*/) override { return success(); }
  bool is_live() const noexcept override { return !is_file_; }

private:
  Empty empty_read() const noexcept override { return is_file_ ? Empty::end : Empty::hang_up; }

  bool is_fifo_ = false;
  bool is_file_ = false;
};

} // namespace

std::unique_ptr<Transport> file_transport(std::string path) {
  return std::make_unique<FileTransport>(std::move(path));
}

} // namespace scansion
