// The bytes between a driver and its device: what a serial port, a socket, a file and a transcript have in common.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/model/result.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace scansion {

/// One moment on both clocks of the host.
struct Moment {
  std::int64_t monotonic_ns = 0; ///< CLOCK_MONOTONIC
  std::int64_t realtime_ns = 0;  ///< CLOCK_REALTIME

  friend bool operator==(const Moment&, const Moment&) = default;
};

/// What a read brought.
struct Arrival {
  std::size_t count = 0; ///< bytes; 0: nothing came until the deadline
  Moment at;             ///< when they were there
  bool end = false;      ///< the source is at its end and will not go on (a file, a transcript)
};

/// Thread-bound. Time is the transport's own: the machine's for a port, the recorded one for a transcript, a script's in a
/// test. So a driver reads no clock, and the same bytes give the same lines whatever brings them.
class Transport {
public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  /// Takes hold of the port, exclusively where that is possible. Called again after close().
  [[nodiscard]] virtual Result<void> open() = 0;
  /// Waits until something comes or `deadline_ns` (monotonic) is there. A hang-up fails with unavailable, after all bytes
  /// before it were read.
  [[nodiscard]] virtual Result<Arrival> read(std::span<std::uint8_t> to, std::int64_t deadline_ns) = 0;
  /// All of `bytes`, or an error: unavailable after a hang-up or when the device takes nothing until the deadline.
  [[nodiscard]] virtual Result<void> write(std::span<const std::uint8_t> bytes, std::int64_t deadline_ns) = 0;
  /// Another bit rate from now on, also for bytes that were written but have not gone out yet. Nothing on what has no rate.
  [[nodiscard]] virtual Result<void> change_rate(int /*baud*/) { return success(); }
  /// Allowed in every state.
  virtual void close() noexcept = 0;

  [[nodiscard]] virtual Moment now() const noexcept = 0;
  /// For messages: path or address.
  [[nodiscard]] virtual const std::string& name() const noexcept = 0;
  /// False: recorded bytes that wait without loss.
  [[nodiscard]] virtual bool is_live() const noexcept { return true; }
  /// It was opened and there was nothing more to come: a transcript behind its last run.
  [[nodiscard]] virtual bool is_over() const noexcept { return false; }

  [[nodiscard]] Result<void> write(std::string_view text, std::int64_t deadline_ns) {
    return write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, deadline_ns);
  }
};

} // namespace scansion
