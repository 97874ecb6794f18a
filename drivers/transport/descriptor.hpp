// A transport on a file descriptor; only how it is opened differs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drivers/transport/transport.hpp"
#include "drivers/transport/unique_fd.hpp"

namespace scansion {

/// Both clocks of the machine.
[[nodiscard]] Moment machine_moment() noexcept;

/// Waits for `events` of poll(2) until `deadline_ns`; what happened, 0 at the deadline.
[[nodiscard]] Result<short> poll_descriptor(int fd, short events, std::int64_t deadline_ns, const std::string& name);

/// Reading, writing and noticing a hang-up by poll(2) on a non-blocking descriptor. A hang-up wakes poll at once.
class DescriptorTransport : public Transport {
public:
  explicit DescriptorTransport(std::string name) : name_(std::move(name)) {}
  ~DescriptorTransport() override = default;

  using Transport::write;
  Result<Arrival> read(std::span<std::uint8_t> to, std::int64_t deadline_ns) override;
  Result<void> write(std::span<const std::uint8_t> bytes, std::int64_t deadline_ns) override;
  void close() noexcept override { fd_.reset(); }
  [[nodiscard]] Moment now() const noexcept override { return machine_moment(); }
  [[nodiscard]] const std::string& name() const noexcept override { return name_; }

protected:
  /// What reading 0 bytes means.
  enum class Empty : std::uint8_t {
    hang_up,  ///< the device or its connection is gone
    end,      ///< the end of a file
    datagram, ///< a datagram without content
    maybe     ///< a terminal set to return at once: look whether the line is still there
  };
  [[nodiscard]] virtual Empty empty_read() const noexcept { return Empty::hang_up; }
  /// Why the other side is gone, for a person.
  [[nodiscard]] virtual std::string_view gone() const noexcept { return "the connection was closed"; }

  UniqueFd fd_;

private:
  [[nodiscard]] Result<Arrival> take_empty(short events, bool& again);
  [[nodiscard]] Error lost() const;

  const std::string name_;
  int empty_reads_ = 0; ///< in a row, from a terminal that says it has something
};

} // namespace scansion
